"""A wall that the compiler's fusion does not cross."""

import math
from collections.abc import Callable
from typing import TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

T = TypeVar("T")


def compute_apart(compute: Callable[[], T], sound: Bool[Array, ""], otherwise: float = math.nan) -> T:
    """The arrays of `compute()` if `sound`, else this one number everywhere.

    On the CPU, XLA would rather fuse cheap arithmetic into each of its users and repeat it there, sines and
    all, and takes optimisation barriers out before it does. It does not look into a conditional: its
    results are computed once. Derivatives pass through.
    """

    def unsound() -> T:
        return jax.tree.map(lambda s: jnp.full(s.shape, otherwise, s.dtype), jax.eval_shape(compute))

    return jax.lax.cond(sound, compute, unsound)
