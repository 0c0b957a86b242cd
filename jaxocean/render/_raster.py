"""Which triangle of the displaced mesh each pixel sees: a z-buffer in which every fragment is one scattered minimum."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt

from .._elementary import once
from .._types import Scalar

BLOCK = (4, 6)
"""Rows and columns of the pixels that a quadrilateral is tried on at once."""

CHUNK = 2048
"""Further blocks of large quadrilaterals that are worked off at once."""

OCTAVES = 16
"""Depths are told apart within so many octaves."""

SLACK = 2e4
"""Distance [pixels] from a triangle that still counts as inside, in units of the rounding of 1: neighbours overlap
rather than leave a gap."""

EMPTY = np.uint32(0xFFFFFFFF)


class Screen(NamedTuple):
    """Vertices on the screen.

    **Arguments:** `x`, `y`: column and row [pixels], of the opposite sign for what is behind the camera; `ahead` [m]:
    how far the vertices lie along the direction of view.
    """

    x: Float[Array, "row column"]
    y: Float[Array, "row column"]
    ahead: Float[Array, "row column"]


class _Quads(NamedTuple):
    """Four corners (x, y, sign, 1/|ahead|) of each quadrilateral, and the pixels that it can cover."""

    corners: tuple[tuple[Float[Array, "*q"], ...], ...]
    top: Int[Array, "*q"]
    left: Int[Array, "*q"]
    tall: Int[Array, "*q"]
    wide: Int[Array, "*q"]


def visible_triangles(screen: Screen, size: tuple[int, int], nearest: Scalar) -> UInt[Array, "rows columns"]:
    """The number of the triangle that each pixel's centre sees, or `EMPTY`.

    Triangle 2q of quadrilateral q = row · (columns − 1) + column is (q, below, below right), triangle 2q + 1 is
    (q, below right, right), where below is the next row of the mesh. Quadrilaterals of up to `BLOCK` pixels take one
    step for all; larger ones are cut into more blocks in a loop that is as long as needed: nothing is ever left out.

    **Arguments:** `nearest`: depths [m] are told apart from here on, within 16 octaves; where they are not, near rows
    of the mesh hide far ones, which is right wherever the surface does not fold.
    """
    rows, columns = (side - 1 for side in screen.x.shape)
    quads = _quads(screen, size)
    number = jnp.arange(rows * columns, dtype=jnp.uint32).reshape(rows, columns)
    bits = max(6, int(np.ceil(np.log2(2 * rows * columns + 1))))
    nearest = (1 / nearest).astype(jnp.float32)
    buffer = jnp.full(size[0] * size[1], EMPTY)
    buffer = _scatter(buffer, _fragments(quads, number, nearest, bits, size))

    blocks = -(-quads.tall // BLOCK[0]) * -(-quads.wide // BLOCK[1])
    ends = jnp.cumsum(jnp.maximum(blocks - 1, 0).ravel(), dtype=jnp.int32)
    flat = jax.tree.map(lambda each: each.ravel(), quads)

    def unfinished(state):
        return state[0] < ends[-1]

    def step(state):
        start, buffer = state
        item = start + jnp.arange(CHUNK, dtype=jnp.int32)
        quad = jnp.minimum(jnp.searchsorted(ends, item, side="right").astype(jnp.int32), ends.size - 1)
        some = jax.tree.map(lambda each: each[quad], flat)
        # Block 0 has been done with all the others.
        block = item - jnp.where(quad > 0, ends[quad - 1], 0) + 1
        across = -(-some.wide // BLOCK[1])
        down = block // jnp.maximum(across, 1)
        dy, dx = BLOCK[0] * down, BLOCK[1] * (block - down * across)
        real = item < ends[-1]
        part = _Quads(
            some.corners,
            some.top + dy,
            some.left + dx,
            jnp.where(real, some.tall - dy, 0),
            jnp.where(real, some.wide - dx, 0),
        )
        return start + CHUNK, _scatter(buffer, _fragments(part, quad.astype(jnp.uint32), nearest, bits, size))

    buffer = jax.lax.while_loop(unfinished, step, (jnp.zeros_like(ends[-1]), buffer))[1]
    mask = jnp.uint32((1 << bits) - 1)
    return jnp.where(buffer == EMPTY, EMPTY, buffer & mask).reshape(size)


def _quads(screen: Screen, size: tuple[int, int]) -> _Quads:
    ahead = screen.ahead
    apart = jnp.maximum(jnp.abs(ahead), 1e-12)
    sign = jnp.where(ahead > 0, 1.0, -1.0).astype(ahead.dtype)
    table = (screen.x, screen.y, sign, 1 / apart)
    sides = (slice(None, -1), slice(1, None))
    # Around the quadrilateral: itself, below, below right, right.
    corners = tuple(
        tuple(values[sides[down], sides[along]] for values in table)
        for down, along in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    low_x, high_x, low_y, high_y = _extent(corners)

    slack = _slack(low_x.dtype)

    def pixels(low, high, count):
        """Pixels whose centres lie between."""
        first = jnp.ceil(jnp.clip(low - 0.5 - slack, -1, count)).astype(jnp.int32)
        final = jnp.floor(jnp.clip(high - 0.5 + slack, -1, count)).astype(jnp.int32)
        first = jnp.maximum(first, 0)
        return first, jnp.maximum(jnp.minimum(final, count - 1) - first + 1, 0)

    top, tall = pixels(low_y, high_y, size[0])
    left, wide = pixels(low_x, high_x, size[1])
    empty = (tall == 0) | (wide == 0)
    return _Quads(corners, top, left, jnp.where(empty, 0, tall), jnp.where(empty, 0, wide))


def _extent(corners):
    """Where the parts in front of the camera lie on the screen; infinite where they pass beside the pinhole."""
    low_x = low_y = jnp.full_like(corners[0][0], jnp.inf)
    high_x = high_y = jnp.full_like(corners[0][0], -jnp.inf)
    for number, (x, y, sign, _) in enumerate(corners):
        front = sign > 0
        low_x, high_x = _widened(low_x, high_x, x, front)
        low_y, high_y = _widened(low_y, high_y, y, front)
        # An edge to what is behind goes to infinity where it passes the pinhole: there ahead = 0, and what remains of
        # the weighted sum of both ends is x + x1, with the sign that `Screen` gives to what is behind.
        x1, y1, sign1, _ = corners[(number + 1) % 4]
        crossing = sign * sign1 < 0
        toward_x, toward_y = x + x1, y + y1
        low_x = jnp.where(crossing & (toward_x < 0), -jnp.inf, low_x)
        high_x = jnp.where(crossing & (toward_x > 0), jnp.inf, high_x)
        low_y = jnp.where(crossing & (toward_y < 0), -jnp.inf, low_y)
        high_y = jnp.where(crossing & (toward_y > 0), jnp.inf, high_y)
    return low_x, high_x, low_y, high_y


def _widened(low, high, value, real):
    return jnp.minimum(low, jnp.where(real, value, jnp.inf)), jnp.maximum(
        high, jnp.where(real, value, -jnp.inf)
    )


def _fragments(
    quads: _Quads, number: UInt[Array, "*q"], nearest: Float[Array, ""], bits: int, size: tuple[int, int]
) -> tuple[Int[Array, "fragment"], UInt[Array, "fragment"]]:
    """Pixel and key of the nearer triangle at all pixels of one block of each quadrilateral."""
    ones = (1,) * number.ndim
    dy, dx = (jnp.arange(side, dtype=jnp.int32) for side in BLOCK)
    dy, dx = dy.reshape(-1, 1, *ones), dx.reshape(1, -1, *ones)
    dtype = quads.corners[0][0].dtype
    # Around the block's first pixel, lest digits cancel.
    base_x, base_y = quads.left.astype(dtype) + 0.5, quads.top.astype(dtype) + 0.5
    local = [(x - base_x * sign, y - base_y * sign, sign, inverse) for x, y, sign, inverse in quads.corners]
    px, py = dx.astype(dtype), dy.astype(dtype)
    first = _inverse_depth(_planes((local[0], local[1], local[2])), px, py)
    second = _inverse_depth(_planes((local[0], local[2], local[3])), px, py)
    # The nearer of both; its sign says which one, so that pixels and keys share one array.
    nearer = once(jnp.where(second > first, -second, first))
    closeness = jnp.abs(nearer)
    here = (closeness > 0) & (dy < quads.tall) & (dx < quads.wide)
    pixel = jnp.where(here, (quads.top + dy) * size[1] + quads.left + dx, size[0] * size[1])
    # Octaves beyond the nearest depth, as the bits of a floating-point number tell them.
    near, far = (jax.lax.bitcast_convert_type(c, jnp.int32) for c in (nearest, closeness.astype(jnp.float32)))
    steps = jnp.clip(near - far, 0, (OCTAVES << 23) - 1).astype(jnp.uint32)
    depth = steps >> jnp.uint32(bits - 5)
    triangle = 2 * number + (nearer < 0).astype(jnp.uint32)
    return pixel.ravel(), ((depth << jnp.uint32(bits)) | triangle).ravel()


def _planes(corners) -> list[tuple[Float[Array, "*q"], ...]]:
    """Linear functions (a, b, c) of the pixel: three that are not negative in a triangle, and 1/ahead."""
    (x0, y0, s0, i0), (x1, y1, s1, i1), (x2, y2, s2, i2) = corners
    parts = []
    for (xa, ya, sa), (xb, yb, sb) in (
        ((x1, y1, s1), (x2, y2, s2)),
        ((x2, y2, s2), (x0, y0, s0)),
        ((x0, y0, s0), (x1, y1, s1)),
    ):
        # The edge's line through (x, y, 1), zero on the edge.
        parts.append((ya * sb - sa * yb, sa * xb - xa * sb, xa * yb - ya * xb))
    area = x0 * parts[0][0] + y0 * parts[0][1] + s0 * parts[0][2]
    turn = jnp.where(area >= 0, 1.0, -1.0).astype(area.dtype)
    flat = area == 0
    slack = _slack(area.dtype)
    edges, plane = [], [jnp.zeros_like(area)] * 3
    for part, inverse in zip(parts, (i0, i1, i2), strict=True):
        a, b, c = (turn * each for each in part)
        plane = [p + each * inverse for p, each in zip(plane, (a, b, c), strict=True)]
        wider = jnp.where(flat, -jnp.inf, c + slack * (jnp.abs(a) + jnp.abs(b)))
        edges.append((once(a), once(b), once(wider)))
    scale = 1 / jnp.where(flat, 1.0, jnp.abs(area))
    return [*edges, tuple(once(each * scale) for each in plane)]


def _inverse_depth(planes, px, py):
    """1/ahead where a pixel's centre lies in the triangle, else 0."""
    *edges, depth = (a * px + b * py + c for a, b, c in planes)
    inside = jnp.minimum(jnp.minimum(edges[0], edges[1]), edges[2]) >= 0
    return jnp.where(inside & (depth > 0), depth, 0.0)


def _slack(dtype: jnp.dtype) -> float:
    return SLACK * float(jnp.finfo(dtype).eps)


def _scatter(buffer, fragments):
    pixel, key = fragments
    return buffer.at[pixel].min(key, mode="drop")
