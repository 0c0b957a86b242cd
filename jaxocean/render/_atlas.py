"""All levels of all patterns in flat textures, and their sum under an isotropic filter."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..filtering._boxes import Levels

SILENT = 1e-5
"""Share of a pattern's variance below which a level of it counts as empty."""


class Atlas(eqx.Module):
    """Channels of all patterns, each one flat texture with all levels of one pattern behind those of the other.

    One texture for each channel: XLA on the CPU then reads sixteen pixels with one instruction.

    **Arguments:** `sizes` L_i [m] and `resolution`, samples a side; `channels`: the textures; `silent`: the level from
    which on each pattern counts as empty, up to which it fades out.
    """

    sizes: tuple[float, ...] = eqx.field(static=True)
    resolution: int = eqx.field(static=True)
    channels: Float[Array, "channel texel"]
    silent: Float[Array, " pattern"]

    @classmethod
    def from_channels(
        cls, channels: Float[Array, "channel pattern y x"], sizes: tuple[float, ...]
    ) -> "Atlas":
        """The atlas of fields without mean that are sampled on the patterns' grids."""
        count, patterns, resolution, _ = channels.shape
        levels = Levels(resolution)
        flat = levels.build(channels.reshape(count * patterns, resolution, resolution, 1))
        flat = flat.reshape(count, patterns, -1)
        squares = jnp.square(jax.lax.stop_gradient(flat))
        parts = zip(levels.offsets[:-1], levels.offsets[1:], strict=True)
        energy = jnp.stack([jnp.mean(squares[..., start:end], axis=-1) for start, end in parts])
        heard = jnp.any(energy > SILENT * energy[0], axis=1)
        highest = jnp.sum(jnp.cumsum(heard[::-1], axis=0) > 0, axis=0)
        return cls(sizes, resolution, flat.reshape(count, -1), highest.astype(flat.dtype))

    def level(self, number: int, pattern: int) -> Float[Array, "channel y x"]:
        """One level of one pattern."""
        levels = Levels(self.resolution)
        start = pattern * levels.offsets[-1] + levels.offsets[number]
        side = int(levels.counts[number])
        return self.channels[:, start : start + side**2].reshape(-1, side, side)

    def __call__(
        self,
        centre: Float[Array, "2"],
        x: Float[Array, "*b"],
        y: Float[Array, "*b"],
        variance: Float[Array, "*b"],
    ) -> tuple[Float[Array, "*b"], ...]:
        """Each channel's sum over the patterns, filtered.

        A texel of level l, bilinear between its neighbours, weighs the plane with a variance of 4^l/4 samples² along
        each axis. Between two levels the mixture goes with the logarithm. What no point needs is not read: points of
        about one variance are best asked together.

        **Arguments:** `centre` and (`x`, `y`) [m]: the place is their sum, of which each is reduced by itself, so that
        a camera far from the origin loses no digits; `variance` [m²] of the filter along each axis.
        """
        total = tuple(jnp.zeros_like(variance) for _ in self.channels)
        for pattern, size in enumerate(self.sizes):
            level, share = level_of(variance * (self.resolution / size) ** 2, self.resolution)
            heard = jnp.clip(self.silent[pattern] - level.astype(share.dtype) - share, 0, 1)
            place = _turns(centre[0], x, size), _turns(centre[1], y, size)

            read = partial(self._levels, pattern, level, share, heard, place)
            branches = (partial(read, 0), partial(read, 1), partial(read, 2))
            blurred = jnp.any((level > 0) | (share > 0)).astype(jnp.int32)
            choice = jnp.where(jnp.any(heard > 0), 1 + blurred, 0)
            found = jax.lax.switch(choice, branches)
            total = tuple(t + f for t, f in zip(total, found, strict=True))
        return total

    def _levels(self, pattern, level, share, heard, place, depth: int) -> tuple[Float[Array, "*b"], ...]:
        """What one pattern adds: nothing, its finest level alone, or the mixture of two."""
        if depth == 0:
            return tuple(jnp.zeros_like(share) for _ in self.channels)
        if depth == 1:
            return tuple(self._bilinear(pattern, jnp.zeros_like(level), place[0], place[1], heard))
        fine = self._bilinear(pattern, level, place[0], place[1], heard * (1 - share))
        coarse = self._bilinear(pattern, level + 1, place[0], place[1], heard * share)
        return tuple(f + c for f, c in zip(fine, coarse, strict=True))

    def _bilinear(
        self,
        pattern: int,
        level: Int[Array, "*b"],
        x: Float[Array, "*b"],
        y: Float[Array, "*b"],
        weight: Float[Array, "*b"],
    ) -> list[Float[Array, "*b"]]:
        """Weighted values between the four nearest texels, at parts x, y of the pattern's size."""
        levels = Levels(self.resolution)
        last, total = len(levels.counts) - 1, int(levels.offsets[-1])
        # Closed forms instead of tables: reading a table costs more than counting.
        count = jnp.where(level == last, 1, self.resolution >> level)
        start = jnp.where(level == last, total - 1, 4 * (self.resolution**2 - count * count) // 3)
        side = count.astype(x.dtype)
        # Texel 0 is centred on the middle of its samples, the first of which lies at 0.
        shift = 0.5 * (side / self.resolution - 1)
        u, v = x * side + shift, y * side + shift
        west, south = jax.lax.stop_gradient(jnp.floor(u)), jax.lax.stop_gradient(jnp.floor(v))
        u, v = u - west, v - south
        x0, y0 = _wrapped(west.astype(jnp.int32), count), _wrapped(south.astype(jnp.int32), count)
        x1, y1 = _wrapped(x0 + 1, count), _wrapped(y0 + 1, count)
        start = start + pattern * total
        row0, row1 = start + y0 * count, start + y1 * count
        low, high = weight * (1 - v), weight * v
        corners = (
            (row0 + x0, low * (1 - u)),
            (row0 + x1, low * u),
            (row1 + x0, high * (1 - u)),
            (row1 + x1, high * u),
        )
        return [
            sum(
                (channel.at[texel].get(mode="promise_in_bounds") * part for texel, part in corners),
                start=jnp.zeros_like(weight),
            )
            for channel in self.channels
        ]


def level_of(variance: Float[Array, "*b"], resolution: int) -> tuple[Int[Array, "*b"], Float[Array, "*b"]]:
    """The finer of two levels for a variance [samples²], and the share of the coarser one."""
    last = len(Levels(resolution).counts) - 1
    exact = jnp.clip(0.5 * jnp.log2(jnp.maximum(4 * variance, 1.0)), 0, last)
    level = jnp.minimum(jax.lax.stop_gradient(exact).astype(jnp.int32), last - 1)
    return level, exact - level.astype(exact.dtype)


def _turns(centre: Float[Array, ""], offset: Float[Array, "*b"], size: float) -> Float[Array, "*b"]:
    """Parts of a pattern's size, 0 to 1."""
    start = centre / size
    turns = (start - jax.lax.stop_gradient(jnp.floor(start))) + offset / size
    return turns - jax.lax.stop_gradient(jnp.floor(turns))


def _wrapped(index: Int[Array, "*b"], count: Int[Array, "*b"]) -> Int[Array, "*b"]:
    """An index from −1 to count into 0 to count − 1."""
    return jnp.where(index < 0, index + count, jnp.where(index >= count, index - count, index))
