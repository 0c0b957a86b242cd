"""What filtered look-ups leave out: second moments of slopes and strain by the width of the filter alone."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._elementary import once, take_together
from ..filtering._boxes import Levels
from ._atlas import Atlas
from ._look_up import level_of

STEPS_PER_OCTAVE = 4
"""Nodes of the table for each factor of two in variance."""

IN_COMMON = 1 / 4
"""How far the mean product of two neighbouring levels lies from the square of the coarser one to that of the finer one,
for strain that is spread evenly over the octaves, as that of a wind sea."""


class Residual(eqx.Module):
    """Second moments of what an `Atlas` of (a, b, c, ∂η/∂x, ∂η/∂y) leaves out, as a function of the filter's variance.

    $$ R(v) = E[x x^T] - E[\\bar x_v \\bar x_v^T] $$

    Of a Gaussian sea what a filter removes is independent of what it leaves, so that its covariance is the same
    everywhere: one table in the place of nine textures. Both expectations are means over the realised patterns, and
    patterns add. Bilinear reading is counted as part of the filter, however narrow that is: without what it leaves out
    a quarter of the strain of near water, and half of its whitecaps, would be missing.

    **Arguments:** `table`: the six of the strain and the three of the slopes [-], in the order of
    `jaxocean.filtering.pair_products`, at equal steps of log2 of the variance, from `first` on. At a point, of variance
    0, nothing is left out.
    """

    first: float = eqx.field(static=True)
    table: Float[Array, "9 node"]

    @classmethod
    def of_atlas(cls, atlas: Atlas) -> "Residual":
        """The table of an atlas with the five channels (a, b, c, ∂η/∂x, ∂η/∂y)."""
        samples = np.asarray(atlas.sizes) / atlas.resolution
        first = float(np.floor(2 * np.log2(samples.min() / 2)))
        final = float(np.ceil(2 * np.log2(max(atlas.sizes))) + 1)
        nodes = int(STEPS_PER_OCTAVE * (final - first)) + 1
        dtype = atlas.dtype
        variance = jnp.exp2(jnp.linspace(first, final, nodes, dtype=dtype))
        table = jnp.zeros((9, nodes), dtype)
        for pattern, sample in enumerate(samples):
            left_out = _left_out(atlas, pattern)
            wide = variance / float(sample) ** 2
            level, share = level_of(wide, atlas.resolution)
            keep = (1 - share) * (1 - share + 2 * IN_COMMON * share)
            mixed = left_out[:, level] * keep + left_out[:, level + 1] * (1 - keep)
            table = table + mixed
        return cls(first, table)

    def __call__(self, variance: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], ...]:
        """The nine second moments under isotropic filters with a variance [m²] along each axis."""
        last = self.table.shape[1] - 1
        place = (jnp.log2(jnp.maximum(variance, 2.0**self.first)) - self.first) * STEPS_PER_OCTAVE
        place = jnp.clip(place, 0, last)
        whole = once(jnp.minimum(jax.lax.stop_gradient(jnp.floor(place)), last - 1))
        node, share = whole.astype(jnp.int32), once(place - whole)
        wide = variance > 0

        lower, upper = (take_together(tuple(self.table), node + i) for i in (0, 1))
        between = (low + share * (high - low) for low, high in zip(lower, upper, strict=True))
        return tuple(once(jnp.where(wide, each, 0.0)) for each in between)


def _left_out(atlas: Atlas, pattern: int) -> Float[Array, "9 level"]:
    """What bilinear reading of each level of one pattern leaves out."""
    last = len(Levels(atlas.resolution).counts) - 1
    total = _second_moments(atlas.level(0, pattern))
    rows = [total - _read_moments(atlas.level(number, pattern)) for number in range(last + 1)]
    return jnp.maximum(
        jnp.stack(rows, axis=-1),
        jnp.asarray([0.0] * 3 + [-jnp.inf] * 3 + [0.0] * 2 + [-jnp.inf], total.dtype)[:, None],
    )


def _second_moments(values: Float[Array, "5 y x"]) -> Float[Array, "9"]:
    flat = values.reshape(5, -1)
    gram = jnp.matmul(flat, flat.T, precision="highest") / flat.shape[1]
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0), (3, 3), (4, 4), (3, 4))
    return jnp.stack([gram[i, j] for i, j in pairs])


def _read_moments(texels: Float[Array, "5 y x"]) -> Float[Array, "9"]:
    """Second moments of a bilinear surface: along each axis a third of the texels' and two thirds of the midpoints'."""
    middle_x = 0.5 * (texels + jnp.roll(texels, -1, axis=-1))
    middle_y = 0.5 * (texels + jnp.roll(texels, -1, axis=-2))
    middle = 0.5 * (middle_x + jnp.roll(middle_x, -1, axis=-2))
    weighted = ((texels, 1 / 9), (middle_x, 2 / 9), (middle_y, 2 / 9), (middle, 4 / 9))
    return sum((_second_moments(v) * w for v, w in weighted), start=jnp.zeros(9, texels.dtype))
