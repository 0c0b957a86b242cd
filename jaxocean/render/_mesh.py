"""The displaced mesh: what of the patterns its vertices can carry, in the world and on the screen."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._elementary import once
from .._types import Scalar
from ..surface import Cascade, Fields
from ._atlas import Atlas
from ._bands import band_count, cut, join
from ._camera import Camera
from ._footprint import LEAST_SHARPNESS, filter_variance
from ._planet import wrap
from ._projected_grid import RestGrid
from ._raster import Screen
from ._shading_rate import Rate

EDGE_ON = 0.02
"""Sine of the angle under which a surface counts as seen edge on."""

OUT_OF_SIGHT = 1e6
"""Distance [pixels] from the image beyond which vertices are taken to lie there."""

WIDEST = 1e9
"""Largest edge [m] of a footprint: its fourth power is a number in single precision."""


class Mesh(eqx.Module):
    """Vertices in rows from near to far.

    **Arguments:** `offset`: at rest, from the point below the camera [m]; `place`: displaced, from the same point at
    height 0 [m]; `screen`: in the image; `sharpness`: v^(−1/4) [m^(−1/2)] of the variance v of the filter that stands
    for the footprint of a pixel (or group) there. On a plane v grows as the fourth power of the depth, so that its
    sharpness is linear on the screen. `area`: of the mesh seen from above over its area at rest [-].
    """

    offset: Float[Array, "row column 2"]
    place: Float[Array, "row column 3"]
    screen: Screen
    sharpness: Float[Array, "row column"]
    area: Float[Array, "row column"]


def displacement_atlas(fields: Fields, cascade: Cascade) -> Atlas:
    """Displacement (u, v) and height of all patterns, for look-ups."""
    moved = fields.displacement
    return Atlas.from_channels(jnp.stack([moved[..., 0], moved[..., 1], fields.height]), cascade.sizes)


def displaced_mesh(
    grid: RestGrid,
    atlas: Atlas,
    camera: Camera,
    size: tuple[int, int],
    curvature: Scalar,
    rate: Rate = (1, 1),
) -> Mesh:
    """The grid moved by the patterns, each of them filtered as wide as the vertices are apart.

    A box as wide as their distance d has the variance d²/12. Waves that this removes are left to the shading, which
    sees them as slopes: drawn with too few vertices they would flicker. Footprints are those of groups of `rate`
    pixels.
    """
    centre = camera.position[:2]
    bands = band_count((grid.offset.shape[0], grid.offset.shape[1]))
    points = (grid.offset[..., 0], grid.offset[..., 1], grid.spacing**2 / 12)
    x, y, variance = (cut(each, bands) for each in points)
    u, v, height = jax.tree.map(join, jax.lax.map(lambda band: atlas(centre, *band), (x, y, variance)))
    offset = tuple(once(grid.offset[..., i]) for i in (0, 1))
    moved = once(offset[0] + u), once(offset[1] + v)
    flat, level = wrap(jnp.stack(moved, axis=-1), height, curvature)
    place = tuple(once(each) for each in (flat[..., 0], flat[..., 1], level))
    screen = Screen(*map(once, _on_screen(place, camera, size)))
    area = _area(moved) / _area(offset)
    stacked = jnp.stack(offset, axis=-1), jnp.stack(place, axis=-1)
    return Mesh(*stacked, screen, _sharpness(offset, screen, rate), area)


def _area(points: tuple[Float[Array, "row column"], ...]) -> Float[Array, "row column"]:
    """Signed areas of the parallelograms between the differences to neighbouring vertices."""
    (ux, uy), (vx, vy) = _along(points[0]), _along(points[1])
    return ux * vy - uy * vx


def _sharpness(
    offset: tuple[Float[Array, "row column"], ...], screen: Screen, rate: Rate = (1, 1)
) -> Float[Array, "row column"]:
    """From the differences of neighbouring vertices at rest and on the screen.

    Taken at the vertices and not in each triangle, it is continuous: an image without jumps has the derivative of its
    finite differences.
    """
    (ux, uy), (vx, vy) = _along(offset[0]), _along(offset[1])
    # Vertices that nobody sees, beside the pinhole or beyond the horizon, must have finite derivatives too: going back,
    # even nothing times infinity is no number.
    (xx, xy), (yx, yy) = (
        _along(jnp.clip(each, -OUT_OF_SIGHT, OUT_OF_SIGHT)) for each in (screen.x, screen.y)
    )
    extent = xx * xx + xy * xy + yx * yx + yy * yy + 1e-10
    share = (xx * yy - xy * yx) / extent
    # Where the surface is seen edge on, a pixel's footprint has no bound.
    inverse = share / (share * share + EDGE_ON**2) / extent
    down, across = (side * inverse for side in rate)
    axes = tuple(
        jnp.clip(axis, -WIDEST, WIDEST)
        for axis in (
            (ux * yy - uy * yx) * across,
            (uy * xx - ux * xy) * down,
            (vx * yy - vy * yx) * across,
            (vy * xx - vx * xy) * down,
        )
    )
    widest = LEAST_SHARPNESS**-4
    variance = jnp.clip(filter_variance(axes), 1e-12, widest)
    return jnp.sqrt(jnp.sqrt(1 / variance))


def _along(
    values: Float[Array, "row column"],
) -> tuple[Float[Array, "row column"], Float[Array, "row column"]]:
    """Differences from row to row and from column to column: of both neighbours, at the borders of one."""

    result = []
    for axis in (0, 1):
        first, after, before, final = (
            jax.lax.slice_in_dim(values, i, i + 1, axis=axis)
            for i in (0, 1, values.shape[axis] - 2, values.shape[axis] - 1)
        )
        wider = jnp.concatenate([2 * first - after, values, 2 * final - before], axis=axis)
        both = (jax.lax.slice_in_dim(wider, i, i + values.shape[axis], axis=axis) for i in (2, 0))
        result.append(once(0.5 * (next(both) - next(both))))
    return result[0], result[1]


def _on_screen(
    place: tuple[Float[Array, "row column"], ...], camera: Camera, size: tuple[int, int]
) -> Screen:
    right, up, forward = camera.axes()
    x, y, z = place[0], place[1], place[2] - camera.position[2]

    def along(axis: Float[Array, "3"]) -> Float[Array, "row column"]:
        return x * axis[0] + y * axis[1] + z * axis[2]

    ahead = along(forward)
    apart = jnp.maximum(jnp.abs(ahead), 1e-12)
    scale = camera.focal_length(size) / apart
    sign = jnp.where(ahead > 0, 1.0, -1.0).astype(ahead.dtype)
    column = 0.5 * size[1] * sign + along(right) * scale
    row = 0.5 * size[0] * sign - along(up) * scale
    return Screen(column, row, ahead)
