"""Which edges of the mesh pass between neighbouring pixels as silhouettes, and where."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt

from .._elementary import once
from ._edges import Edges
from ._raster import EMPTY, Screen

CHUNK = 4096
"""Places where silhouettes may pass that are worked off at once."""

IN_FRONT = 1.25
"""How much nearer than the nearer pixel's centre a silhouette of its surface may be."""


class _Lines(NamedTuple):
    """Edges of the mesh from a to b: numbers of their vertices, and whether they are silhouettes."""

    a: Int[Array, " edge"]
    b: Int[Array, " edge"]
    ends: Bool[Array, " edge"]


class _Side(NamedTuple):
    """The steep edges, or the flat ones with both axes exchanged: `along` the lines of pixels that they cross.

    **Arguments:** `across`, `along`: of all vertices [pixels]; `size`: of the image, lines first; `first`: line that
    each edge crosses first; `crossed`: how many lines, up to the number of the edge.
    """

    across: Float[Array, " vertex"]
    along: Float[Array, " vertex"]
    size: tuple[int, int]
    first: Int[Array, " edge"]
    crossed: Int[Array, " edge"]


def find_silhouettes(screen: Screen, ahead: Float[Array, "rows columns"]) -> Edges:
    """The silhouettes that pass between the centres of neighbouring pixels.

    An edge is one if the surface turns away behind it or ends there, and is seen if it is nearer than the farther of
    two neighbouring pixels and belongs to the nearer one. Of several the nearest counts. Which edge it is carries no
    derivative, where it passes does. What is thinner than a pixel has no silhouette.

    **Arguments:** `screen`: the mesh; `ahead` [m]: depth at each pixel's centre, infinite where no water is seen.

    **Returns:** `Edges`.
    """
    lines = _lines(screen)
    held = jax.lax.stop_gradient(screen)
    closeness = jax.lax.stop_gradient(1 / ahead)
    x, y = screen.x.ravel(), screen.y.ravel()
    rows, columns = ahead.shape
    steep = _side(held.x, held.y, (rows, columns), lines, steeper=False)
    flat = _side(held.y, held.x, (columns, rows), lines, steeper=True)
    across = _nearest(steep, lines, held.ahead, closeness)
    down = _nearest(flat, lines, held.ahead, closeness.T)
    # Once, or each channel of the image would look for them again.
    return Edges(once(_place(across, lines, x, y)), once(_place(down, lines, y, x).T))


def _lines(screen: Screen) -> _Lines:
    """All edges of the mesh: those along its rows, those across them, and the diagonals."""
    lower, upper = _facing(screen)
    rows, columns = screen.x.shape
    vertex = jnp.arange(rows * columns, dtype=jnp.int32).reshape(rows, columns)
    row_end, column_end = jnp.ones((1, columns - 1), bool), jnp.ones((rows - 1, 1), bool)
    along = jnp.concatenate([row_end, lower[:-1] != upper[1:], row_end])
    across = jnp.concatenate([column_end, upper[:, :-1] != lower[:, 1:], column_end], axis=1)
    parts = (
        (vertex[:, :-1], vertex[:, 1:], along),
        (vertex[:-1], vertex[1:], across),
        (vertex[:-1, :-1], vertex[1:, 1:], lower != upper),
    )
    a, b, ends = (jnp.concatenate([part[i].ravel() for part in parts]) for i in range(3))
    front = screen.ahead.ravel() > 0
    return _Lines(a, b, ends & front[a] & front[b])


def _side(x, y, size: tuple[int, int], lines: _Lines, *, steeper: bool) -> _Side:
    x, y = x.ravel(), y.ravel()
    ax, ay, bx, by = x[lines.a], y[lines.a], x[lines.b], y[lines.b]
    # Each edge counts on one side only, or its area would count twice.
    mine = (jnp.abs(by - ay) > jnp.abs(bx - ax)) if steeper else (jnp.abs(by - ay) >= jnp.abs(bx - ax))

    def line(value):
        return jnp.clip(jnp.ceil(value - 0.5), 0, size[0]).astype(jnp.int32)

    first, end = line(jnp.minimum(ay, by)), line(jnp.maximum(ay, by))
    crossed = jnp.where(mine & lines.ends, end - first, 0)
    return _Side(x, y, size, first, jnp.cumsum(crossed, dtype=jnp.int32))


