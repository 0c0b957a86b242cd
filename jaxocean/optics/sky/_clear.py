"""The checks that both clear skies share."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import check_scalar, is_concrete


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
    check_scalar("sun_elevation", sun_elevation, "rad", minimum=-math.pi / 2, maximum=math.pi / 2)
    check_scalar("sun_azimuth", sun_azimuth, "rad")
    if not isinstance(albedo, jax.Array | np.ndarray):
        return
    if albedo.shape != shape:
        raise ValueError(f"Argument `albedo` must be one number or {shape[0]}, but has shape {albedo.shape}.")
    if is_concrete(albedo) and not bool(jnp.all((albedo >= 0.0) & (albedo <= 1.0))):
        raise ValueError(f"Argument `albedo` must lie between 0 and 1, but is {np.asarray(albedo).tolist()}.")
