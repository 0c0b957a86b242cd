"""Whole pictures whose every pixel is known."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import wind_sea

import jaxocean as jo
from jaxocean.render import Camera, map_visible, render, seen_coverage
from jaxocean.surface import Cascade, realise
from jaxocean.whitecaps import GaussianClosure, StrainStatistics

CASCADE = Cascade((60.0, 9.0), 32)
SIZE = (16, 24)


def fresnel(cosine, index=1.34):
    """Reflectance for unpolarised light, by Fresnel's two amplitudes."""
    inside = np.sqrt(1 - (1 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    return 0.5 * (across**2 + along**2)


@pytest.mark.slow
def test_a_flat_sea_mirrors_the_sky_in_every_pixel():
    sea = realise(0.0 * wind_sea(10.0), CASCADE, key=jax.random.key(0))
    sky = jo.optics.sky.HosekWilkie(3.0, sun_elevation=0.8, sun_azimuth=np.pi)
    ocean = jo.Ocean(sea, sky=sky, water=jo.optics.ConstantWater((0.0, 0.0, 0.0)))
    # The sun stands behind the camera, and its glitter is not in the picture.
    camera = Camera((0.0, 0.0, 30.0), heading=0.0, pitch=0.35, field_of_view=0.9)
    image = np.asarray(render(ocean, camera, 0.0, SIZE))
    rays = np.asarray(camera.rays(SIZE))
    # The horizon passes through a row of pixels that is a little of both.
    down, up = rays[..., 2] < -0.06, rays[..., 2] > 0.06
    assert down.any()
    assert up.any()
    mirrored = np.asarray(sky.radiance(jnp.asarray(rays * [1, 1, -1])))
    expected = fresnel(-rays[..., 2])[..., None] * mirrored
    # The sky that water mirrors is read from a table.
    np.testing.assert_allclose(image[down], expected[down], rtol=0.01)
    np.testing.assert_allclose(image[up], np.asarray(sky.radiance(jnp.asarray(rays)))[up], rtol=1e-6)


def test_pixels_that_hold_many_periods_have_the_coverage_of_the_whole_sea():
    fields = realise(wind_sea(14.0), CASCADE, key=jax.random.key(3)).fields(2.0, 1.2)
    camera = Camera((5.0, 6.0, 1e5), pitch=np.pi / 2)

    @eqx.filter_jit
    def see(fields):
        def shade(v):
            return v.hit, seen_coverage(v.strain, 0.6, GaussianClosure(), v.area)

        return map_visible(shade, fields, CASCADE, camera, SIZE)[0]

    hit, coverage = see(fields)
    assert np.asarray(hit).all()
    flat = np.asarray(fields.strain).reshape(2, -1, 3)
    covariance = sum(pattern.T @ pattern for pattern in flat) / flat.shape[1]
    expected = GaussianClosure()(StrainStatistics(jnp.zeros(3), jnp.asarray(covariance)), 0.6)
    assert expected > 0.01
    np.testing.assert_allclose(coverage, np.full(SIZE, expected), rtol=1e-3)
