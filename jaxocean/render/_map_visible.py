"""All that a camera sees of a sea, pixel by pixel, in bands of rows."""

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._elementary import once
from .._numerics import as_leaf
from .._types import ScalarLike
from ..surface import Cascade, Fields
from ..surface.fft._apart import compute_apart
from ._bands import band_count, cut, join
from ._bounds import Bounds
from ._camera import Camera, check_size
from ._edges import Edges
from ._footprint import Seen, SurfaceMoments, displaced
from ._hits import OUTSIDE, footprint_edges, meet
from ._mesh import displaced_mesh, displacement_atlas
from ._projected_grid import rest_grid
from ._raster import EMPTY, visible_triangles
from ._rays import Rays, RayScene, average, ray_bands
from ._shading_rate import interpolate, seen_by_groups
from ._silhouettes import find_silhouettes
from ._visible import Pixels, Visible

T = TypeVar("T")


class Raster(eqx.Module):
    """A projected mesh, drawn with a z-buffer.

    **Arguments:** `spacing`: pixels from one vertex to the next, 4 by default; fewer give sharper crests, for a cost in
    inverse proportion to its square; `filtered`: whether slopes and strain are taken over each pixel's footprint, or
    (to see what that is good for) at its centre alone; `shading_rate`: rows and columns of pixels that share one shaded
    point, (1, 1) by default. The water's light, whitecaps included, is then that of the whole group, and linear in
    between; silhouettes and the sky remain those of every pixel. `moving_silhouettes`: whether derivatives hold what
    changes because crests and the horizon move across pixels; pictures are the same without.

    **Raises:** `ValueError` for a spacing outside 0.5 to 64 pixels, or a rate outside 1 to 4.
    """

    spacing: float = eqx.field(static=True, default=4.0)
    filtered: bool = eqx.field(static=True, default=True)
    shading_rate: tuple[int, int] = eqx.field(static=True, default=(1, 1))
    moving_silhouettes: bool = eqx.field(static=True, default=True)

    def __check_init__(self) -> None:
        if not 0.5 <= self.spacing <= 64:
            raise ValueError(f"Argument `spacing` must be 0.5 to 64 pixels, but is {self.spacing}.")
        rate = self.shading_rate
        if len(rate) != 2 or not all(isinstance(side, int) and 1 <= side <= 4 for side in rate):
            raise ValueError(
                f"Argument `shading_rate` must be (rows, columns) with 1 to 4 whole pixels each, but is {rate!r}."
            )


def visible_points(
    fields: Fields,
    cascade: Cascade,
    camera: Camera,
    size: tuple[int, int],
    *,
    method: Raster | Rays | None = None,
    curvature: ScalarLike = 0.0,
) -> tuple[Visible, Edges]:
    """What a camera sees of a sea at one time, for all pixels.

    **Arguments:** those of `map_visible`.

    **Returns:** `Visible` and the silhouettes.

    **Raises:** `ValueError` for a size that makes no sense, or several rays a pixel, which have no mean place.
    """
    check_size(size)
    if isinstance(method, Rays) and method.sides != (1, 1):
        raise ValueError(f"Argument `samples` of the rays must be 1 here, but is {method.samples}.")
    return _visible_points(fields, cascade, camera, size, method, as_leaf(curvature))


@eqx.filter_jit
def _visible_points(fields, cascade, camera, size, method, curvature) -> tuple[Visible, Edges]:
    def arrays(visible: Visible):
        return (
            visible.hit,
            visible.depth,
            visible.place,
            visible.edges_of_footprint,
            visible.variance,
            visible.area,
            visible.seen,
        )

    found, edges = map_visible(arrays, fields, cascade, camera, size, method=method, curvature=curvature)
    dtype = fields.packed.real.dtype
    rows = jnp.arange(size[0], dtype=dtype)
    return Visible(camera.astype(dtype), size, rows, curvature.astype(dtype), *found), edges


