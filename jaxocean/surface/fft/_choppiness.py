"""One choppiness for all patterns, or one for each."""

from collections.abc import Sequence

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
        values = jnp.stack([as_leaf(value) for value in choppiness]) if choppiness else jnp.zeros(0)
    else:
        values = as_leaf(choppiness)
    if values.ndim > 1 or (values.ndim == 1 and values.shape[0] != count):
        raise ValueError(
            f"Argument `choppiness` must be one number or one for each of the {count} patterns, "
            f"but has shape {values.shape}."
        )
    if is_concrete(values) and not np.all(np.isfinite(values)):
        raise ValueError(f"Argument `choppiness` must be finite, but is {values}.")
    return jnp.broadcast_to(values, (count,))
