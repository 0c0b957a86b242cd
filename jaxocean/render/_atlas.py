"""All levels of all patterns in flat textures, and their sum under an isotropic filter."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..filtering._boxes import Levels
from ._look_up import look_up
from ._textures import Pairs, bordered, halved

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
        # What holds nothing can still be varied: then all of it is heard.
        empty = jnp.all(energy[0] == 0, axis=0)
        heard = jnp.any(energy > SILENT * energy[0], axis=1) | empty
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
        given = (self.textures, self.silent, self.pairs, centre, x, y, variance)
        return look_up(self.sizes, self.resolution, *given)
