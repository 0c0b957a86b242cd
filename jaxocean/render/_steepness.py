"""How fast filtered look-ups can change from place to place: what makes a step along a ray safe."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..filtering._boxes import Levels
from ._atlas import Atlas
from ._look_up import level_of

STEPS_PER_OCTAVE = 4
"""Nodes of the table for each factor of two in variance."""


class Steepness(eqx.Module):
    """The steepest gradients of displacement and height, as functions of the filter's variance.

    Between texels the look-ups are bilinear, so that the gradient of a pattern never exceeds the largest difference
    between its neighbouring texels; the means of a coarser level differ by less than those of the finer one. Of the sum
    of the patterns the root of the sum of their squares is taken: patterns are independent, so that the steepest of as
    many places as a pattern has texels is as steep as that. It may be exceeded, unlike the sum of the maxima, which is
    never reached in practice. What the change of the filter from place to place adds is left out.

    **Arguments:** `table`: largest |∇(u, v)| and |∇η| [-] at equal steps of log2 of the variance, from `first` on.
    """

    first: float = eqx.field(static=True)
    table: Float[Array, "2 node"]

    @classmethod
    def of_atlas(cls, atlas: Atlas) -> "Steepness":
        """The bounds of an atlas with the three channels (u, v, η)."""
        samples = np.asarray(atlas.sizes) / atlas.resolution
        first = float(np.floor(2 * np.log2(samples.min() / 2)))
        final = float(np.ceil(2 * np.log2(max(atlas.sizes))) + 1)
        dtype = atlas.dtype
        variance = jnp.exp2(
            jnp.linspace(first, final, int(STEPS_PER_OCTAVE * (final - first)) + 1, dtype=dtype)
        )
        table = jnp.zeros((2, variance.size), dtype)
        for pattern, sample in enumerate(samples):
            levels = range(len(Levels(atlas.resolution).counts))
            steepest = jnp.stack([_steepest(atlas, number, pattern) for number in levels], axis=-1)
            level, share = level_of(variance / float(sample) ** 2, atlas.resolution)
            table = table + jnp.square(steepest[:, level] * (1 - share) + steepest[:, level + 1] * share)
        return cls(first, jnp.sqrt(table))

    def __call__(self, variance: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """The largest |∇(u, v)| and |∇η| [-] for filters with at least this variance [m²] along each axis."""
        place = (jnp.log2(jnp.maximum(variance, 2.0**self.first)) - self.first) * STEPS_PER_OCTAVE
        node = jnp.clip(place, 0, self.table.shape[1] - 1).astype(jnp.int32)
        moved, raised = (row.at[node].get(mode="promise_in_bounds") for row in self.table)
        return moved, raised


def _steepest(atlas: Atlas, number: int, pattern: int) -> Float[Array, "2"]:
    texels = atlas.level(number, pattern)
    spacing = atlas.sizes[pattern] / texels.shape[-1]
    steps = [
        jnp.max(jnp.square(jnp.roll(texels, -1, axis=axis) - texels), axis=(-2, -1)) for axis in (-1, -2)
    ]
    u, v, height = (steps[0] + steps[1]) / spacing**2
    return jnp.sqrt(jnp.stack([u + v, height]))
