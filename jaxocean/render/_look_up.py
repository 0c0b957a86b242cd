"""Filtered look-ups in the textures of an atlas, and their derivative."""

import math
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jaxtyping import Array, Float, Int

from ..filtering._boxes import Levels
from ._textures import BEFORE, BORDER, Pairs, Spot, corners, read, read_pairs, slopes

SMALLEST = 1e-20
"""Variance [m²] below which a filter is a point."""


@partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def look_up(
    sizes: tuple[float, ...],
    resolution: int,
    textures: Float[Array, "channel pattern texel"],
    silent: Float[Array, " pattern"],
    pairs: Pairs | None,
    centre: Float[Array, "2"],
    x: Float[Array, "*b"],
    y: Float[Array, "*b"],
    variance: Float[Array, "*b"],
) -> tuple[Float[Array, "*b"], ...]:
    """Each channel's sum over the patterns at centre + (x, y); see `Atlas`, whose arrays these are.

    Patterns and levels that no point needs are not read. The derivative has no such branches: how the sum changes with
    place and filter is found once for all directions, and how it changes with the texels is one weighted sum of them,
    which in reverse adds to all channels of a texel at once.
    """
    read_texture, steps = (read, None) if pairs is None else (read_pairs, pairs.steps)
    texels = (textures if pairs is None else pairs.textures).ravel()
    count = len(textures)
    total = (jnp.zeros_like(variance),) * count
    # Once for all patterns, which differ by a constant.
    logarithm = _logarithm(variance)
    for pattern, size in enumerate(sizes):
        exact = _clipped(logarithm + math.log2(2 * resolution / size), resolution)
        heard = jnp.clip(silent[pattern] - exact, 0, 1)
        starts = [(channel * len(sizes) + pattern) * textures.shape[-1] for channel in range(count)]
        factors = (1.0,) * count if steps is None else steps[:, pattern]

        def nothing(total=total):
            return total

        def finest(total=total, size=size, heard=heard, starts=starts, factors=factors):
            place = _turns(centre[0], x, size), _turns(centre[1], y, size)
            spot = _spot(resolution, None, *place)
            return tuple(
                t + heard * factor * read_texture(texels, start, spot)
                for t, start, factor in zip(total, starts, factors, strict=True)
            )

        def mixture(total=total, size=size, exact=exact, heard=heard, starts=starts, factors=factors):
            place = _turns(centre[0], x, size), _turns(centre[1], y, size)
            level, share = _split(exact, resolution)
            fine, coarse = _spot(resolution, level, *place), _spot(resolution, level + 1, *place)

            def one(start, factor):
                first = read_texture(texels, start, fine)
                return heard * factor * (first + share * (read_texture(texels, start, coarse) - first))

            return tuple(t + one(*each) for t, *each in zip(total, starts, factors, strict=True))

        choice = jnp.where(jnp.any(heard > 0), 1 + jnp.any(exact > 0).astype(jnp.int32), 0)
        total = jax.lax.switch(choice, (nothing, finest, mixture))
    return total


class _Change(NamedTuple):
    """How the sums change with x, y and the variance, an array for each channel."""

    x: tuple[Float[Array, "*b"], ...]
    y: tuple[Float[Array, "*b"], ...]
    variance: tuple[Float[Array, "*b"], ...]


class _Weights(NamedTuple):
    """Texels and weights of both levels of each pattern."""

    texel: Int[Array, "pattern level *b"]
    east: Float[Array, "pattern level *b"]
    north: Float[Array, "pattern level *b"]
    weight: Float[Array, "pattern level *b"]


def _change(sizes, resolution, textures, silent, centre, x, y, variance) -> tuple[_Change, _Weights]:
    """One pattern after the other in a loop: all in one program take the compiler minutes."""
    logarithm = _logarithm(variance)
    count = len(textures)
    last = len(Levels(resolution).counts) - 1
    by_logarithm = jnp.where(variance > SMALLEST, 0.5 / math.log(2) / jnp.maximum(variance, SMALLEST), 0.0)

    def add(total: _Change, pattern) -> tuple[_Change, _Weights]:
        texels, silent, size, octaves, turns = pattern
        raw = logarithm + octaves
        exact = _clipped(raw, resolution)
        inside = (raw > 0) & (raw < last)
        heard = jnp.clip(silent - exact, 0, 1)
        fades = (silent - exact > 0) & (silent - exact < 1)
        level, share = _split(exact, resolution)
        u, v = (_fraction(turn + offset / size) for turn, offset in zip(turns, (x, y), strict=True))
        fine, coarse = _spot(resolution, level, u, v), _spot(resolution, level + 1, u, v)
        near, far = (_count(resolution, each).astype(x.dtype) / size for each in (level, level + 1))
        by_level = jnp.where(inside, by_logarithm, 0.0)
        nearer, farther = heard * (1 - share), heard * share
        parts = []
        for channel in range(count):
            first, first_east, first_north = slopes(texels[channel], fine)
            second, second_east, second_north = slopes(texels[channel], coarse)
            mixed = first + share * (second - first)
            parts.append(
                (
                    nearer * near * first_east + farther * far * second_east,
                    nearer * near * first_north + farther * far * second_north,
                    by_level * (heard * (second - first) - jnp.where(fades, mixed, 0.0)),
                )
            )
        added = _Change(*zip(*parts, strict=True))
        texel, east, north = (
            jnp.stack([getattr(s, name) for s in (fine, coarse)]) for name in ("texel", "east", "north")
        )
        weights = _Weights(texel, east, north, jnp.stack([nearer, farther]))
        return jax.tree.map(jnp.add, total, added), weights

    nothing = (jnp.zeros_like(variance),) * count
    numbers = np.asarray(sizes)
    patterns = (
        jnp.moveaxis(textures, 1, 0),
        silent,
        jnp.asarray(numbers, x.dtype),
        jnp.asarray(np.log2(2 * resolution / numbers), x.dtype),
        jnp.stack([jnp.stack([_fraction(each / size) for each in centre]) for size in sizes]),
    )
    return jax.lax.scan(add, _Change(nothing, nothing, nothing), patterns)


