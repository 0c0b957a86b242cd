"""Footprint means of foam: coverage is a fraction of area, so it filters linearly."""

import jax.numpy as jnp
from jaxtyping import Array, Float


def coverage_pyramid(coverage: Float[Array, "y x"]) -> tuple[Float[Array, "..."], ...]:
    """Means of foam coverage over squares of 1, 2, 4, … samples.

    $$ A_{l+1}(y, x) = ¼ Σ_{i,j ∈ \\{0, 1\\}} A_l(2y + i, 2x + j) $$

    No closure is needed: unlike j, coverage is what a pixel averages, so a plain mean over a footprint is right at
    every scale, and means of means are means. (In projected area it is the mean of j A that is plain.)

    **Arguments:** `coverage` A [-] on the lattice of a tile, or any field that is to be averaged by rest area.

    **Returns:** one array per level, the first is `coverage` itself; halving stops at an odd side.

    **Raises:** `ValueError` for a field that is not square.
    """
    rows, columns = coverage.shape
    if rows != columns:
        raise ValueError(f"Argument `coverage` must be square, but has shape {coverage.shape}.")
    levels = [coverage]
    while levels[-1].shape[0] % 2 == 0:
        half = levels[-1].shape[0] // 2
        levels.append(jnp.mean(levels[-1].reshape(half, 2, half, 2), axis=(1, 3)))
    return tuple(levels)
