"""The clear sky of Hošek and Wilkie at single wavelengths."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, as_upright_angle
from ..._types import PerPattern, Scalar
from ._beam import beam_irradiance, disc_radiance
from ._clear import AbstractClearSky, check_clear, to_srgb
from ._dome import coefficients, dome_radiance
from ._tables import WAVELENGTHS, tables
from ._twilight import twilight


def _albedo(value: PerPattern) -> Float[Array, "..."]:
    leaf = as_leaf(jnp.asarray(value))
    return jnp.broadcast_to(leaf, WAVELENGTHS.shape) if leaf.ndim == 0 else leaf


class SpectralHosekWilkie(AbstractClearSky):
    """The model of `HosekWilkie` at eleven wavelengths, 320, 360, … 720 nm, for what depends on the wavelength.

    As an `AbstractSky` it answers in linear sRGB, through the CIE 1931 observer; `HosekWilkie` is cheaper and within
    a few per cent of it. Between the wavelengths the spectrum is linear, outside of them it is zero, but held for
    the colour.

    **Arguments:** as for `HosekWilkie`, with `albedo`: one number or eleven.

    **Raises:** `ValueError` for a number that is outside of its range or not finite, or a wrong shape.

    **Source:** as for `HosekWilkie`.
    """

    turbidity: Scalar = eqx.field(converter=as_leaf, default=3.0)
    albedo: Float[Array, "11"] = eqx.field(converter=_albedo, default=0.06)
    sun_elevation: Scalar = eqx.field(converter=as_upright_angle, default=0.7)
    sun_azimuth: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def __check_init__(self) -> None:
        check_clear(self.turbidity, self.albedo, WAVELENGTHS.shape, self.sun_elevation, self.sun_azimuth)

    def spectral_radiance(
        self, direction: Float[Array, "*b 3"], wavelength: Float[Array, "w"]
    ) -> Float[Array, "*b w"]:
        """Radiance [W m⁻² sr⁻¹ nm⁻¹] of the dome from `direction` at each `wavelength` [nm]."""
        return _at(self._dome(direction), wavelength)

    def spectral_sun_irradiance(self, wavelength: Float[Array, "w"]) -> Float[Array, "w"]:
        """Irradiance [W m⁻² nm⁻¹] across the sun's beam at each `wavelength` [nm]."""
        return _at(beam_irradiance(self.turbidity, self.sun_elevation), wavelength)

    def spectral_sun_radiance(
        self, direction: Float[Array, "*b 3"], wavelength: Float[Array, "w"]
    ) -> Float[Array, "*b w"]:
        """Radiance [W m⁻² sr⁻¹ nm⁻¹] of the sun's disc with limb darkening; 0 beside it and below the horizon."""
        return _at(self._disc(direction), wavelength)

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        """As in `AbstractSky`, with limb darkening."""
        return to_srgb(self._disc(direction))

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return to_srgb(self._dome(direction))

    def _disc(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 11"]:
        sun = (self.turbidity, self.sun_elevation, self.sun_azimuth)
        return disc_radiance(*sun, direction, jnp.eye(WAVELENGTHS.size, dtype=direction.dtype))

    def _dome(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 11"]:
        given = (self.turbidity, self.albedo, self.sun_elevation)
        shape = coefficients(tables()["spectral_shape"], *given)
        factor = coefficients(tables()["spectral_radiance"], *given)
        factor = twilight(self.sun_elevation).astype(factor.dtype) * factor
        return dome_radiance(direction, self.sun_direction, shape, factor)


def _at(spectrum: Float[Array, "*b 11"], wavelength: Float[Array, "w"]) -> Float[Array, "*b w"]:
    """Linear between the model's wavelengths, zero outside of them."""
    wavelength = wavelength.astype(spectrum.dtype)
    place = (wavelength - float(WAVELENGTHS[0])) / float(np.diff(WAVELENGTHS)[0])
    index = jnp.clip(jnp.floor(place).astype(jnp.int32), 0, WAVELENGTHS.size - 2)
    fraction = place - index.astype(place.dtype)
    value = (1.0 - fraction) * spectrum[..., index] + fraction * spectrum[..., index + 1]
    return jnp.where((wavelength >= WAVELENGTHS[0]) & (wavelength <= WAVELENGTHS[-1]), value, 0.0)