def _weighted(
    weights: _Weights, stride: int, changes: Float[Array, "channel pattern texel"]
) -> list[Float[Array, "*b"]]:
    """The same weighted sums of other texels: linear in them."""

    def add(total, pattern):
        own, texels = pattern
        for level in range(2):
            spot = Spot(own.texel[level], stride, own.east[level], own.north[level])
            for texel, share in corners(spot):
                rows = texels.at[texel].get(mode="promise_in_bounds")
                total = total + (own.weight[level] * share)[..., None] * rows
        return total, None

    shape = (*weights.texel.shape[2:], changes.shape[0])
    total = jax.lax.scan(
        add, jnp.zeros(shape, changes.dtype), (weights, jnp.moveaxis(changes, (1, 2), (0, 1)))
    )[0]
    return [total[..., channel] for channel in range(changes.shape[0])]


def _look_up_jvp(sizes, resolution, primals, tangents):
    textures, silent, _, centre, x, y, variance = primals
    moved, _, _, by_centre, by_x, by_y, by_variance = tangents
    values = look_up(sizes, resolution, *primals)
    change, weights = _change(sizes, resolution, textures, silent, centre, x, y, variance)
    changes = [jnp.zeros_like(value) for value in values]
    if not isinstance(moved, SymbolicZero):
        changes = _weighted(weights, resolution + BORDER, moved)
    steps = [(change.x, by_x), (change.y, by_y), (change.variance, by_variance)]
    if not isinstance(by_centre, SymbolicZero):
        steps += [(change.x, by_centre[0]), (change.y, by_centre[1])]
    for rates, step in steps:
        if not isinstance(step, SymbolicZero):
            changes = [total + rate * step for total, rate in zip(changes, rates, strict=True)]
    return values, tuple(changes)


look_up.defjvp(_look_up_jvp, symbolic_zeros=True)


def level_of(variance: Float[Array, "*b"], resolution: int) -> tuple[Int[Array, "*b"], Float[Array, "*b"]]:
    """The finer of two levels for a variance [samples²], and the share of the coarser one."""
    return _split(_clipped(0.5 * jnp.log2(jnp.maximum(4 * variance, 1.0)), resolution), resolution)


def _logarithm(variance: Float[Array, "*b"]) -> Float[Array, "*b"]:
    return 0.5 * jnp.log2(jnp.maximum(variance, SMALLEST))


def _clipped(level: Float[Array, "*b"], resolution: int) -> Float[Array, "*b"]:
    """A level between those that there are."""
    return jnp.clip(level, 0, len(Levels(resolution).counts) - 1)


def _split(exact: Float[Array, "*b"], resolution: int) -> tuple[Int[Array, "*b"], Float[Array, "*b"]]:
    """The finer of two levels, and the share of the coarser one."""
    level = jax.lax.stop_gradient(exact).astype(jnp.int32)
    level = jnp.minimum(level, len(Levels(resolution).counts) - 2)
    return level, exact - level.astype(exact.dtype)


def _count(resolution: int, level: Int[Array, "*b"]) -> Int[Array, "*b"]:
    """Texels a side of a level, in closed form: reading a table costs more than counting."""
    last = len(Levels(resolution).counts) - 1
    count = resolution >> level
    # The last level may be no half of the one before.
    return count if 1 << last == resolution else jnp.where(level == last, 1, count)


def _spot(
    resolution: int, level: Int[Array, "*b"] | None, x: Float[Array, "*b"], y: Float[Array, "*b"]
) -> Spot:
    """Where parts x, y of a pattern's size lie in one of its levels, the finest if None."""
    counts, stride = Levels(resolution).counts, resolution + BORDER
    last = len(counts) - 1
    if level is None:
        u, v, start = x * resolution, y * resolution, BEFORE
    else:
        count = _count(resolution, level)
        start = 2 * (resolution - count) + BORDER * level
        if 1 << last != resolution:
            start = jnp.where(level == last, int(np.sum(counts[:last] + BORDER)), start)
        side, start = count.astype(x.dtype), start.astype(x.dtype) + BEFORE
        # Texel 0 is centred on the middle of its samples, the first of which lies at 0.
        shift = side * (0.5 / resolution) - 0.5
        u, v = x * side + shift, y * side + shift
    west, south = jax.lax.stop_gradient(jnp.floor(u)), jax.lax.stop_gradient(jnp.floor(v))
    row, column = south + start, west + BEFORE
    if (np.sum(counts + BORDER)) * stride < 2 ** (jnp.finfo(x.dtype).nmant + 1):
        texel = (row * stride + column).astype(jnp.int32)
    else:
        texel = row.astype(jnp.int32) * stride + column.astype(jnp.int32)
    return Spot(texel, stride, u - west, v - south)


def _turns(centre: Float[Array, ""], offset: Float[Array, "*b"], size: float) -> Float[Array, "*b"]:
    """Parts of a pattern's size, 0 to 1."""
    return _fraction(_fraction(centre / size) + offset * (1 / size))


def _fraction(turns: Float[Array, "*b"]) -> Float[Array, "*b"]:
    return turns - jnp.floor(turns)
