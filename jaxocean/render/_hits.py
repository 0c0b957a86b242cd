"""Where exactly each pixel meets the triangle that it sees: differentiable, with the visibility held."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt

from .._elementary import take_together
from ._footprint import LEAST_SHARPNESS
from ._mesh import Mesh
from ._raster import EMPTY

NEAREST = 1e-12
"""Least depth [m] by which anything is divided."""

OUTSIDE = 0.05
"""How far rounding may put a pixel's centre outside of the triangle that it sees."""


class Corner(NamedTuple):
    """One corner of the triangle that each pixel sees, around the pixel's centre.

    **Arguments:** `x`, `y`: from the centre [pixels], times the sign of `ahead`; `ahead` [m]; `offset_x`, `offset_y`:
    at rest [m]; `sharpness`: of the footprint's filter, `area`: see `Mesh`.
    """

    x: Float[Array, "rows columns"]
    y: Float[Array, "rows columns"]
    ahead: Float[Array, "rows columns"]
    offset_x: Float[Array, "rows columns"]
    offset_y: Float[Array, "rows columns"]
    sharpness: Float[Array, "rows columns"]
    area: Float[Array, "rows columns"]


class Hits(NamedTuple):
    """What each pixel's centre sees.

    **Arguments:** `hit`: whether it sees water; `ahead`: depth along the direction of view [m]; `x`, `y`: rest point
    relative to the point below the camera [m]; `variance`: of the filter that stands for its footprint [m²];
    `area`: see `Mesh`; `corners`: of the triangle. Without water, depth, variance and area are 1 and the place is 0.
    """

    hit: Bool[Array, "rows columns"]
    ahead: Float[Array, "rows columns"]
    x: Float[Array, "rows columns"]
    y: Float[Array, "rows columns"]
    variance: Float[Array, "rows columns"]
    area: Float[Array, "rows columns"]
    corners: tuple[Corner, Corner, Corner]


def triangle_vertices(
    triangle: UInt[Array, "*b"], columns: int
) -> tuple[Int[Array, "*b"], Int[Array, "*b"], Int[Array, "*b"]]:
    """Numbers of the three vertices of triangles of a mesh with `columns` vertices a row."""
    quad = (triangle >> jnp.uint32(1)).astype(jnp.int32)
    row = quad // (columns - 1)
    first = quad + row
    second = (triangle & jnp.uint32(1)) == 1
    below_right = first + columns + 1
    return first, jnp.where(second, below_right, first + columns), jnp.where(second, first + 1, below_right)


def meet(
    mesh: Mesh,
    triangle: UInt[Array, "rows columns"],
    rows: Float[Array, " rows"],
    columns: Float[Array, " columns"],
    outside: float = OUTSIDE,
) -> Hits:
    """Perspective-correct attributes at the centres of the pixels in some rows and columns of the image.

    A centre farther `outside` of its triangle, in parts of the triangle's height, is taken to be that far.

    $$ λ_0 = E_0 / ΣE, \\quad E_0 = x_1 y_2 - x_2 y_1, \\; … $$

    with the triangle's corners (x, y) around the pixel's centre, not yet divided by their depth.
    """
    hit = triangle != EMPTY
    dtype = mesh.offset.dtype
    vertices = triangle_vertices(jnp.where(hit, triangle, jnp.uint32(0)), mesh.offset.shape[1])
    table = (*mesh.screen, mesh.offset[..., 0], mesh.offset[..., 1], mesh.sharpness, mesh.area)
    flat = tuple(values.ravel() for values in table)
    px, py = columns + 0.5, (rows + 0.5)[:, None]

    def corner(vertex: Int[Array, "rows columns"]) -> Corner:
        x, y, ahead, *others = take_together(flat, vertex)
        sign = jnp.where(ahead > 0, 1.0, -1.0).astype(dtype)
        return Corner(x - px * sign, y - py * sign, ahead, *others)

    corners = (corner(vertices[0]), corner(vertices[1]), corner(vertices[2]))
    return _interpolate(hit, corners, outside)


def _edges(corners: tuple[Corner, Corner, Corner]):
    """Each corner's weight at the pixel's centre, before they are made to add up to 1."""
    parts = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        parts.append((a.x * b.y - b.x * a.y) / jnp.maximum(jnp.abs(corners[i].ahead), NEAREST))
    return parts


def _interpolate(
    hit: Bool[Array, "rows columns"], corners: tuple[Corner, Corner, Corner], outside: float = OUTSIDE
) -> Hits:
    edges = _edges(corners)
    total = edges[0] + edges[1] + edges[2]
    turn = jnp.where(total >= 0, 1.0, -1.0).astype(total.dtype)
    # A centre on an edge is at times a rounding outside; of a triangle seen edge on that can be far.
    edges = [jnp.maximum(turn * e, -outside * jnp.abs(total)) for e in edges]
    total = edges[0] + edges[1] + edges[2]
    sound = hit & (total > 0)
    safe = jnp.where(sound, total, 1.0)
    weights = [jnp.where(sound, e / safe, 1.0 if i == 0 else 0.0) for i, e in enumerate(edges)]

    def mean(values):
        return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]

    ahead = jnp.maximum(mean([c.ahead for c in corners]), NEAREST)
    # Linear on the screen, as it is on a plane.
    sharpness = mean([c.sharpness * jnp.abs(c.ahead) for c in corners]) / ahead
    # The square of a square: the derivative of a fourth power would leave single precision.
    width = jnp.square(1 / jnp.maximum(sharpness, LEAST_SHARPNESS))
    variance = jnp.square(width)
    return Hits(
        hit,
        jnp.where(hit, ahead, 1.0),
        jnp.where(hit, mean([c.offset_x for c in corners]), 0.0),
        jnp.where(hit, mean([c.offset_y for c in corners]), 0.0),
        jnp.where(hit, variance, 1.0),
        jnp.where(hit, mean([c.area for c in corners]), 1.0),
        corners,
    )


def footprint_edges(hits: Hits) -> tuple[Float[Array, "rows columns"], ...]:
    """∂x/∂column, ∂x/∂row, ∂y/∂column and ∂y/∂row [m] of the rest point in the seen triangle, 0 without water."""
    corners = hits.corners
    parts = _edges(corners)
    total = parts[0] + parts[1] + parts[2]
    sound = hits.hit & (total != 0)
    safe = jnp.where(sound, total, 1.0)
    result = []
    for value, at in ((hits.x, "offset_x"), (hits.y, "offset_y")):
        by_column = by_row = jnp.zeros_like(value)
        for i in range(3):
            a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
            sa, sb = (jnp.where(c.ahead > 0, 1.0, -1.0).astype(value.dtype) for c in (a, b))
            moved = (getattr(corners[i], at) - value) / jnp.maximum(jnp.abs(corners[i].ahead), NEAREST)
            by_column = by_column + moved * (a.y * sb - sa * b.y)
            by_row = by_row + moved * (sa * b.x - a.x * sb)
        result += [jnp.where(sound, by_column / safe, 0.0), jnp.where(sound, by_row / safe, 0.0)]
    return tuple(result)
