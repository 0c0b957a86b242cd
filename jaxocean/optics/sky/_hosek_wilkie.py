"""The clear sky of Hošek and Wilkie in red, green and blue."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import as_leaf, as_upright_angle
from ..._types import Scalar
from ._beam import disc_radiance
from ._clear import AbstractClearSky, check_clear, to_srgb
from ._colour_leaf import as_colour
from ._dome import coefficients, dome_radiance
from ._tables import WAVELENGTHS, tables
from ._twilight import twilight

NORMALISATION = 1.0 / 106.7502594
"""Brings the RGB tables to the unit of radiance: 1 / ∫ȳ dλ [1/nm], the figure that mitsuba 3 divides by."""


class HosekWilkie(AbstractClearSky):
    """The clear sky as a fit to a simulation of the scattering in the air, and the sun's beam through the same air.

    The dome is the model's own fit for linear sRGB. The sun is its spectral fit, integrated over the disc and then
    turned to sRGB, so that both have the unit of `AbstractSky`. Near sunset some channels become a little negative:
    such colours lie outside of sRGB.

    **Arguments:**

    - `turbidity`: haze, from 1 (no aerosol) to 10 (very hazy); 2 to 3 over a clear ocean.
    - `albedo`: of the ground below, 0 to 1, one number or three (red, green, blue); about 0.06 for the sea.
    - `sun_elevation`: of the centre of the sun [rad], −π/2 to π/2. Below the horizon the dome keeps the colours of
      sunset around the sun's true place and darkens as `twilight` does.
    - `sun_azimuth`: counter-clockwise from +x (east) [rad].

    All are differentiable; in the turbidity the model is linear between whole numbers, so that the derivative steps
    there (the upper side's is given), and where the sun crosses the horizon it is finite but steep.

    **Raises:** `ValueError` for a number that is outside of its range or not finite, or a wrong shape.

    **Source:** Hošek & Wilkie, ACM Trans. Graph. 31(4), 95, 2012; IEEE Comput. Graph. Appl. 33(3), 44–52, 2013.
    Twilight: Seidelmann 1992.
    """

    turbidity: Scalar = eqx.field(converter=as_leaf, default=3.0)
    albedo: Float[Array, "3"] = eqx.field(converter=as_colour, default=0.06)
    sun_elevation: Scalar = eqx.field(converter=as_upright_angle, default=0.7)
    sun_azimuth: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def __check_init__(self) -> None:
        check_clear(self.turbidity, self.albedo, (3,), self.sun_elevation, self.sun_azimuth)

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        """As in `AbstractSky`, with limb darkening."""
        sun = (self.turbidity, self.sun_elevation, self.sun_azimuth)
        return disc_radiance(*sun, direction, to_srgb(jnp.eye(WAVELENGTHS.size, dtype=direction.dtype)))

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        given = (self.turbidity, self.albedo, self.sun_elevation)
        shape = coefficients(tables()["rgb_shape"], *given)
        factor = coefficients(tables()["rgb_radiance"], *given)
        factor = NORMALISATION * twilight(self.sun_elevation).astype(factor.dtype) * factor
        return dome_radiance(direction, self.sun_direction, shape, factor)
