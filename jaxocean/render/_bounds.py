"""How far the surface of some fields can be from the rest plane."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._numerics import largest
from .._types import Scalar
from ..surface import Cascade, Fields


class Bounds(eqx.Module):
    """Numbers [m] that the sum of the patterns never exceeds, however they meet.

    **Arguments:** `displacement`: of the length of the horizontal displacement; `lowest`, `highest`: of the height.
    """

    displacement: Scalar
    lowest: Scalar
    highest: Scalar

    @classmethod
    def of_fields(cls, fields: Fields) -> "Bounds":
        """The bounds of fields at one time: the sums of each pattern's own."""
        u, v = fields.displacement[..., 0], fields.displacement[..., 1]
        furthest = largest(u * u + v * v)
        flat = furthest > 0
        return cls(
            jnp.sum(jnp.where(flat, jnp.sqrt(jnp.where(flat, furthest, 1.0)), 0.0)),
            -jnp.sum(largest(-fields.height)),
            jnp.sum(largest(fields.height)),
        )


@eqx.filter_jit
def highest_over(fields: Fields, cascade: Cascade, place: Float[Array, "pattern 2"]) -> Scalar:
    """A height [m] that the water over a place never exceeds.

    Of each pattern what lies so near that all patterns together can move it there, and what may rise between samples.

    **Arguments:** `place`: (x, y) [m] on each pattern, from 0 to its size.
    """
    displacement = Bounds.of_fields(fields).displacement
    bounds = []
    for number, size in enumerate(cascade.sizes):
        height, count = fields.height[number], cascade.resolution
        sample = size / count
        x, y = (
            jnp.abs(
                (jnp.arange(count, dtype=height.dtype) * sample - place[number, i] + 0.5 * size) % size
                - 0.5 * size
            )
            for i in (0, 1)
        )
        near = x[None] ** 2 + y[:, None] ** 2 <= (displacement + 2 * sample) ** 2
        steps = (jnp.max(jnp.abs(jnp.roll(height, 1, axis=axis) - height)) for axis in (0, 1))
        bounds.append(jnp.max(jnp.where(near, height, -jnp.inf)) + 0.5 * sum(steps))
    return sum(bounds[1:], start=bounds[0])
