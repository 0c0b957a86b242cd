"""All levels of all patterns in flat textures, and their sum under an isotropic filter."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ..filtering._boxes import Levels
from ._textures import BEFORE, BORDER, Pairs, Spot, bordered, halved, read, read_pairs

SILENT = 1e-5
"""Share of a pattern's variance below which a level of it counts as empty."""


class Atlas(eqx.Module):
    """Channels of all patterns, each one texture with the levels of a pattern below one another.

    One texture for each channel and pattern: XLA on the CPU then reads sixteen pixels with one instruction. All
    levels have rows of one length, however few texels they fill, so that the next row is equally far everywhere.

    **Arguments:** `sizes` L_i [m] and `resolution`, samples a side; `levels`: of all patterns, finest first;
    `textures`: the same with borders; `silent`: the level from which on each pattern counts as empty, up to which it
    fades out; `pairs`: the textures rounded to 16 bits, which are read instead if they are there.
    """

    sizes: tuple[float, ...] = eqx.field(static=True)
    resolution: int = eqx.field(static=True)
    levels: tuple[Float[Array, "channel pattern _ _"], ...]
    textures: Float[Array, "channel pattern texel"]
    silent: Float[Array, " pattern"]
    pairs: Pairs | None = None

    @classmethod
    def from_channels(
        cls, channels: Float[Array, "channel pattern y x"], sizes: tuple[float, ...], *, rounded: bool = False
    ) -> "Atlas":
        """The atlas of fields without mean that are sampled on the patterns' grids.

        **Arguments:** `rounded`: whether single precision may be read with an error of 1/65000 of the largest sample:
        half the reading. Derivatives are those of what is not rounded.
        """
        resolution = channels.shape[-1]
        levels = [channels]
        for count in Levels(resolution).counts[1:]:
            levels.append(halved(levels[-1], levels[-1].shape[-1] // int(count)))
        energy = jnp.stack([jnp.mean(jnp.square(jax.lax.stop_gradient(v)), axis=(-2, -1)) for v in levels])
        heard = jnp.any(energy > SILENT * energy[0], axis=1)
        highest = jnp.sum(jnp.cumsum(heard[::-1], axis=0) > 0, axis=0)
        pairs = Pairs.of_levels(levels) if rounded and channels.dtype == jnp.float32 else None
        return cls(sizes, resolution, tuple(levels), bordered(levels), highest.astype(channels.dtype), pairs)

    @property
    def dtype(self) -> jnp.dtype:
        """Type of the texels."""
        return self.silent.dtype

    def level(self, number: int, pattern: int) -> Float[Array, "channel y x"]:
        """One level of one pattern."""
        return self.levels[number][:, pattern]

    def __call__(
        self,
        centre: Float[Array, "2"],
        x: Float[Array, "*b"],
        y: Float[Array, "*b"],
        variance: Float[Array, "*b"],
    ) -> tuple[Float[Array, "*b"], ...]:
        """Each channel's sum over the patterns, filtered.

        A texel of level l, bilinear between its neighbours, weighs the plane with a variance of 4^l/4 samples² along
        each axis. Between two levels the mixture goes with the logarithm.

        **Arguments:** `centre` and (`x`, `y`) [m]: the place is their sum, of which each is reduced by itself, so that
        a camera far from the origin loses no digits; `variance` [m²] of the filter along each axis.
        """
        given = (centre, x, y, variance)
        if self.pairs is None:
            return _exact(self.sizes, self.resolution, self.textures, self.silent, *given)
        return _rounded(self.sizes, self.resolution, self.textures, self.silent, self.pairs, *given)


def _exact(sizes, resolution, textures, silent, centre, x, y, variance) -> tuple[Float[Array, "*b"], ...]:
    return _sum(sizes, resolution, textures, None, silent, centre, x, y, variance)


@partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def _rounded(
    sizes, resolution, textures, silent, pairs: Pairs, centre, x, y, variance
) -> tuple[Float[Array, "*b"], ...]:
    return _sum(sizes, resolution, pairs.textures, pairs.steps, silent, centre, x, y, variance)


@_rounded.defjvp
def _rounded_jvp(sizes, resolution, primals, tangents):
    values, changes = ((*each[:2], *each[3:]) for each in (primals, tangents))
    return _rounded(sizes, resolution, *primals), jax.jvp(
        partial(_exact, sizes, resolution), values, changes
    )[1]


def _sum(
    sizes, resolution, textures, steps, silent, centre, x, y, variance
) -> tuple[Float[Array, "*b"], ...]:
    """Of all patterns; of pairs if there are `steps`."""
    count = len(textures)
    total = (jnp.zeros_like(variance),) * count
    texels = textures.ravel()
    # Once for all patterns, which differ by a constant.
    logarithm = 0.5 * jnp.log2(jnp.maximum(variance, 1e-20))
    for pattern, size in enumerate(sizes):
        exact = _clipped(logarithm + float(np.log2(2 * resolution / size)), resolution)
        heard = jnp.clip(silent[pattern] - exact, 0, 1)
        starts = [(channel * len(sizes) + pattern) * textures.shape[-1] for channel in range(count)]
        factors = (1.0,) * count if steps is None else steps[:, pattern]
        take = read if steps is None else read_pairs

        def nothing(total=total):
            return total

        def finest(total=total, size=size, heard=heard, starts=starts, factors=factors, take=take):
            place = _turns(centre[0], x, size), _turns(centre[1], y, size)
            spot = _spot(resolution, None, *place)
            return tuple(
                t + heard * factor * take(texels, start, spot)
                for t, start, factor in zip(total, starts, factors, strict=True)
            )

        def mixture(
            total=total, size=size, exact=exact, heard=heard, starts=starts, factors=factors, take=take
        ):
            place = _turns(centre[0], x, size), _turns(centre[1], y, size)
            level, share = _split(exact, resolution)
            fine, coarse = _spot(resolution, level, *place), _spot(resolution, level + 1, *place)

            def one(start, factor):
                first = take(texels, start, fine)
                return heard * factor * (first + share * (take(texels, start, coarse) - first))

            return tuple(t + one(*each) for t, *each in zip(total, starts, factors, strict=True))

        choice = jnp.where(jnp.any(heard > 0), 1 + jnp.any(exact > 0).astype(jnp.int32), 0)
        total = jax.lax.switch(choice, (nothing, finest, mixture))
    return total


def _spot(
    resolution: int, level: Int[Array, "*b"] | None, x: Float[Array, "*b"], y: Float[Array, "*b"]
) -> Spot:
    """Where parts x, y of a pattern's size lie in one of its levels, the finest if None."""
    counts, stride = Levels(resolution).counts, resolution + BORDER
    last = len(counts) - 1
    if level is None:
        u, v, start = x * resolution, y * resolution, BEFORE
    else:
        # Closed forms instead of tables: reading a table costs more than counting.
        count = resolution >> level
        start = 2 * (resolution - count) + BORDER * level
        if 1 << last != resolution:  # the last level is no half of the one before
            count = jnp.where(level == last, 1, count)
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


def level_of(variance: Float[Array, "*b"], resolution: int) -> tuple[Int[Array, "*b"], Float[Array, "*b"]]:
    """The finer of two levels for a variance [samples²], and the share of the coarser one."""
    return _split(_clipped(0.5 * jnp.log2(jnp.maximum(4 * variance, 1.0)), resolution), resolution)


def _clipped(level: Float[Array, "*b"], resolution: int) -> Float[Array, "*b"]:
    return jnp.clip(level, 0, len(Levels(resolution).counts) - 1)


def _split(exact: Float[Array, "*b"], resolution: int) -> tuple[Int[Array, "*b"], Float[Array, "*b"]]:
    level = jax.lax.stop_gradient(exact).astype(jnp.int32)
    level = jnp.minimum(level, len(Levels(resolution).counts) - 2)
    return level, exact - level.astype(exact.dtype)


def _turns(centre: Float[Array, ""], offset: Float[Array, "*b"], size: float) -> Float[Array, "*b"]:
    """Parts of a pattern's size, 0 to 1."""
    start = centre / size
    turns = (start - jax.lax.stop_gradient(jnp.floor(start))) + offset * (1 / size)
    return turns - jax.lax.stop_gradient(jnp.floor(turns))
