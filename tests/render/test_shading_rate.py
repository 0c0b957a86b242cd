"""Fewer shaded points than pixels: what lies between them, and that no pixel is lost."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference
from _views import TIME, windy

import jaxocean as jo
from jaxocean.render import Camera, Raster, render, render_layers
from jaxocean.render._raster import EMPTY
from jaxocean.render._shading_rate import interpolate, lattice, seen_by_groups

CASCADE = jo.surface.Cascade((120.0, 17.0), 32)
# Neither side is a whole number of groups.
SIZE = (45, 63)
RATE = (2, 2)


@pytest.fixture(scope="module")
def ocean():
    return jo.Ocean(windy(CASCADE, 14.0), choppiness=1.1, threshold=0.7)


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
    np.testing.assert_allclose(np.asarray(found)[inner], (2.0 + 0.3 * v - 0.1 * u)[inner], rtol=1e-12)
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


def test_the_sky_is_that_of_every_pixel_and_the_sea_nearly(ocean):
    camera = Camera((1.0, 2.0, 9.0), pitch=0.1, roll=0.2, field_of_view=0.8)
    fine, coarse = (
        render_layers(ocean, camera, TIME, SIZE, method=Raster(shading_rate=rate)) for rate in ((1, 1), RATE)
    )
    above, below = np.asarray(fine.sea) == 0, np.asarray(fine.sea) == 1
    assert np.sum(above) > 200
    assert np.sum(below) > 1000
    np.testing.assert_allclose(coarse.sea, fine.sea, atol=1e-12)
    np.testing.assert_allclose(coarse.background[above], fine.background[above], rtol=1e-12)
    # The same light in all, spread over twice as many pixels: contrast falls, the mean does not.
    for name, tolerance in (("radiance", 0.02), ("coverage", 0.05), ("depth", 0.02)):
        one, other = (np.asarray(getattr(layers, name))[below] for layers in (fine, coarse))
        np.testing.assert_allclose(np.mean(other), np.mean(one), rtol=tolerance, err_msg=name)
        assert np.std(other) < 1.02 * np.std(one)
    parts = coarse.sun + coarse.sky + coarse.water + coarse.foam + coarse.background
    np.testing.assert_allclose(coarse.radiance, parts, rtol=1e-9, atol=1e-12)
    picture = render(ocean, camera, TIME, SIZE, method=Raster(shading_rate=RATE))
    np.testing.assert_allclose(picture, coarse.radiance, rtol=1e-9, atol=1e-12)


def test_the_derivative_is_that_of_differences(ocean):
    @jax.jit
    def brightness(x):
        camera = Camera(jnp.stack([1.0 + 0 * x[0], 2.0 + 0 * x[0], x[0]]), pitch=0.7, field_of_view=0.8)
        scene = eqx.tree_at(lambda o: (o.threshold, o.choppiness), ocean, (x[1], x[2] * jnp.ones(2)))
        picture = render(scene, camera, TIME, (24, 32), method=Raster(shading_rate=RATE))
        return jnp.mean((picture / (0.2 + picture)) ** 2)

    x = jnp.asarray([45.0, 0.7, 0.9])
    change = jax.jit(lambda along: jax.jvp(brightness, (x,), (along,))[1])
    for along in jnp.eye(3):
        expected = finite_difference(brightness, x, along, 1e-4)
        assert abs(expected) > 1e-7
        np.testing.assert_allclose(change(along), expected, rtol=0.01)


@pytest.mark.parametrize("rate", [(0, 1), (1, 5), (1.5, 1), (2, 2, 2)])
def test_a_rate_that_makes_no_sense_is_refused(rate):
    with pytest.raises(ValueError, match="shading_rate"):
        Raster(shading_rate=rate)
