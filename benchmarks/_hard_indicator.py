"""Foam in an image counted point by point, without any filter: what its pixels' coverage is held to."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxocean.render import Camera, Raster, Visible, map_visible
from jaxocean.surface import Cascade, Fields
from jaxocean.whitecaps import jacobian

ROWS = 64
"""Of points that are counted at once."""


class Points(NamedTuple):
    """What the points of an image see.

    **Arguments:** `hit`: whether water; `depth` [m] along `rays`, unit vectors; `place`: at rest [m]; `axes`: of the
    point's small footprint there [m].
    """

    hit: Bool[Array, "y x"]
    depth: Float[Array, "y x"]
    rays: Float[Array, "y x 3"]
    place: Float[Array, "y x 2"]
    axes: Float[Array, "y x 2 2"]


def look_closely(
    fields: Fields, cascade: Cascade, camera: Camera, size: tuple[int, int], across: int
) -> Points:
    """What across × across points in each pixel of an image of `size` (rows, columns) see, of a mesh with a vertex for
    each second of them. Compile it."""

    def shade(v: Visible) -> Points:
        return Points(v.hit, v.depth, v.rays, v.rest_point, jnp.asarray(v.footprint.axes))

    fine = (size[0] * across, size[1] * across)
    return map_visible(shade, fields, cascade, camera, fine, method=Raster(2.0))[0]


def counted_foam(
    points: Points, fields: Fields, cascade: Cascade, camera: Camera, threshold: float
) -> tuple[float, float]:
    """The share of the image's water that is foam [-], and the area of the surface over that of the mesh [-].

    Each point stands for its own small footprint: one place in it is drawn at random, and the nearest samples of the
    patterns say whether it breaks, j < ε. What the mesh does not resolve changes how large the place appears: it counts
    with the area N·v of the surface itself over that of the mesh. All of these together are 1 but for the draw.
    """
    textures = [
        np.concatenate([strain, slope], axis=-1)
        for strain, slope in zip(np.asarray(fields.strain), np.asarray(fields.slope), strict=True)
    ]
    rows, columns = points.hit.shape
    ahead, focal = np.asarray(camera.axes()[2], float), float(camera.focal_length((rows, columns)))
    generator = np.random.default_rng(0)
    foam = surface = 0.0
    for start in range(0, rows, ROWS):
        hit, depth, rays, place, axes = (np.asarray(each[start : start + ROWS]) for each in points)
        within = generator.uniform(-0.5, 0.5, (*hit.shape, 2, 1))
        total = _nearest(textures, cascade, place + (axes.astype(float) @ within)[..., 0])
        a, b, c, east, north = np.moveaxis(total, -1, 0)
        j = np.asarray(jacobian(jnp.asarray(total[..., :3])))
        normal = [c * north - (1 + b) * east, c * east - (1 + a) * north, (1 + a) * (1 + b) - c * c]
        pixel = depth.astype(float) ** 2 * (rays @ ahead) ** 3 / focal**2
        toward = -np.sum(np.stack(normal, axis=-1) * rays, axis=-1)
        area = np.where(hit, toward * np.abs(np.linalg.det(axes)) / pixel, 0.0)
        folds = -2.0 * (j < -threshold / 3)
        foam += np.sum(area * ((j < threshold) + folds))
        surface += np.sum(area)
    return float(foam / surface), float(surface / np.sum(np.asarray(points.hit)))


def _nearest(
    textures: list[Float[np.ndarray, "y x channel"]], cascade: Cascade, place: Float[np.ndarray, "*b 2"]
) -> Float[np.ndarray, "*b channel"]:
    """The sum of the samples of all patterns that are nearest to places [m]."""
    count, total = cascade.resolution, np.zeros(())
    for texture, size in zip(textures, cascade.sizes, strict=True):
        x, y = np.moveaxis(np.rint(place / size * count).astype(int) % count, -1, 0)
        total = total + texture[y, x]
    return total
