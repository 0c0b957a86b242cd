"""The mean of a sky over round lobes, looked up in blurred panoramas."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._types import Scalar
from ._blur import VARIANCES, blurred_levels
from ._panorama import look_up, place


def lobe_mean(
    sharp: Float[Array, "*b 3"],
    upper: Float[Array, "h w 3"],
    direction: Float[Array, "*b 3"],
    variance: Float[Array, "*b"],
    rotation: Scalar | float = 0.0,
) -> Float[Array, "*b 3"]:
    """Mean radiance over Gaussian lobes; linear in the variance between the levels, constant above the widest.

    **Arguments:** `sharp`: the radiance along the lobes' axes; `upper`: the upper half of the sky's panorama;
    `direction`: the axes; `variance`: of each lobe [rad²]; `rotation`: of the panorama [rad].
    """
    levels = blurred_levels(upper)
    count, rows = levels.shape[0], levels.shape[1]
    atlas = levels.reshape(count * rows, *levels.shape[2:])
    spot = place(direction, rotation)
    variances = jnp.asarray(np.concatenate([[0.0], VARIANCES]), direction.dtype)
    spread = jnp.clip(variance.astype(direction.dtype), 0.0, variances[-1])
    # Level 0 is the sky itself, level k + 1 the k-th of the atlas.
    octave = jnp.floor(jnp.log2(jnp.maximum(spread, 1e-9) / variances[1]))
    lower = jnp.clip(octave, -1.0, count - 2.0).astype(jnp.int32) + 1
    share = (spread - variances[lower]) / (variances[lower + 1] - variances[lower])
    narrow = look_up(atlas, *spot, jnp.maximum(lower - 1, 0), rows)
    wide = look_up(atlas, *spot, lower, rows)
    start = jnp.where((lower == 0)[..., None], sharp, narrow)
    return start + share[..., None] * (wide - start)
