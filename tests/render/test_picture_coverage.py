"""Whitecaps that a camera sees, against a hard indicator at 256 points of every pixel, near and far."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import wind_sea

from benchmarks._hard_indicator import counted_foam, look_closely
from jaxocean.render import Camera, map_visible, seen_coverage
from jaxocean.surface import Cascade, realise
from jaxocean.whitecaps import FastClosure, realised_coverage

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
def look():
    """What 16 × 16 points in each pixel see."""
    return eqx.filter_jit(lambda fields, camera: look_closely(fields, CASCADE, camera, SIZE, ACROSS))


@pytest.mark.slow
@pytest.mark.parametrize("height", [20.0, 100.0, 500.0, 4600.0])
def test_foam_in_an_image_is_that_of_a_hard_indicator(fields, see, look, height):
    camera = Camera(jnp.asarray([30.0, 40.0, height], jnp.float32), heading=0.5, pitch=1.0, field_of_view=1.0)
    camera = camera.astype(jnp.float32)
    hit, coverage = (np.asarray(each) for each in see(fields, camera))
    assert hit.all()
    expected, surface = counted_foam(look(fields, camera), fields, CASCADE, camera, THRESHOLD)
    np.testing.assert_allclose(surface, 1.0, rtol=0.02)
    np.testing.assert_allclose(np.mean(coverage), expected, rtol=0.1)
    if height > 4000:
        exact = float(realised_coverage(fields.strain, THRESHOLD, shifts=64))
        np.testing.assert_allclose(np.mean(coverage), exact, rtol=0.05)
