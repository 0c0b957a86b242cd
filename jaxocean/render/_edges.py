"""Where silhouettes pass between neighbouring pixels: crest edges without stairs, and with a gradient."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt

from ._hits import Hits
from ._mesh import Mesh
from ._raster import EMPTY, Screen


class Edges(eqx.Module):
    """Silhouettes between the centres of neighbouring pixels.

    A number c from −½ to ½ says where: at the common border of the two pixels 0, at the centre of the left or upper
    one −½. The pixel on the side of which it passes gets the share |c| of the other's colour. 0 also stands for no
    silhouette.

    **Arguments:** `across`: between left and right neighbours; `down`: between upper and lower ones.
    """

    across: Float[Array, "rows columns_less_one"]
    down: Float[Array, "rows_less_one columns"]

    def blend(self, image: Float[Array, "rows columns *c"]) -> Float[Array, "rows columns *c"]:
        """The image with each silhouette's pixel mixed by the area on both of its sides."""
        extra = (1,) * (image.ndim - 2)
        left, right = image[:, :-1], image[:, 1:]
        across = self.across.reshape(self.across.shape + extra)
        change = right - left
        result = image.at[:, 1:].add(-jnp.maximum(across, 0) * change)
        result = result.at[:, :-1].add(jnp.maximum(-across, 0) * change)
        down = self.down.reshape(self.down.shape + extra)
        change = image[1:] - image[:-1]
        result = result.at[1:].add(-jnp.maximum(down, 0) * change)
        return result.at[:-1].add(jnp.maximum(-down, 0) * change)


class Exits(NamedTuple):
    """How far [pixels] from each centre the seen triangle ends in a silhouette, or infinity beyond 1.

    **Arguments:** `right`, `left`, `below`, `above`: in the four directions; `near`: depth, infinite without water.
    """

    right: Float[Array, "rows columns"]
    left: Float[Array, "rows columns"]
    below: Float[Array, "rows columns"]
    above: Float[Array, "rows columns"]
    near: Float[Array, "rows columns"]


def find_exits(
    mesh: Mesh, triangle: UInt[Array, "rows columns"], hits: Hits, rows: Float[Array, " rows"]
) -> Exits:
    """Silhouettes around the quadrilaterals whose triangles some rows of pixels see."""
    outline = _outline(mesh, triangle, hits, rows)
    near = jnp.where(hits.hit, hits.ahead, jnp.inf)

    def search() -> tuple[Float[Array, "rows columns"], ...]:
        flipped = [edge._replace(a=edge.a[::-1], b=edge.b[::-1]) for edge in outline]
        return tuple(_exit(edges, way) for edges in (outline, flipped) for way in (1.0, -1.0))

    def none() -> tuple[Float[Array, "rows columns"], ...]:
        return (jnp.full_like(near, jnp.inf),) * 4

    found = jnp.any(jnp.stack([jnp.any(edge.silhouette) for edge in outline]))
    right, left, below, above = jax.lax.cond(found, search, none)
    return Exits(right, left, below, above, near)


def silhouettes(exits: Exits) -> Edges:
    """The silhouettes that pass between the centres of neighbouring pixels.

    Of two neighbours the one that is nearer owns the silhouette. Its position follows from the two vertices of the
    edge, and so does its derivative. What is thinner than a pixel has no silhouette.
    """
    right, left, below, above, near = exits
    return Edges(
        _between(near[:, :-1], near[:, 1:], right[:, :-1], left[:, 1:]),
        _between(near[:-1], near[1:], below[:-1], above[1:]),
    )


def _between(first, second, forward, backward):
    """Of two neighbours' silhouettes the nearer one's, from the middle between them."""
    own = first < second
    distance = jnp.where(own, forward, backward)
    there = jnp.isfinite(distance) & (first != second)
    safe = jnp.where(there, distance, 0.5)
    return jnp.where(there, jnp.where(own, safe - 0.5, 0.5 - safe), 0.0)


