"""The mean of a sky over round lobes, looked up in blurred panoramas."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._elementary import once
from ..._types import Scalar
from ._blur import VARIANCES
from ._panorama import look_up, place


def lobe_mean(
    sharp: Callable[[], Float[Array, "*b 3"]],
    levels: Float[Array, "level y x 3"],
    direction: Float[Array, "*b 3"],
    variance: Float[Array, "*b"],
    rotation: Scalar | float = 0.0,
) -> Float[Array, "*b 3"]:
    """Mean radiance over Gaussian lobes; linear in the variance between the levels, constant above the widest.

    **Arguments:** `sharp`: gives the radiance along the lobes' axes, asked where a lobe is
    narrower than the narrowest level; `levels`: of the sky's panorama, see `blurred_levels`;
    `direction`: the axes; `variance`: of each lobe [rad²]; `rotation`: of the panorama [rad].
    """
    count, rows = levels.shape[0], levels.shape[1]
    atlas = levels.reshape(count * rows, *levels.shape[2:])
    spot = place(direction, rotation)
    variances = jnp.asarray(np.concatenate([[0.0], VARIANCES]), direction.dtype)
    spread = jnp.clip(variance.astype(direction.dtype), 0.0, variances[-1])
    # Level 0 is the sky itself, level k + 1 the k-th of the atlas.
    octave = jnp.floor(jnp.log2(jnp.maximum(spread, 1e-9) / variances[1]))
    level = once(jnp.clip(octave, -1.0, count - 2.0))
    # The widths are powers of two of the first.
    low, high = variances[1] * jnp.exp2(level), variances[1] * jnp.exp2(level + 1.0)
    low = jnp.where(level < 0.0, 0.0, low)
    share = once((spread - low) / (high - low))
    narrow = look_up(atlas, *spot, jnp.maximum(level, 0.0), rows)
    wide = look_up(atlas, *spot, level + 1.0, rows)
    sharpest = jax.lax.cond(jnp.any(level < 0.0), sharp, lambda: jnp.zeros_like(direction))
    channels = []
    for k in range(3):
        start = jnp.where(level < 0.0, sharpest[..., k], narrow[..., k])
        channels.append(once(start + share * (wide[..., k] - start)))
    return jnp.stack(channels, axis=-1)
