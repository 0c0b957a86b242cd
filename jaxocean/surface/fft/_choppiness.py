"""One choppiness for all patterns, or one for each."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, is_concrete
from ..._types import PerPattern


def pattern_choppiness(choppiness: PerPattern, count: int) -> Float[Array, " pattern"]:
    """λ_i [-] of `count` patterns.

    **Raises:** `ValueError` unless there is one number, or one for each pattern, and all are finite.
    """
    if isinstance(choppiness, Sequence):
        arrays = any(isinstance(value, jax.Array) for value in choppiness)
        values = (
            jnp.stack([as_leaf(value) for value in choppiness]) if arrays else np.asarray(choppiness, float)
        )
    else:
        values = choppiness if isinstance(choppiness, jax.Array) else np.asarray(choppiness)
    if values.ndim > 1 or (values.ndim == 1 and values.shape[0] != count):
        raise ValueError(
            f"Argument `choppiness` must be one number or one for each of the {count} patterns, "
            f"but has shape {values.shape}."
        )
    if is_concrete(values) and not np.all(np.isfinite(values)):
        raise ValueError(f"Argument `choppiness` must be finite, but is {values}.")
    if isinstance(values, np.ndarray):
        return as_leaf(np.broadcast_to(values, (count,)))
    return jnp.broadcast_to(as_leaf(values), (count,))
