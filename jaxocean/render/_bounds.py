"""How far the surface of some fields can be from the rest plane."""

import equinox as eqx
import jax.numpy as jnp

from .._types import Scalar
from ..surface import Fields


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
        furthest = jnp.max(u * u + v * v, axis=(-2, -1))
        flat = furthest > 0
        return cls(
            jnp.sum(jnp.where(flat, jnp.sqrt(jnp.where(flat, furthest, 1.0)), 0.0)),
            jnp.sum(jnp.min(fields.height, axis=(-2, -1))),
            jnp.sum(jnp.max(fields.height, axis=(-2, -1))),
        )
