"""What pixels see, one ray at a time."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Shaped

from .._types import Scalar
from ..surface import Cascade, Fields
from ._bounds import Bounds
from ._camera import Camera
from ._footprint import LEAST_SHARPNESS, SurfaceMoments, filter_variance
from ._mesh import displacement_atlas
from ._ray_footprint import footprint_axes
from ._ray_march import first_crossing
from ._ray_root import meet_surface
from ._ray_surface import RaySurface
from ._steepness import Steepness

MOST_RAYS = 2**16
"""Rays that are traced at once, unless one row of the image has more."""


class Rays(eqx.Module):
    """One ray through each pixel, or several rows of them.

    Each ray marches to the first place where it passes below the filtered surface, in steps that are bounded by how
    steep that surface can be, and Newton's method finishes. There is no mesh to lay out, and crests are as sharp as the
    footprints allow. Silhouettes have stairs, for a ray sees one thing, and unlike those of `Raster` they carry no
    derivative. With s² rays a pixel, light and all that the image is made of are means over them, each with the
    footprint of its own part of the pixel: a reference for both methods, at s² times the cost. On distant water a
    pixel's footprint is many times as long as it is wide, and more rays down than across say more of it than a square.

    **Arguments:** `samples` s: rays along each side of a pixel, or (down, across), 1 by default; `least_step`: of the
    march, in widths of the footprint's filter (of which no wave in the filtered surface is shorter than two), 0.5 by
    default.

    **Raises:** `ValueError` for samples outside 1 to 64, or a step outside 0.01 to 2.
    """

    samples: int | tuple[int, int] = eqx.field(static=True, default=1)
    least_step: float = eqx.field(static=True, default=0.5)

    def __check_init__(self) -> None:
        if len(self.sides) != 2 or not all(isinstance(side, int) and 1 <= side <= 64 for side in self.sides):
            raise ValueError(
                "Argument `samples` must be a whole number from 1 to 64, or (down, across) of such, but is "
                f"{self.samples!r}."
            )
        if not 0.01 <= self.least_step <= 2:
            raise ValueError(
                f"Argument `least_step` must be 0.01 to 2 filter widths, but is {self.least_step}."
            )

    @property
    def sides(self) -> tuple[int, int]:
        """Rays down and across a pixel."""
        return self.samples if isinstance(self.samples, tuple) else (self.samples, self.samples)


class RayHits(NamedTuple):
    """What each ray sees.

    **Arguments:** `hit`: whether it meets water; `depth`: along it [m]; `x`, `y`: rest point from the point below the
    camera [m]; `axes`: ∂x/∂column, ∂x/∂row, ∂y/∂column, ∂y/∂row [m]; `variance`: of the filter that stands for the
    footprint [m²]. Without water, depth and variance are 1 and the rest is 0.
    """

    hit: Bool[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    x: Float[Array, "rows columns"]
    y: Float[Array, "rows columns"]
    axes: tuple[Float[Array, "rows columns"], ...]
    variance: Float[Array, "rows columns"]


class RayScene(eqx.Module):
    """All that rays of one image need.

    **Arguments:** `size`: of an image with a row for each row of rays and pixels that are square; `columns`: numbers of
    those through which rays go, or None for all of them.
    """

    surface: RaySurface
    steepness: Steepness
    bounds: Bounds
    camera: Camera
    size: tuple[int, int] = eqx.field(static=True)
    columns: Float[Array, " columns"] | None
    least_step: float = eqx.field(static=True)

    @classmethod
    def of_fields(
        cls,
        fields: Fields,
        cascade: Cascade,
        camera: Camera,
        size: tuple[int, int],
        rays: Rays,
        curvature: Scalar,
    ) -> "RayScene":
        """The scene of a sea's fields at one time, for an image of `size` pixels."""
        atlas, bounds = displacement_atlas(fields, cascade), Bounds.of_fields(fields)
        down, across = rays.sides
        stride = down / across
        dtype = camera.position.dtype
        columns = stride * (jnp.arange(size[1] * across, dtype=dtype) + 0.5) - 0.5 if stride != 1 else None
        size = size[0] * down, size[1] * down
        height = camera.position[2]
        tallest = jnp.maximum(-bounds.lowest, bounds.highest)
        level = jnp.sqrt(jnp.maximum(height, 0.0) ** 2 + tallest**2 + 1e-12)
        angle = 1 / camera.focal_length(size)
        surface = RaySurface(atlas, camera.position[:2], level, angle, curvature, stride)
        return cls(surface, Steepness.of_atlas(atlas), bounds, camera, size, columns, rays.least_step)

    def trace(self, moments: SurfaceMoments, rows: Float[Array, " rows"]) -> RayHits:
        """What the rays in some rows see."""
        camera, surface = self.camera, self.surface
        rays, height = camera.rays(self.size, rows, self.columns), camera.position[2]
        still = jax.lax.stop_gradient((surface, self.steepness, self.bounds, rays, height))
        start = first_crossing(*still, self.least_step)
        hit = start.hit
        one = jnp.ones_like(start.depth)
        x, y = jnp.where(hit, start.x, 0.0), jnp.where(hit, start.y, 0.0)
        slant = surface.view(x, y)[1]
        held = (x, y, jnp.where(hit, start.depth, one))
        x, y, depth = meet_surface(surface, held, hit, rays, height, slant)
        axes = footprint_axes(surface, moments, camera, self.size, rays, (x, y, depth))
        variance = jnp.clip(filter_variance(axes), 1e-12, LEAST_SHARPNESS**-4)
        axes = tuple(jnp.where(hit, axis, 0.0) for axis in axes)
        return RayHits(hit, depth, x, y, axes, jnp.where(hit, variance, one))


def ray_bands(size: tuple[int, int], sides: tuple[int, int], dtype: jnp.dtype) -> Float[Array, "band some"]:
    """Numbers of the rows of rays, in bands of whole pixels that are traced one after the other."""
    (rows, columns), (down, across) = size, sides
    most = max(1, MOST_RAYS // (columns * down * across))
    some = max(part for part in range(1, min(most, rows) + 1) if rows % part == 0)
    return jnp.arange(rows * down, dtype=dtype).reshape(-1, some * down)


def average(
    values: Shaped[Array, "rays_down rays_across *b"], sides: tuple[int, int]
) -> Shaped[Array, "rows columns *b"]:
    """Means over the parts of each pixel; of what is true or false, what at least half of them say."""
    if sides == (1, 1):
        return values
    (down, across), (rows, columns, *others) = sides, values.shape
    pixels = values.reshape(rows // down, down, columns // across, across, *others)
    if values.dtype == bool:
        return jnp.mean(pixels.astype(jnp.float32), axis=(1, 3)) >= 0.5
    return jnp.mean(pixels, axis=(1, 3))
