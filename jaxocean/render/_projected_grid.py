"""A mesh that is even on the screen: its vertices at rest lie where the camera will see them."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._numerics import safe_divide, safe_norm, safe_sqrt
from .._types import Scalar
from ._bounds import Bounds
from ._camera import Camera
from ._planet import wrap

NODES = 1024
"""Angles at which it is measured how dense rows must be."""

FAR = 1e5
"""The last row, in heights of the camera above the lowest water, where the horizon is seen."""

RAMP, LEAST = 0.3, 0.25
"""Outside of the image rows become less dense within so many radians, down to this share."""

SIDEWAYS = 6
"""Steps towards the ends of the rows on a round planet."""

BENT = 0.2
"""Share of the rows that are evenly spaced on a round planet."""

MARGIN = 1.25
"""Rows in the mesh over rows in the image."""

BEYOND = 1.05
"""How far rows may reach on a round planet, over the distance of its horizon: their ends are joined by chords."""


class RestGrid(NamedTuple):
    """Vertices at rest.

    **Arguments:** `offset`: from the point below the camera [m]; `spacing`: the larger distance to the neighbours [m].
    Rows go from near to far.
    """

    offset: Float[Array, "row column 2"]
    spacing: Float[Array, "row column"]


class _View(NamedTuple):
    """The camera without its roll: a field of view, upright, that holds that of the rolled camera."""

    height: Scalar
    pitch: Scalar
    right: Scalar  # tangent of half the angle of view
    up: Scalar
    focal: Scalar


def rest_grid(
    camera: Camera, size: tuple[int, int], spacing: float, bounds: Bounds, curvature: Scalar
) -> RestGrid:
    """The vertices at rest, such that the displaced mesh covers all water that the camera can see.

    Rows are straight lines across the heading, so that an upright camera sees them level, one each `spacing` pixels of
    a plane as far below the camera as it is above the rest plane, or, if that is more, above the lowest crest. Each row
    is as wide as the widest part that a point between `bounds.lowest` and `bounds.highest`, displaced by no more than
    `bounds.displacement`, can come from.
    """
    rows, columns = vertex_counts(size, spacing)
    view = _upright(camera, size)
    distance = _row_distances(view, rows, bounds, curvature)
    half = _half_widths(view, distance, bounds, curvature)
    dtype = distance.dtype
    across = half[:, None] * jnp.linspace(-1.0, 1.0, columns, dtype=dtype)
    along = jnp.broadcast_to(distance[:, None], across.shape)
    ch, sh = jnp.cos(camera.heading), jnp.sin(camera.heading)
    offset = jnp.stack([along * ch + across * sh, along * sh - across * ch], axis=-1)
    ahead = jnp.diff(distance)
    ahead = jnp.maximum(jnp.concatenate([ahead[:1], ahead]), jnp.concatenate([ahead, ahead[-1:]]))
    widest = jnp.maximum(ahead, half * (2 / (columns - 1)))
    return RestGrid(offset, jnp.broadcast_to(widest[:, None], across.shape))


def vertex_counts(size: tuple[int, int], spacing: float) -> tuple[int, int]:
    """Rows and columns of the mesh for an image (rows, columns): one vertex each `spacing` pixels, and margins.

    Rows are a multiple of 16, so that look-ups can be cut into bands.
    """
    return 16 * int(np.ceil(MARGIN * size[0] / spacing / 16 + 0.5)), int(np.ceil(size[1] / spacing)) + 8


def _upright(camera: Camera, size: tuple[int, int]) -> _View:
    up = jnp.tan(0.5 * camera.field_of_view)
    right = up * (size[1] / size[0])
    cos, sin = jnp.abs(jnp.cos(camera.roll)), jnp.abs(jnp.sin(camera.roll))
    return _View(
        camera.position[2],
        camera.pitch,
        right * cos + up * sin,
        right * sin + up * cos,
        camera.focal_length(size),
    )


def _half_widths(
    view: _View, distance: Float[Array, " row"], bounds: Bounds, curvature: Scalar
) -> Float[Array, " row"]:
    """Half the lengths of the rows [m]: of the deepest point that may be seen over a row, to the side."""
    sine, cosine = jnp.sin(view.pitch), jnp.cos(view.pitch)
    bent = curvature > 0
    # On a round planet all that is seen lies within a circle.
    circle = BEYOND * (
        _sight(view.height, bounds.highest, jnp.where(bent, curvature, 1.0)) + bounds.displacement
    )
    most = safe_sqrt((circle - distance) * (circle + distance))
    # The row's ends lie deeper than its middle there, and deeper ends lie further apart: from the widest row that
    # there can be, each step comes closer to the one that is needed.
    half = jnp.where(bent, most, 0.0)
    for _ in range(SIDEWAYS):
        level = jnp.zeros_like(half)
        place, level = wrap(jnp.stack([distance, half], axis=-1), level, curvature)
        away, close = jnp.abs(half) + jnp.abs(distance), jnp.abs(place[:, 1]) + jnp.abs(place[:, 0])
        longer = jnp.where(close > 0, away / jnp.where(close > 0, close, 1.0), 1.0)
        below = view.height - level
        deep = jnp.maximum((below - bounds.lowest) * sine, (below - bounds.highest) * sine)
        ahead = (distance + bounds.displacement) * cosine + deep
        half = view.right * jnp.maximum(ahead, 0.0) * longer + bounds.displacement
        half = jnp.where(bent, jnp.minimum(half, most), half)
    return half


def _row_distances(view: _View, rows: int, bounds: Bounds, curvature: Scalar) -> Float[Array, " row"]:
    """Where along the heading the rows are [m]."""
    nearest, furthest = _reach(view, bounds, curvature)
    dtype = nearest.dtype
    low = jnp.maximum(view.height, 0.0)
    tallest = jnp.maximum(-bounds.lowest, bounds.highest)
    high = jnp.sqrt(low**2 + tallest**2 + 1e-12)
    ends = jnp.arctan2(nearest, high), jnp.arctan2(furthest, high)
    angle = ends[0] + (ends[1] - ends[0]) * jnp.linspace(0.0, 1.0, NODES, dtype=dtype)
    distance = high * jnp.tan(angle)
    needed = jnp.maximum(
        _screen_steps(view, distance, low, curvature), _screen_steps(view, distance, high, curvature)
    )
    # A few rows anywhere, so that distances grow strictly; on a round planet some more, evenly up to its horizon,
    # which would otherwise be cut short by a chord.
    even = jnp.where(curvature > 0, BENT, 0.0).astype(dtype) * jnp.sum(needed) / (furthest - nearest)
    needed = needed + 1e-3 * jnp.mean(needed) + 1e-6 + even * jnp.diff(distance)
    total = jnp.concatenate([jnp.zeros(1, dtype), jnp.cumsum(needed)])
    wanted = total[-1] * jnp.linspace(0.0, 1.0, rows, dtype=dtype)
    found = high * jnp.tan(jnp.interp(wanted, total, angle))
    return found.at[0].set(nearest).at[-1].set(furthest)


def _screen_steps(
    view: _View, distance: Float[Array, " node"], height: Scalar, curvature: Scalar
) -> Float[Array, " step"]:
    """How far apart neighbouring points are on the screen, in focal lengths, seen from the given height."""
    flat = jnp.stack([distance, jnp.zeros_like(distance)], axis=-1)
    place, level = wrap(flat, jnp.zeros_like(distance), curvature)
    below = jnp.arctan2(height - level, place[:, 0]) - view.pitch
    half = jnp.arctan(view.up)
    middle = jnp.abs(0.5 * (below[1:] + below[:-1]))
    stretch = 1 / jnp.cos(jnp.minimum(middle, half)) ** 2
    share = jnp.clip(1 - (middle - half) / RAMP, LEAST, 1.0)
    return jnp.abs(jnp.diff(below)) * stretch * share


def _reach(view: _View, bounds: Bounds, curvature: Scalar) -> tuple[Scalar, Scalar]:
    """The nearest and the furthest rest points along the heading [m] that may be seen."""
    depths = view.height - bounds.highest, view.height - bounds.lowest
    least, most = jnp.zeros_like(view.up), jnp.zeros_like(view.up)
    # If the camera is among the crests, what is seen begins at the camera itself.
    among = (depths[0] <= 0) & (depths[1] >= 0)
    least = jnp.where(among, least, jnp.inf)
    most = jnp.where(among, most, -jnp.inf)
    sky = beyond = jnp.zeros((), bool)
    sine, cosine = jnp.sin(view.pitch), jnp.cos(view.pitch)
    # On a round planet the corners of the image see further than the middles of its edges.
    for up in (view.up, -view.up):
        for right in (jnp.zeros_like(view.right), view.right):
            along, down = cosine + up * sine, sine - up * cosine
            flat = safe_norm(along, right)
            for number, depth in enumerate(depths):
                where, hit = _hit(depth, jnp.arctan2(down, flat), curvature)
                where = where * safe_divide(along, flat)
                least = jnp.minimum(least, jnp.where(hit, where, jnp.inf))
                most = jnp.maximum(most, jnp.where(hit, where, -jnp.inf))
                # A ray that does not meet the lowest water: the horizon is seen, from high above also that behind.
                missed = ~hit if number == 1 else False
                sky, beyond = sky | missed, beyond | (missed & (down > 0) & (along < 0))
    far = _horizon(view.height, depths[1], bounds.highest, curvature)
    furthest = jnp.where(sky, far, jnp.minimum(jnp.where(jnp.isfinite(most), most, far), far))
    nearest = jnp.where(jnp.isfinite(least), least, 0.0)
    nearest = jnp.where(beyond, -far, jnp.minimum(nearest, 0.5 * furthest))
    return nearest - bounds.displacement, furthest + bounds.displacement + 1e-3


def _hit(depth: Scalar, angle: Scalar, curvature: Scalar) -> tuple[Scalar, Bool[Array, ""]]:
    """How far along the ground [m] a ray that points `angle` [rad] below the horizontal meets the sphere that lies
    `depth` [m] below its start; and whether it does."""
    sine, rise = jnp.sin(angle), 1 + curvature * depth
    below = (rise * sine) ** 2 - curvature * depth * (1 + rise)
    hit = (depth * sine > 0) & (below >= 0)
    root = jnp.sign(sine) * safe_sqrt(below)
    length = depth * (1 + rise) / jnp.where(hit, rise * sine + root, 1.0)
    flat = length * jnp.cos(angle)
    left = rise - curvature * length * sine
    turn = jnp.arctan2(curvature * flat, left)
    bent = jnp.abs(turn) > 1e-3
    return jnp.where(bent, turn / jnp.where(bent, curvature, 1.0), flat / jnp.where(bent, 1.0, left)), hit


def _horizon(height: Scalar, depth: Scalar, highest: Scalar, curvature: Scalar) -> Scalar:
    """A distance [m] beyond which nothing is seen, or on a plane, beyond which everything is on the horizon."""
    flat = FAR * jnp.maximum(depth, 1.0)
    bent = curvature > 0
    sight = _sight(height, highest, jnp.where(bent, curvature, 1.0))
    return jnp.where(bent, jnp.minimum(flat, sight), flat)


def _sight(height: Scalar, highest: Scalar, curvature: Scalar) -> Scalar:
    """How far along the ground [m] of a round planet the highest crest can be seen, and a little more."""

    def arc(h: Scalar) -> Scalar:
        return jnp.arctan(jnp.sqrt(curvature * h * (2 + curvature * h))) / curvature

    return arc(jnp.maximum(height, 0.0) + 1.0) + arc(jnp.maximum(highest, 0.0) + 1.0)
