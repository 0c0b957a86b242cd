"""Shading less often than at every pixel: which points stand for groups of pixels, and the image from them."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, UInt

from ._raster import EMPTY

Rate = tuple[int, int]
"""Rows and columns of a group of pixels that share one shaded point."""


def lattice(size: tuple[int, int], rate: Rate) -> tuple[int, int]:
    """Rows and columns of groups, of which those at the image's end may be cut."""
    return -(-size[0] // rate[0]), -(-size[1] // rate[1])


def seen_by_groups(triangle: UInt[Array, "rows columns"], rate: Rate) -> UInt[Array, "down across"]:
    """The triangle that stands for each group: that of its first pixel, or else of the next one that sees water."""
    rows, columns = triangle.shape
    down, across = lattice((rows, columns), rate)
    missing = down * rate[0] - rows, across * rate[1] - columns
    whole = jnp.pad(triangle, ((0, missing[0]), (0, missing[1])), constant_values=EMPTY)
    groups = whole.reshape(down, rate[0], across, rate[1])
    chosen = groups[:, 0, :, 0]
    for row in range(rate[0]):
        for column in range(rate[1]):
            chosen = jnp.where(chosen == EMPTY, groups[:, row, :, column], chosen)
    return chosen


def interpolate(
    values: Float[Array, "down across *c"], hit: Bool[Array, "down across"], size: tuple[int, int], rate: Rate
) -> Float[Array, "rows columns *c"]:
    """Linear between the first pixels of groups, of which only those count that see water.

    A pixel that sees water lies in a group that does, so that it is never without a value.
    """
    weight = hit.astype(values.dtype)
    extra = (1,) * (values.ndim - 2)
    total = _finer(_finer(weight, rate[0], size[0], 0), rate[1], size[1], 1)
    seen = jnp.where(hit.reshape(hit.shape + extra), values, 0.0)
    mixed = _finer(_finer(seen, rate[0], size[0], 0), rate[1], size[1], 1)
    return mixed / jnp.where(total > 0, total, 1.0).reshape(total.shape + extra)


def _finer(values: Float[Array, "*s"], factor: int, count: int, axis: int) -> Float[Array, "*t"]:
    """Linear between values that are `factor` apart, level after the last one; `count` in all."""
    if factor == 1:
        return values
    last = values.shape[axis] - 1
    after = jnp.concatenate(
        [
            jax.lax.slice_in_dim(values, 1, last + 1, axis=axis),
            jax.lax.slice_in_dim(values, last, last + 1, axis=axis),
        ],
        axis=axis,
    )
    share = jnp.arange(count) % factor / factor
    share = share.astype(values.dtype).reshape((-1,) + (1,) * (values.ndim - 1 - axis))

    def repeated(each):
        return jax.lax.slice_in_dim(jnp.repeat(each, factor, axis=axis), 0, count, axis=axis)

    return repeated(values) + share * repeated(after - values)