def _nearest(
    side: _Side, lines: _Lines, ahead: Float[Array, "row column"], closeness: Float[Array, "line place"]
) -> UInt[Array, "line place_less_one"]:
    """The number of the edge that is seen between the pixels of each line, or `EMPTY`."""
    size, crossed = side.size, side.crossed
    bits = int(np.ceil(np.log2(lines.a.size + 1)))
    inverse = 1 / ahead.ravel()
    closest = jax.lax.bitcast_convert_type(jnp.float32(np.inf), jnp.int32)

    def unfinished(state):
        return state[0] < crossed[-1]

    def step(state):
        start, buffer = state
        item = start + jnp.arange(CHUNK, dtype=jnp.int32)
        edge = jnp.minimum(jnp.searchsorted(crossed, item, side="right"), lines.a.size - 1).astype(jnp.int32)
        line = side.first[edge] + item - jnp.where(edge > 0, crossed[edge - 1], 0)
        a, b = lines.a[edge], lines.b[edge]
        share = _share(side.along[a], side.along[b], line)
        where = side.across[a] + share * (side.across[b] - side.across[a])
        here = inverse[a] + share * (inverse[b] - inverse[a])
        place = jnp.floor(jnp.clip(where - 0.5, -1, size[1])).astype(jnp.int32)
        inside = (item < crossed[-1]) & (place >= 0) & (place < size[1] - 1)
        pixel = jnp.where(inside, line * size[1] + place, 0)
        flat = closeness.ravel()
        one, two = flat[pixel], flat[pixel + 1]
        seen = inside & (here > jnp.minimum(one, two)) & (here <= IN_FRONT * jnp.maximum(one, two))
        depth = closest - jax.lax.bitcast_convert_type(here.astype(jnp.float32), jnp.int32)
        key = ((depth.astype(jnp.uint32) >> jnp.uint32(bits)) << jnp.uint32(bits)) | edge.astype(jnp.uint32)
        pair = jnp.where(seen, line * (size[1] - 1) + place, buffer.size)
        return start + CHUNK, buffer.at[pair].min(key, mode="drop")

    buffer = jnp.full(size[0] * (size[1] - 1), EMPTY)
    buffer = jax.lax.while_loop(unfinished, step, (jnp.zeros_like(crossed[-1]), buffer))[1]
    edge = jnp.where(buffer == EMPTY, EMPTY, buffer & jnp.uint32((1 << bits) - 1))
    return edge.reshape(size[0], size[1] - 1)


def _place(
    edge: UInt[Array, "line place"], lines: _Lines, across: Float[Array, " v"], along: Float[Array, " v"]
) -> Float[Array, "line place"]:
    """Where the edges pass, from the border between the two pixels."""
    there = edge != EMPTY
    number = jnp.where(there, edge, jnp.uint32(0)).astype(jnp.int32)
    a, b = (ends.at[number].get(mode="promise_in_bounds") for ends in (lines.a, lines.b))

    def corner(values, vertex):
        return values.at[vertex].get(mode="promise_in_bounds")

    line = jnp.arange(edge.shape[0], dtype=jnp.int32)[:, None]
    low, high = jnp.where(there, corner(along, a), 0.0), jnp.where(there, corner(along, b), 1.0)
    left, right = corner(across, a), corner(across, b)
    where = left + _share(low, high, line) * (right - left)
    border = 1 + jnp.arange(edge.shape[1], dtype=across.dtype)
    return jnp.where(there, jnp.clip(where - border, -0.5, 0.5), 0.0)


def _share(low, high, line):
    """How far along an edge it crosses the middle of a line of pixels."""
    apart = high - low
    return (line.astype(low.dtype) + 0.5 - low) / jnp.where(apart == 0, 1.0, apart)


def _facing(screen: Screen) -> tuple[Bool[Array, "row column"], Bool[Array, "row column"]]:
    """Which way round the two triangles of each quadrilateral appear."""

    def turn(a, b, c):
        (xa, ya, sa), (xb, yb, sb), (xc, yc, sc) = a, b, c
        return xa * (yb * sc - sb * yc) + ya * (sb * xc - xb * sc) + sa * (xb * yc - yb * xc) > 0

    sign = jnp.where(screen.ahead > 0, 1.0, -1.0).astype(screen.x.dtype)
    table = (screen.x, screen.y, sign)
    sides = (slice(None, -1), slice(1, None))
    here, below, across, right = (
        tuple(values[sides[down], sides[along]] for values in table)
        for down, along in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    return turn(here, below, across), turn(here, across, right)
