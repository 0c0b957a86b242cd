"""A sky of one colour."""

import math

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import UPRIGHT, as_leaf, as_upright_angle, check_scalar
from ..._types import Scalar
from ._abstract import AbstractSky
from ._colour_leaf import as_colour, check_colour
from ._sun import direction_of, even_disc, visible_fraction


class ConstantSky(AbstractSky):
    """The same radiance from everywhere, and a sun of any strength: an overcast sky, and the simplest of tests.

    **Arguments:**

    - `dome`: radiance [W m⁻² sr⁻¹ nm⁻¹], linear sRGB (3,), or one number for grey.
    - `sun`: irradiance [W m⁻² nm⁻¹] of the sun's beam on a plane across it, (3,) or one number; default 0.
    - `sun_elevation`: angle above the horizon [rad], from −π/2 to π/2.
    - `sun_azimuth`: angle counter-clockwise from +x (east) [rad].

    All are differentiable. **Raises:** `ValueError` for a number that is not finite or a wrong shape.
    """

    dome: Float[Array, "3"] = eqx.field(converter=as_colour)
    sun: Float[Array, "3"] = eqx.field(converter=as_colour, default=0.0)
    sun_elevation: Scalar = eqx.field(converter=as_upright_angle, default=math.pi / 4)
    sun_azimuth: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def __check_init__(self) -> None:
        check_colour("dome", self.dome, "W m⁻² sr⁻¹ nm⁻¹")
        check_colour("sun", self.sun, "W m⁻² nm⁻¹")
        check_scalar("sun_elevation", self.sun_elevation, "rad", minimum=-UPRIGHT, maximum=UPRIGHT)
        check_scalar("sun_azimuth", self.sun_azimuth, "rad")

    @property
    def sun_direction(self) -> Float[Array, "3"]:
        return direction_of(self.sun_elevation, self.sun_azimuth)

    @property
    def sun_irradiance(self) -> Float[Array, "3"]:
        return self.sun * visible_fraction(self.sun_elevation).astype(self.sun.dtype)

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return jnp.broadcast_to(self.dome.astype(direction.dtype), direction.shape)

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return even_disc(self.sun, self.sun_direction, direction)

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        return self.radiance(direction)

    def irradiance(self) -> Float[Array, "3"]:
        return math.pi * self.dome
