"""What both forms of the clear sky share."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import UPRIGHT, check_scalar, is_concrete
from ..._types import Scalar
from .._colour import XYZ_TO_SRGB, matching_weights
from ._abstract import AbstractSky
from ._beam import beam_irradiance
from ._blur import ROWS, blurred_levels
from ._lobes import lobe_mean
from ._panorama import pixel_directions
from ._quadrature import dome_irradiance
from ._sun import direction_of
from ._tables import WAVELENGTHS


class AbstractClearSky(AbstractSky):
    """A clear sky whose sun is the spectral beam through the air, whatever its dome is made of."""

    turbidity: eqx.AbstractVar[Scalar]
    albedo: eqx.AbstractVar[Float[Array, "..."]]
    sun_elevation: eqx.AbstractVar[Scalar]
    sun_azimuth: eqx.AbstractVar[Scalar]

    @property
    def sun_direction(self) -> Float[Array, "3"]:
        return direction_of(self.sun_elevation, self.sun_azimuth)

    @property
    def sun_irradiance(self) -> Float[Array, "3"]:
        return to_srgb(beam_irradiance(self.turbidity, self.sun_elevation))

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        panorama = self.radiance(pixel_directions(ROWS, direction.dtype))
        return lobe_mean(lambda: self.radiance(direction), blurred_levels(panorama), direction, variance)

    def irradiance(self) -> Float[Array, "3"]:
        return dome_irradiance(self.radiance, self.sun_azimuth)


def to_srgb(spectrum: Float[Array, "*b 11"]) -> Float[Array, "*b 3"]:
    """Linear sRGB of spectra at the model's eleven wavelengths."""
    return spectrum @ jnp.asarray(matching_weights(WAVELENGTHS) @ XYZ_TO_SRGB.T, spectrum.dtype)


def check_clear(
    turbidity: Float[Array, "..."],
    albedo: Float[Array, "..."],
    shape: tuple[int, ...],
    sun_elevation: Float[Array, "..."],
    sun_azimuth: Float[Array, "..."],
) -> None:
    """Raise one clear sentence unless the parameters lie in the range of the model; tracers pass.

    **Raises:** `ValueError` that names the argument, what it must be and what it is.
    """
    check_scalar("turbidity", turbidity, "", minimum=1.0, maximum=10.0)
    check_scalar("sun_elevation", sun_elevation, "rad", minimum=-UPRIGHT, maximum=UPRIGHT)
    check_scalar("sun_azimuth", sun_azimuth, "rad")
    if not isinstance(albedo, jax.Array | np.ndarray):
        return
    if albedo.shape != shape:
        raise ValueError(f"Argument `albedo` must be one number or {shape[0]}, but has shape {albedo.shape}.")
    if is_concrete(albedo) and not bool(jnp.all((albedo >= 0.0) & (albedo <= 1.0))):
        raise ValueError(f"Argument `albedo` must lie between 0 and 1, but is {np.asarray(albedo).tolist()}.")
