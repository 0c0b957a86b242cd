"""Fewer shaded points than pixels: what lies between them, and that no pixel is lost."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference
from _views import TIME, windy

import jaxocean as jo
from jaxocean.render import Camera, Raster
from jaxocean.render._map_visible import map_image
from jaxocean.render._raster import EMPTY
from jaxocean.render._shading_rate import interpolate, lattice, seen_by_groups

CASCADE = jo.surface.Cascade((120.0, 17.0), 32)
# Neither side is a whole number of groups.
SIZE = (45, 63)
RATE = (2, 2)
SEA = windy(CASCADE, 14.0)


@pytest.mark.parametrize("rate", [(1, 2), (2, 1), (2, 2), (3, 4)])
def test_what_is_linear_over_the_image_stays_what_it_is(rate):
    rows, columns = lattice(SIZE, rate)
    y, x = jnp.meshgrid(
        rate[0] * jnp.arange(rows, dtype=float), rate[1] * jnp.arange(columns, dtype=float), indexing="ij"
    )
    found = interpolate(2.0 + 0.3 * y - 0.1 * x, jnp.ones((rows, columns), bool), SIZE, rate)
    v, u = np.mgrid[: SIZE[0], : SIZE[1]]
    # After the last point there is none to draw a line to.
    inner = (v <= rate[0] * (rows - 1)) & (u <= rate[1] * (columns - 1))
    np.testing.assert_allclose(np.asarray(found)[inner], (2.0 + 0.3 * v - 0.1 * u)[inner], atol=1e-12)
    assert np.all(np.isfinite(found))


def test_every_pixel_that_sees_water_has_a_value_of_water_alone():
    key = jax.random.key(0)
    seen = jax.random.bernoulli(key, 0.2, SIZE)
    triangle = jnp.where(seen, jnp.uint32(7), EMPTY)
    groups = seen_by_groups(triangle, RATE) != EMPTY
    # Points without water hold what must not be seen.
    values = jnp.where(groups, 5.0, jnp.nan)
    found = np.asarray(interpolate(values, groups, SIZE, RATE))
    np.testing.assert_allclose(found[np.asarray(seen)], 5.0, rtol=1e-12)
    assert np.all(np.isfinite(found))


@pytest.fixture(scope="module")
def see():
    """Share of sea, row of the sky, height of the ray's end and slope of the sea, at a shading rate."""

    @partial(jax.jit, static_argnums=(1, 2))
    def image(x, rate, size):
        camera = Camera(
            jnp.stack([0 * x[0] + 1.0, 0 * x[0] + 2.0, x[0]]), pitch=x[1], roll=0.2, field_of_view=0.8
        )
        fields = SEA.fields(TIME, x[2])

        def shade(visible):
            return jnp.ones_like(visible.depth), 0 * visible.depth, 1 / visible.depth, visible.seen.slope[0]

        def beyond(pixels):
            none = jnp.zeros(pixels.hit.shape)
            return none, none + pixels.rays[..., 2], none, none

        return map_image(shade, beyond, fields, CASCADE, camera, size, method=Raster(shading_rate=rate))[0]

    return image


def test_the_sky_is_that_of_every_pixel_and_the_sea_nearly(see):
    x = jnp.asarray([9.0, 0.1, 1.1])
    fine, coarse = (jax.tree.map(np.asarray, see(x, rate, SIZE)) for rate in ((1, 1), RATE))
    sea = fine[0] == 1
    assert np.sum(~sea) > 200
    assert np.sum(sea) > 1000
    np.testing.assert_array_equal(coarse[0], fine[0])
    np.testing.assert_allclose(coarse[1], fine[1], atol=1e-12)
    # The same in all, spread over twice as many pixels: contrast falls, the mean does not.
    for one, other, alike in zip(fine[2:], coarse[2:], (0.99, 0.8), strict=True):
        spread = np.std(one[sea])
        np.testing.assert_allclose(np.mean(other[sea]), np.mean(one[sea]), atol=0.05 * spread)
        assert np.corrcoef(other[sea], one[sea])[0, 1] > alike
        assert 0.7 * spread < np.std(other[sea]) < 1.02 * spread


def test_the_derivative_is_that_of_differences(see):
    def loss(x):
        _, _, near, slope = see(x, RATE, (24, 32))
        return jnp.mean(slope**2 + slope) + 100 * jnp.mean(near**2)

    x = jnp.asarray([45.0, 0.9, 0.9])
    change = jax.jit(lambda along: jax.jvp(loss, (x,), (along,))[1])
    for along in jnp.eye(3):
        expected = finite_difference(loss, x, along, 1e-6)
        assert abs(expected) > 1e-6
        np.testing.assert_allclose(change(along), expected, rtol=1e-4)


@pytest.mark.parametrize("rate", [(0, 1), (1, 5)])
def test_a_rate_that_makes_no_sense_is_refused(rate):
    with pytest.raises(ValueError, match="shading_rate"):
        Raster(shading_rate=rate)
