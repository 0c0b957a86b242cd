"""Whitecaps that a camera sees, against a hard indicator at 256 points of every pixel, near and far."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import wind_sea

from jaxocean.render import Camera, Raster, map_visible, seen_coverage, visible_points
from jaxocean.surface import Cascade, realise
from jaxocean.whitecaps import FastClosure, jacobian, realised_coverage

CASCADE = Cascade((120.0, 31.0, 7.0), 64)
SIZE = (18, 32)
ACROSS = 16
THRESHOLD = 0.62


@pytest.fixture(scope="module")
def fields():
    # Of a sea this small some realisations have a third less foam than their own variance makes likely; not this one.
    sea = realise(wind_sea(14.0), CASCADE, key=jax.random.key(7))
    return jax.tree.map(lambda x: x.astype(np.complex64), sea.fields(2.0, 1.1))


@pytest.fixture(scope="module")
def see():
    """Which pixels see water, and the foam in them."""

    @eqx.filter_jit
    def see(fields, camera):
        def shade(v):
            return v.hit, seen_coverage(v.strain, jnp.float32(THRESHOLD), FastClosure(), v.area)

        return map_visible(shade, fields, CASCADE, camera, SIZE)[0]

    return see


@pytest.fixture(scope="module")
def look_closely():
    """What 16 × 16 points in each pixel see, of a mesh with a vertex for each second of them."""
    size = (SIZE[0] * ACROSS, SIZE[1] * ACROSS)
    return eqx.filter_jit(
        lambda fields, camera: visible_points(fields, CASCADE, camera, size, method=Raster(2.0))[0]
    )


def counted(visible, fields, camera):
    """The share of the image's water that is foam, point by point.

    Each point stands for its own small footprint: one place in it is drawn at random, and the nearest samples of the
    patterns say whether it breaks, without any filter. What the mesh does not resolve changes how large the place
    appears: it counts with the area N·v of the surface itself over that of the mesh.
    """
    axes, rays = np.asarray(visible.footprint.axes, float), np.asarray(visible.rays, float)
    within = np.random.default_rng(0).uniform(-0.5, 0.5, (*axes.shape[:2], 2, 1))
    place = np.asarray(visible.rest_point, float) + (axes @ within)[..., 0]
    total = np.zeros((*place.shape[:2], 5))
    for pattern, size in enumerate(CASCADE.sizes):
        x, y = np.moveaxis(np.rint(place / size * CASCADE.resolution).astype(int) % CASCADE.resolution, -1, 0)
        both = np.concatenate([fields.strain[pattern], fields.slope[pattern]], axis=-1)
        total += np.asarray(both)[y, x]
    a, b, c, east, north = np.moveaxis(total, -1, 0)
    j = np.asarray(jacobian(jnp.asarray(total[..., :3])))
    normal = np.stack([c * north - (1 + b) * east, c * east - (1 + a) * north, (1 + a) * (1 + b) - c * c], -1)
    ahead = rays @ np.asarray(camera.axes()[2], float)
    pixel = np.asarray(visible.depth, float) ** 2 * ahead**3 / float(camera.focal_length(visible.size)) ** 2
    area = np.where(visible.hit, -np.sum(normal * rays, -1) * np.abs(np.linalg.det(axes)) / pixel, 0)
    np.testing.assert_allclose(np.sum(area), np.sum(np.asarray(visible.hit)), rtol=0.02)
    folds = -2.0 * (j < -THRESHOLD / 3)
    return np.sum(area * ((j < THRESHOLD) + folds)) / np.sum(area)


@pytest.mark.slow
@pytest.mark.parametrize("height", [20.0, 100.0, 500.0, 4600.0])
def test_foam_in_an_image_is_that_of_a_hard_indicator(fields, see, look_closely, height):
    camera = Camera(jnp.asarray([30.0, 40.0, height], jnp.float32), heading=0.5, pitch=1.0, field_of_view=1.0)
    camera = camera.astype(jnp.float32)
    hit, coverage = (np.asarray(each) for each in see(fields, camera))
    assert hit.all()
    expected = counted(look_closely(fields, camera), fields, camera)
    np.testing.assert_allclose(np.mean(coverage), expected, rtol=0.1)
    if height > 4000:
        exact = float(realised_coverage(fields.strain, THRESHOLD, shifts=64))
        np.testing.assert_allclose(np.mean(coverage), exact, rtol=0.05)
