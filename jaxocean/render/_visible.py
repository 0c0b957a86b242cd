"""All that a camera sees of a sea: for every pixel the place, the footprint and the statistics of the surface in it."""

from collections.abc import Callable
from typing import TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._elementary import once
from .._numerics import as_leaf
from .._types import Scalar, ScalarLike
from ..filtering import Footprint, Moments, symmetric_matrix
from ..surface import Cascade, Fields
from ..surface.fft._apart import compute_apart
from ..whitecaps import StrainStatistics, footprint_statistics
from ._bands import band_count, cut, join
from ._bounds import Bounds
from ._camera import Camera, check_size
from ._edges import Edges
from ._footprint import Seen, SurfaceMoments, displaced
from ._hits import footprint_edges, meet
from ._mesh import displaced_mesh, displacement_atlas
from ._planet import Components, to_world, vertical
from ._projected_grid import rest_grid
from ._raster import visible_triangles
from ._rays import Rays, RayScene, average, ray_bands
from ._silhouettes import find_silhouettes

T = TypeVar("T")


class Visible(eqx.Module):
    """What the pixels in some rows of an image see.

    Where `hit` is false everything is finite, and means nothing. Under `jit` only what is used is computed.

    **Arguments:**

    - `camera`, `size`: of the image; `rows`: numbers of the rows; `curvature`: of the planet [1/m].
    - `hit`: whether the pixel's centre sees water.
    - `depth`: distance of the seen point from the pinhole [m].
    - `place`: (x, y) of that point at rest, from the point below the camera [m].
    - `edges_of_footprint`: ∂x/∂column, ∂x/∂row, ∂y/∂column, ∂y/∂row [m] at rest.
    - `variance`: along each axis [m²], of the isotropic filter with which slopes and strain were looked up.
    - `area`: of the surface as it is drawn there, seen from above, over its area at rest [-].
    - `seen`: means and covariances of the displaced surface's slopes and of the strain in the footprint.
    """

    camera: Camera
    size: tuple[int, int] = eqx.field(static=True)
    rows: Float[Array, " rows"]
    curvature: Scalar
    hit: Bool[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    place: tuple[Float[Array, "rows columns"], ...]
    edges_of_footprint: tuple[Float[Array, "rows columns"], ...]
    variance: Float[Array, "rows columns"]
    area: Float[Array, "rows columns"]
    seen: Seen

    @property
    def rays(self) -> Float[Array, "rows columns 3"]:
        """Unit vectors from the camera to what each pixel sees."""
        return self.camera.rays(self.size, self.rows)

    @property
    def position(self) -> Float[Array, "rows columns 3"]:
        """The seen point in the world [m]."""
        return self.camera.position + self.depth[..., None] * self.rays

    @property
    def up(self) -> Components:
        """Unit vectors away from the planet's centre at the seen point: (0, 0, 1) where it is flat."""
        rays = self.rays
        place = (self.depth * rays[..., 0], self.depth * rays[..., 1])
        return vertical((*place, self.camera.position[2] + self.depth * rays[..., 2]), self.curvature)

    @property
    def rest_point(self) -> Float[Array, "rows columns 2"]:
        """The seen point at rest (x, y) [m]."""
        return self.camera.position[:2] + jnp.stack(self.place, axis=-1)

    @property
    def footprint(self) -> Footprint:
        """What the pixels cover at rest, for the look-ups of `jaxocean.filtering`."""
        x_column, x_row, y_column, y_row = self.edges_of_footprint
        rows = jnp.stack([x_column, x_row], axis=-1), jnp.stack([y_column, y_row], axis=-1)
        return Footprint(self.rest_point, jnp.stack(rows, axis=-2))

    @property
    def slope(self) -> Float[Array, "rows columns 2"]:
        """Mean slope (∂w/∂x, ∂w/∂y) of the displaced surface over its own horizontal [-]."""
        return jnp.stack(self.seen.slope, axis=-1)

    @property
    def slope_covariance(self) -> Float[Array, "rows columns 2 2"]:
        """Covariance of those slopes inside the footprint [-]."""
        return symmetric_matrix(jnp.stack(self.seen.slopes, axis=-1))

    @property
    def normal(self) -> Float[Array, "rows columns 3"]:
        """Upward unit normal of the mean slope, in the world."""
        x, y = self.seen.slope
        length = jnp.sqrt(1 + x * x + y * y)
        return jnp.stack(to_world((-x / length, -y / length, 1 / length), self.up), axis=-1)

    @property
    def strain(self) -> StrainStatistics:
        """Mean and covariance of the strain in the footprint, for whitecap closures."""
        return footprint_statistics(
            Moments(
                self.slope,
                self.slope_covariance,
                jnp.stack(self.seen.strain, axis=-1),
                symmetric_matrix(jnp.stack(self.seen.strains, axis=-1)),
            )
        )


class Raster(eqx.Module):
    """A projected mesh, drawn with a z-buffer.

    **Arguments:** `spacing`: pixels from one vertex to the next, 4 by default; fewer give sharper crests, for a cost in
    inverse proportion to its square; `filtered`: whether slopes and strain are taken over each pixel's footprint, or
    (to see what that is good for) at its centre alone.

    **Raises:** `ValueError` for a spacing outside 0.5 to 64 pixels.
    """

    spacing: float = eqx.field(static=True, default=4.0)
    filtered: bool = eqx.field(static=True, default=True)

    def __check_init__(self) -> None:
        if not 0.5 <= self.spacing <= 64:
            raise ValueError(f"Argument `spacing` must be 0.5 to 64 pixels, but is {self.spacing}.")


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
    if isinstance(method, Rays) and method.samples > 1:
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
    - `method`: how the water that a pixel sees is found, `Raster()` or `Rays()`; `Raster()` if None.
    - `curvature`: of the planet [1/m], 0 for a plane; see `EARTH_CURVATURE`.

    **Returns:** the arrays of the whole image, and the silhouettes: with `Rays` none, and with several of them in each
    pixel the means over its rays.

    **Raises:** `ValueError` for a size that makes no sense.
    """
    check_size(size)
    method = method or Raster()
    dtype = fields.packed.real.dtype
    camera, curvature = camera.astype(dtype), as_leaf(curvature).astype(dtype)
    if isinstance(method, Rays):
        return _map_rays(shade, fields, cascade, camera, size, method, curvature)
    bounds = Bounds.of_fields(fields)
    grid = rest_grid(camera, size, method.spacing, bounds, curvature)
    mesh = displaced_mesh(grid, displacement_atlas(fields, cascade), camera, size, curvature)
    nearest = jnp.maximum(camera.position[2] - bounds.lowest, 1e-3) / 256
    triangle = visible_triangles(jax.lax.stop_gradient(mesh.screen), size, jax.lax.stop_gradient(nearest))
    moments = SurfaceMoments.from_fields(fields, cascade)
    forward = camera.axes()[2]

    def one(band):
        triangle, rows = band
        # What is apart is computed once; XLA would rather compute it again in each of its many users.
        hits = compute_apart(lambda: meet(mesh, triangle, rows), rows[0] >= 0)
        if not method.filtered:
            hits = hits._replace(variance=jnp.zeros_like(hits.variance))

        def look(hits=hits):
            seen = displaced(moments(camera.position[:2], hits.x, hits.y, hits.variance))
            return jax.tree.map(once, seen)

        seen = compute_apart(look, jnp.any(hits.hit), 0.0)
        rays = camera.rays(size, rows)
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
        )
        return shade(visible), jnp.where(hits.hit, hits.ahead, jnp.inf)

    bands = band_count(size)
    rows = jnp.arange(size[0], dtype=dtype)
    shaded, ahead = jax.lax.map(one, (cut(triangle, bands), cut(rows, bands)))
    return jax.tree.map(join, shaded), find_silhouettes(mesh.screen, join(ahead))


def _map_rays(shade, fields, cascade, camera, size, method: Rays, curvature) -> tuple:
    scene = RayScene.of_fields(fields, cascade, camera, size, method, curvature)
    moments = SurfaceMoments.from_fields(fields, cascade)
    dtype = fields.packed.real.dtype

    def one(rows):
        hits = scene.trace(moments, rows)
        seen = displaced(moments(camera.position[:2], hits.x, hits.y, hits.variance))
        place = (hits.x, hits.y)
        found = hits.hit, hits.depth, place, hits.axes, hits.variance, _area(seen), seen
        visible = Visible(camera, scene.size, rows, curvature, *found)
        return jax.tree.map(lambda each: average(each, method.samples), shade(visible))

    shaded = jax.lax.map(one, ray_bands(size, method.samples, dtype))
    none = Edges(jnp.zeros((size[0], size[1] - 1), dtype), jnp.zeros((size[0] - 1, size[1]), dtype))
    return jax.tree.map(join, shaded), none


def _area(seen: Seen) -> Float[Array, "*b"]:
    """j of a footprint's mean deformation: rays meet the surface filtered as wide as their footprints."""
    a, b, c = seen.deformation
    return (1 + a) * (1 + b) - c * c
