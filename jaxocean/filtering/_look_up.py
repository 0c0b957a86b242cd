"""Trilinear look-ups in flat pyramids: the one place that touches texels."""

from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..surface.fft._apart import compute_apart
from ._boxes import Levels
from ._footprint import Footprint, probes_of

Textures = Sequence[Float[Array, "texel _"]]
"""All levels of one pattern, each texture with at most eight channels: what lies together is read together."""


def computing_type(stored: jnp.dtype) -> jnp.dtype:
    """Look-ups compute in float32 at least, however the texture is stored."""
    return jnp.dtype(jnp.float32) if stored.itemsize < 4 else stored


def reduce_centres(
    footprint: Footprint, sizes: tuple[float, ...], resolution: int, dtype: jnp.dtype
) -> Float[Array, "n *b 2"]:
    """The centres inside each pattern, in samples of that pattern.

    A NumPy array is reduced in its own precision before it is rounded to `dtype`.
    """
    centre = (
        jnp.asarray(footprint.centre) if not isinstance(footprint.centre, np.ndarray) else footprint.centre
    )
    reduced = [centre % size / size * resolution for size in sizes]
    return jnp.stack([jnp.asarray(each, dtype) for each in reduced])


def average_probes(
    look: Callable[[Float[Array, "*b 2"], Float[Array, "*b"]], tuple[Float[Array, "*b _"], ...]],
    centre: Float[Array, "*b 2"],
    axes: Float[Array, "*b 2 2"],
    count: int,
) -> tuple[Float[Array, "*b _"], ...]:
    """The mean of what the probes of a footprint see, one probe after the other.

    **Arguments:** `look`: from a place and a variance to values, in samples of a pattern; `centre`, `axes`: the
    footprint in the same unit; `count`: of the probes.
    """
    probes = probes_of(axes, count)
    if count == 1:
        return look(centre, probes.variance)

    def add(total, number):
        seen = look(centre + probes.offset(number), probes.variance)
        return jax.tree.map(jnp.add, total, seen), None

    first = look(centre + probes.offset(jnp.zeros((), centre.dtype)), probes.variance)
    total, _ = jax.lax.scan(add, first, jnp.arange(1, count, dtype=centre.dtype))
    return jax.tree.map(lambda each: each / count, total)


def look_up(
    textures: Textures,
    resolution: int,
    place: Float[Array, "*b 2"],
    variance: Float[Array, "*b"],
) -> tuple[list[Float[Array, "*b _"]], Float[Array, "*b"]]:
    """The means of the textures under an isotropic probe.

    A texel of level l with 2^l samples a side, bilinear between its neighbours, weighs the plane with a variance
    of 4^l/4 samples² along each axis, on average over its places: a tent over a box. The two levels whose variances
    enclose that of the probe are mixed in the proportion that gives its variance. Beyond the last level the mean is
    the pattern's constant.

    **Arguments:** `place` [samples] and `variance` [samples²] of the probe.

    **Returns:** the means, in the type of `place`; and how much of the spread between neighbouring samples lies
    inside the probe: 0 for a point, 1 for a probe as wide as level 0.
    """
    levels = Levels(resolution)
    widths = 0.25 * levels.spans.astype(np.float64) ** 2
    dtype = place.dtype
    level = sum((variance >= float(width)).astype(jnp.int32) for width in widths[1:-1])
    level = jnp.broadcast_to(level, variance.shape)
    below, above = (jnp.asarray(w, dtype)[level] for w in (widths[:-1], widths[1:]))
    share = jnp.clip((variance - below) / (above - below), 0, 1)[..., None]

    def read() -> list[Float[Array, "*b _"]]:
        fine = _bilinear(textures, levels, place, level)
        coarse = _bilinear(textures, levels, place, level + 1)
        return [f + share * (c - f) for f, c in zip(fine, coarse, strict=True)]

    # Products of what was read would otherwise be fused with the reading, and read again for each of them.
    means = compute_apart(read, ~jnp.all(jnp.isnan(variance)))
    return means, jnp.clip(variance / float(widths[0]), 0, 1)


def _bilinear(textures, levels: Levels, place, level) -> list[Float[Array, "*b _"]]:
    """Between the four nearest texels of a level, whose texel 0 is centred on the middle of its samples."""
    dtype = place.dtype
    count = jnp.asarray(levels.counts, jnp.int32)[level]
    start = jnp.asarray(levels.offsets[:-1], jnp.int32)[level]
    span = jnp.asarray(levels.spans, dtype)[level][..., None]
    resolution = int(levels.counts[0])
    inside = place - resolution * jnp.floor(place / resolution)
    cell = (inside - 0.5 * (span - 1)) / span
    corner = jax.lax.stop_gradient(jnp.floor(cell))
    fraction = cell - corner
    low = corner.astype(jnp.int32)
    # `low` is −1 … count: a few comparisons are cheaper than remainders.
    low = jnp.where(low < 0, low + count[..., None], low)
    low = jnp.where(low >= count[..., None], low - count[..., None], low)
    high = jnp.where(low + 1 == count[..., None], 0, low + 1)
    x, y = fraction[..., :1], fraction[..., 1:]

    rows = start + low[..., 1] * count, start + high[..., 1] * count
    corners = [row + side[..., 0] for row in rows for side in (low, high)]

    def between(texture: Float[Array, "texel c"]) -> Float[Array, "*b c"]:
        south_west, south_east, north_west, north_east = (texture[i].astype(dtype) for i in corners)
        south = south_west + x * (south_east - south_west)
        north = north_west + x * (north_east - north_west)
        return south + y * (north - south)

    return [between(texture) for texture in textures]