def map_visible(
    shade: Callable[[Visible], T],
    fields: Fields,
    cascade: Cascade,
    camera: Camera,
    size: tuple[int, int],
    *,
    method: Raster | Rays | None = None,
    curvature: ScalarLike = 0.0,
) -> tuple[T, Edges]:
    """The image of what `shade` makes of what the pixels see, in bands of rows, so that memory stays small.

    Differentiable in the fields, and so in the wind, the choppiness and the time, and in the camera. Which triangle a
    pixel sees carries no derivative; silhouettes do, once `Edges.blend` has mixed the image along them. With the image
    of `Visible.hit` it gives the share of each pixel that water covers.

    **Arguments:**

    - `shade`: from a band of `Visible` to arrays (rows, columns, …). Compile the whole: it is traced at every call.
    - `fields`: of a sea at one time (`Sea.fields`, `Ocean.fields`) on the patterns of `cascade`.
    - `camera`: see `check_above` for one that may be under water.
    - `size`: (rows, columns) of the image.
    - `method`: how the water that a pixel sees is found, `Raster()` or `Rays()`; `Raster()` if None. Whatever its
      shading rate, `shade` is asked for every pixel.
    - `curvature`: of the planet [1/m], 0 for a plane; see `EARTH_CURVATURE`.

    **Returns:** the arrays of the whole image, and the silhouettes: with `Rays` none, and with several of them in each
    pixel the means over its rays.

    **Raises:** `ValueError` for a size that makes no sense.
    """
    if isinstance(method, Raster):
        method = replace(method, shading_rate=(1, 1))
    return map_image(shade, None, fields, cascade, camera, size, method=method, curvature=curvature)


def map_image(
    shade: Callable[[Visible], T],
    beyond: Callable[[Pixels], T] | None,
    fields: Fields,
    cascade: Cascade,
    camera: Camera,
    size: tuple[int, int],
    *,
    method: Raster | Rays | None = None,
    curvature: ScalarLike = 0.0,
) -> tuple[T, Edges]:
    """`map_visible` at the method's shading rate, with a function of its own for pixels that see no water.

    **Arguments:** those of `map_visible`; `beyond`: what pixels without water are, as `shade` says for those with it,
    or None to leave all of them to `shade`, which is then asked for every pixel.
    """
    check_size(size)
    method = method or Raster()
    dtype = fields.packed.real.dtype
    camera, curvature = camera.astype(dtype), as_leaf(curvature).astype(dtype)
    if isinstance(method, Rays):
        return _map_rays(shade, beyond, fields, cascade, camera, size, method, curvature)
    rate = method.shading_rate
    bounds = Bounds.of_fields(fields)
    grid = rest_grid(camera, size, method.spacing, bounds, curvature)
    mesh = displaced_mesh(grid, displacement_atlas(fields, cascade), camera, size, curvature, rate)
    nearest = jnp.maximum(camera.position[2] - bounds.lowest, 1e-3) / 256
    triangle = visible_triangles(jax.lax.stop_gradient(mesh.screen), size, jax.lax.stop_gradient(nearest))
    moments = SurfaceMoments.from_fields(fields, cascade)
    rows, columns = (jnp.arange(side, dtype=dtype) for side in size)

    def shaded(band):
        """Of pixels, or of those that stand for groups."""
        triangle, rows = band
        visible, ahead = _visible(
            mesh, moments, camera, size, curvature, method, triangle, rows, columns[:: rate[1]]
        )
        values = shade(visible)
        if beyond is not None and rate == (1, 1):
            values = _choose(visible.hit, values, beyond(visible.pixels))
        return values, visible.hit, ahead

    def plain(band):
        """Of every pixel: how far away it is, and what is there without water."""
        triangle, rows = band
        hits = meet(mesh, triangle, rows, columns)
        pixels = Pixels(camera, size, rows, columns, curvature, hits.hit)
        return None if beyond is None else beyond(pixels), jnp.where(hits.hit, hits.ahead, jnp.inf)

    def by_bands(one, *images):
        bands = band_count(images[0].shape)
        return jax.tree.map(join, jax.lax.map(one, tuple(cut(each, bands) for each in images)))

    screen = mesh.screen if method.moving_silhouettes else jax.lax.stop_gradient(mesh.screen)
    if rate == (1, 1):
        image, _, ahead = by_bands(shaded, triangle, rows)
        return image, find_silhouettes(screen, ahead)
    coarse, hit, _ = by_bands(shaded, seen_by_groups(triangle, rate), rows[:: rate[0]])
    outside, ahead = by_bands(plain, triangle, rows)
    image = jax.tree.map(lambda values: interpolate(values, hit, size, rate), coarse)
    if beyond is not None:
        image = _choose(triangle != EMPTY, image, outside)
    return jax.tree.map(once, image), find_silhouettes(screen, ahead)