class _Edge(NamedTuple):
    """An edge from a to b, (x, y) around the pixel's centre; whether it bounds what the pixel sees, and whether the
    surface turns away, or ends, behind it."""

    a: tuple[Float[Array, "rows columns"], Float[Array, "rows columns"]]
    b: tuple[Float[Array, "rows columns"], Float[Array, "rows columns"]]
    bounds: Bool[Array, "rows columns"]
    silhouette: Bool[Array, "rows columns"]


def _exit(edges: list[_Edge], direction: float) -> Float[Array, "rows columns"]:
    """How far [pixels] from the centre along x the seen face ends in a silhouette, up to 1; else infinity."""
    nearest = jnp.full_like(edges[0].a[0], jnp.inf)
    silhouette = jnp.zeros(nearest.shape, bool)
    for (ax, ay), (bx, by), bounds, ends in edges:
        crossing = bounds & ((ay > 0) != (by > 0))
        # Each edge counts in one direction only, the one across it, or its area would count twice.
        across = jnp.abs(by - ay) >= jnp.abs(bx - ax)
        where = direction * (ax * by - bx * ay) / jnp.where(crossing, by - ay, 1.0)
        # The centre may be a rounding outside of its own triangle.
        first = crossing & (where > -1e-2) & (where < nearest)
        nearest = jnp.where(first, jnp.maximum(where, 0.0), nearest)
        silhouette = jnp.where(first, ends & across, silhouette)
    return jnp.where(silhouette & (nearest <= 1), nearest, jnp.inf)


def _outline(
    mesh: Mesh, triangle: UInt[Array, "rows columns"], hits: Hits, rows: Float[Array, " rows"]
) -> list[_Edge]:
    """The edges of the two triangles of a quadrilateral that may bound what a pixel sees of it.

    Where both face the same way, the diagonal between them bounds nothing; else it is itself a silhouette.
    """
    screen = mesh.screen
    facing = _facing(screen)
    count_rows, count = facing[0].shape
    flat = jnp.stack([each.ravel() for each in facing], axis=-1).ravel()  # by number of the triangle
    seen = jnp.where(triangle != EMPTY, triangle, jnp.uint32(0)).astype(jnp.int32)
    quad, second = seen // 2, seen % 2 == 1
    row = quad // count
    column = quad - row * count
    mine = flat[seen]

    def turned(there: Bool[Array, "rows columns"], other: Int[Array, "rows columns"]):
        beside = flat.at[jnp.where(there, other, 0)].get(mode="promise_in_bounds")
        return hits.hit & (~there | (beside != mine))

    first = quad + row
    fourth = jnp.where(second, first + count + 1, first + 1)
    x, y, ahead = (values.ravel().at[fourth].get(mode="promise_in_bounds") for values in screen)
    dtype = x.dtype
    px, py = jnp.arange(triangle.shape[1], dtype=dtype) + 0.5, (rows + 0.5)[:, None]
    other = (x - px, y - py)
    here, one, two = ((c.x, c.y) for c in hits.corners)

    def either(if_second, if_first):
        return jnp.where(second, if_second[0], if_first[0]), jnp.where(second, if_second[1], if_first[1])

    below, across, right = either(other, one), either(one, two), either(two, other)
    front = (ahead > 0) & hits.hit
    for corner in hits.corners:
        front = front & (corner.ahead > 0)
    even = flat.at[jnp.where(second, seen - 1, seen + 1)].get(mode="promise_in_bounds") == mine
    lower, upper = front & (even | ~second), front & (even | second)
    return [
        _Edge(here, below, lower, turned(column > 0, 2 * quad - 1)),
        _Edge(below, across, lower, turned(row < count_rows - 1, 2 * (quad + count) + 1)),
        _Edge(across, right, upper, turned(column < count - 1, 2 * (quad + 1))),
        _Edge(right, here, upper, turned(row > 0, 2 * (quad - count))),
        _Edge(here, across, front & ~even, front & ~even),
    ]


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
