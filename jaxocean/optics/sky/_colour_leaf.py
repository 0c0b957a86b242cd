"""Colours as leaves: three numbers, or one for grey."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, is_concrete


def as_colour(value: object) -> Float[Array, "..."]:
    """Turn three numbers, or one number for all three channels, into a leaf (3,)."""
    leaf = as_leaf(jnp.asarray(value))
    return jnp.broadcast_to(leaf, (3,)) if leaf.ndim == 0 else leaf


def check_colour(name: str, value: Float[Array, "..."], unit: str) -> None:
    """Raise one clear sentence unless a leaf holds three finite numbers that are not negative; tracers pass.

    **Raises:** `ValueError` that names the argument, what it must be and what it is.
    """
    if not isinstance(value, jax.Array | np.ndarray):
        return
    if value.shape != (3,):
        raise ValueError(
            f"Argument `{name}` must be one number or three (red, green, blue), but has shape {value.shape}."
        )
    if is_concrete(value) and not (bool(jnp.all(jnp.isfinite(value))) and bool(jnp.all(value >= 0))):
        raise ValueError(
            f"Argument `{name}` must be finite and at least 0 {unit}, but is {np.asarray(value).tolist()}."
        )