def _visible(
    mesh, moments, camera, size, curvature, method: Raster, triangle, rows, columns
) -> tuple[Visible, Float[Array, "rows columns"]]:
    """What pixels in some rows and columns see, and how far ahead [m], infinite without water."""
    # The triangle that stands for a group of pixels may lie beside the first of them.
    outside = OUTSIDE if method.shading_rate == (1, 1) else 0.0
    # What is apart is computed once; XLA would rather compute it again in each of its many users.
    hits = compute_apart(lambda: meet(mesh, triangle, rows, columns, outside), rows[0] >= 0)
    if not method.filtered:
        hits = hits._replace(variance=jnp.zeros_like(hits.variance))

    def look():
        seen = displaced(moments(camera.position[:2], hits.x, hits.y, hits.variance))
        return jax.tree.map(once, seen)

    seen = compute_apart(look, jnp.any(hits.hit), 0.0)
    rays, forward = camera.rays(size, rows, columns), camera.axes()[2]
    depth = hits.ahead / sum(rays[..., i] * forward[i] for i in range(3))
    visible = Visible(
        camera,
        size,
        rows,
        curvature,
        hits.hit,
        depth,
        (hits.x, hits.y),
        footprint_edges(hits),
        hits.variance,
        hits.area if method.filtered else _area(seen),
        seen,
        columns,
    )
    return visible, jnp.where(hits.hit, hits.ahead, jnp.inf)


def _choose(hit: Bool[Array, "rows columns"], sea: T, beyond: T) -> T:
    def one(first, second):
        return jnp.where(hit.reshape(hit.shape + (1,) * (first.ndim - 2)), first, second)

    return jax.tree.map(one, sea, beyond)


def _map_rays(shade, beyond, fields, cascade, camera, size, method: Rays, curvature) -> tuple:
    scene = RayScene.of_fields(fields, cascade, camera, size, method, curvature)
    moments = SurfaceMoments.from_fields(fields, cascade)
    dtype = fields.packed.real.dtype

    def one(rows):
        hits = scene.trace(moments, rows)
        seen = displaced(moments(camera.position[:2], hits.x, hits.y, hits.variance))
        place = (hits.x, hits.y)
        found = hits.hit, hits.depth, place, hits.axes, hits.variance, _area(seen), seen
        visible = Visible(camera, scene.size, rows, curvature, *found, scene.columns)
        values = shade(visible)
        if beyond is not None:
            values = _choose(visible.hit, values, beyond(visible.pixels))
        return jax.tree.map(lambda each: average(each, method.sides), values)

    shaded = jax.lax.map(one, ray_bands(size, method.sides, dtype))
    none = Edges(jnp.zeros((size[0], size[1] - 1), dtype), jnp.zeros((size[0] - 1, size[1]), dtype))
    return jax.tree.map(join, shaded), none


def _area(seen: Seen) -> Float[Array, "*b"]:
    """j of a footprint's mean deformation: rays meet the surface filtered as wide as their footprints."""
    a, b, c = seen.deformation
    return (1 + a) * (1 + b) - c * c
