"""Whitecap coverage counted on a realisation of the sea."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._types import FloatLike
from ._closures import FOLD, Measure, check_measure
from ._jacobian import AbstractBreaking, HardBreaking, jacobian

GOLDEN = ((math.sqrt(5) - 1) / 2, math.sqrt(2) - 1)
"""Irrational steps: multiples of them spread evenly over a period, for any number of shifts and patterns."""


def realised_coverage(
    strain: Float[Array, "pattern y x 3"],
    threshold: FloatLike,
    *,
    breaking: AbstractBreaking | None = None,
    measure: Measure = "projected",
    shifts: int = 1,
) -> Float[Array, ""]:
    """Whitecap coverage of one realised sea, counted sample by sample.

    The patterns repeat with different periods, so a point of the plane meets each of them at an independent place:
    their samples are added pairwise, `shifts` times with the patterns moved against each other. Folds count as in
    `ExactClosure`.

    **Arguments:**

    - `strain`: (a, b, c) of every pattern, λ included, as in `sea.fields(…).strain`.
    - `threshold`: ε [-].
    - `breaking`: the indicator, `HardBreaking()` by default; `SmoothBreaking(…)` is differentiable.
    - `measure`: "projected" or "rest" area.
    - `shifts`: how many arrangements of the patterns are averaged.

    **Returns:** W [-].

    **Raises:** `ValueError` for another measure or no shift.
    """
    check_measure(measure)
    if shifts < 1:
        raise ValueError(f"Argument `shifts` must be at least 1, but is {shifts}.")
    indicator = HardBreaking() if breaking is None else breaking
    level = jnp.asarray(threshold).astype(strain.dtype)
    patterns, rows, columns = strain.shape[:3]
    total = jnp.zeros((), strain.dtype)
    for shift in range(shifts):
        moved = [
            jnp.roll(strain[i], _offset(shift * i, (rows, columns)), axis=(0, 1)) if shift * i else strain[i]
            for i in range(patterns)
        ]
        j = jacobian(sum(moved[1:], start=moved[0]))
        if measure == "rest":
            total += jnp.mean(indicator(j, level))
        else:
            foam = jnp.mean(j * indicator(j, level))
            deep = jnp.mean(j * indicator(j, -FOLD * jnp.abs(level)))
            total += jnp.where(level > 0, foam - 2 * deep, -foam)
    return total / shifts


def _offset(step: int, shape: tuple[int, int]) -> tuple[int, int]:
    """A grid offset for the given step of the irrational sequence."""
    y, x = (int(np.floor(step * g % 1.0 * n)) for g, n in zip(GOLDEN, shape, strict=True))
    return y, x
