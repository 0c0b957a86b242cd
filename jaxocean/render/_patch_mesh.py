"""A patch of displaced sea as triangles, for other programs."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .._numerics import as_leaf, check_scalar
from .._types import ScalarLike
from ..surface import Cascade, Fields
from ._mesh import displacement_atlas

MOST_QUADS = 8192
"""Quadrilaterals along a side that are not taken for a mistake."""


def patch_mesh(
    fields: Fields,
    cascade: Cascade,
    *,
    centre: tuple[ScalarLike, ScalarLike] = (0.0, 0.0),
    side: ScalarLike = 100.0,
    quads: int = 512,
) -> tuple[Float[Array, "vertex 3"], Int[Array, "face 3"]]:
    """The displaced surface over a square of the plane at rest.

    $$ X(p) = (p + u(p), η(p)) $$

    with all patterns as they are on their grids, bilinear between samples. Nothing is filtered: quadrilaterals that are
    wider than the samples skip waves. What waves carry over its border leaves with it. Differentiable in the fields,
    the centre and the side.

    **Arguments:**

    - `fields`: of a sea at one time on the patterns of `cascade`.
    - `centre`: (x, y) of the square [m]; `side`: its length [m].
    - `quads`: along each side; each is two triangles.

    **Returns:** vertices (x, y, z) [m], (quads + 1)² of them, row by row from the least y; and the numbers of each
    triangle's three vertices, counter-clockwise seen from above, 2 quads² of them.

    **Raises:** `ValueError` for a side that is not positive or a number of quadrilaterals outside 1 to 8192.
    """
    check_scalar("side", as_leaf(side), "m", positive=True)
    if not 1 <= quads <= MOST_QUADS:
        raise ValueError(f"Argument `quads` must be 1 to {MOST_QUADS} along a side, but is {quads}.")
    dtype = fields.packed.real.dtype
    middle = jnp.stack([as_leaf(part).astype(dtype) for part in centre])
    return _patch(fields, cascade, middle, as_leaf(side).astype(dtype), quads), _faces(quads)


@eqx.filter_jit
def _patch(fields: Fields, cascade: Cascade, centre, side, quads: int) -> Float[Array, "vertex 3"]:
    across = side * jnp.linspace(-0.5, 0.5, quads + 1, dtype=side.dtype)
    y, x = (part.ravel() for part in jnp.meshgrid(across, across, indexing="ij"))
    u, v, height = displacement_atlas(fields, cascade)(centre, x, y, jnp.zeros_like(x))
    return jnp.stack([centre[0] + x + u, centre[1] + y + v, height], axis=-1)


def _faces(quads: int) -> Int[Array, "face 3"]:
    row, column = np.divmod(np.arange(quads**2), quads)
    here = row * (quads + 1) + column
    right, beyond = here + 1, here + quads + 1
    corners = np.stack([here, right, beyond + 1, here, beyond + 1, beyond], axis=-1)
    return jnp.asarray(corners.reshape(-1, 3), jnp.int32)
