"""The upper half of an equirectangular panorama: where its pixels look, and what is seen in a direction."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._elementary import once, take_together
from ..._types import Scalar
from ._angles import angle_between, azimuth_of


def pixel_directions(rows: int, dtype: jnp.dtype) -> Float[Array, "half w 3"]:
    """Unit vectors to the pixels' centres: the upper half of `rows` rows from pole to pole, twice as many columns."""
    zenith = math.pi * (np.arange(rows // 2) + 0.5)[:, None] / rows
    azimuth = 2.0 * math.pi * (0.75 - (np.arange(2 * rows) + 0.5) / (2 * rows))
    flat, upward = np.sin(zenith), np.broadcast_to(np.cos(zenith), (rows // 2, 2 * rows))
    return jnp.asarray(np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), upward], axis=-1), dtype)


def place(
    direction: Float[Array, "*b 3"], rotation: Scalar | float = 0.0
) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
    """Where a direction is seen: the fraction of the way from the zenith to the horizon, and that across the image.

    A direction below the horizon is mirrored.
    """
    x, y, z = direction[..., 0], direction[..., 1], jnp.abs(direction[..., 2])
    half = 0.5 * (x * x + y * y + (1.0 - z) * (1.0 - z))
    azimuth = azimuth_of(x, y) - jnp.asarray(rotation, direction.dtype)
    turn = 0.75 - azimuth / (2.0 * math.pi)
    return angle_between(half) * (2.0 / math.pi), turn - jnp.floor(turn)


def look_up(
    texture: Float[Array, "y x 3"],
    down: Float[Array, "*b"],
    across: Float[Array, "*b"],
    page: Float[Array, "*b"] | int = 0,
    rows: int | None = None,
) -> Float[Array, "*b 3"]:
    """Bilinear look-up. Columns wrap, rows stop half a pixel before the zenith and the horizon.

    **Arguments:** `texture`: one half panorama, or several below each other with `rows` rows each; `down`, `across`:
    as from `place`; `page`: which one, a whole number.
    """
    count, columns = texture.shape[0] if rows is None else rows, texture.shape[1]
    v = jnp.clip(down * count - 0.5, 0.0, count - 1.0)
    u = across * columns - 0.5
    top, left = jnp.clip(jnp.floor(v), 0.0, max(count - 2.0, 0.0)), jnp.floor(u)
    fv, fu = once(v - top), once(u - left)
    column = jnp.where(left < 0.0, columns - 1.0, jnp.minimum(left, columns - 1.0))
    right = jnp.where(column + 1.0 < columns, column + 1.0, 0.0)
    start = (top + jnp.asarray(page).astype(top.dtype) * count) * columns
    # Whole numbers as floats: they are exact, and computed once for all channels.
    west, east = (once(start + each).astype(jnp.int32) for each in (column, right))
    below = columns if count > 1 else 0
    flat = tuple(texture[..., k].ravel() for k in range(3))
    around = [take_together(flat, texel) for texel in (west, east, west + below, east + below)]
    channels = []
    for a, b, c, d in zip(*around, strict=True):
        upper, lower = a + fu * (b - a), c + fu * (d - c)
        channels.append(upper + fv * (lower - upper))
    return jnp.stack(channels, axis=-1)
