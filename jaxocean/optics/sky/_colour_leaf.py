"""Colours as leaves: three numbers, or one for grey."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, is_concrete
from ..._types import PerPattern
from .._colour import luminance


def as_colour(value: PerPattern) -> Float[Array, "..."]:
    """Turn three numbers, or one number for all three channels, into a leaf (3,)."""
    leaf = as_leaf(jnp.asarray(value))
    return jnp.broadcast_to(leaf, (3,)) if leaf.ndim == 0 else leaf


def check_colour(name: str, value: Float[Array, "..."], unit: str) -> None:
    """Raise one clear sentence unless a leaf holds three finite numbers of no negative luminance; tracers pass.

    A single channel may be negative: that is a colour outside of sRGB.

    **Raises:** `ValueError` that names the argument, what it must be and what it is.
    """
    if not isinstance(value, jax.Array | np.ndarray):
        return
    if value.shape != (3,):
        raise ValueError(
            f"Argument `{name}` must be one number or three (red, green, blue), but has shape {value.shape}."
        )
    if not is_concrete(value):
        return
    colour = np.asarray(value)
    if not np.all(np.isfinite(colour)) or float(luminance(jnp.asarray(colour))) < 0.0:
        raise ValueError(
            f"Argument `{name}` must be finite with a luminance of at least 0 {unit}, but is {colour.tolist()}."
        )
