"""Whole pictures whose every pixel is known."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference
from _waves import wind_sea

import jaxocean as jo
from jaxocean.render import EARTH_CURVATURE, Camera, Raster, map_visible, render, render_layers, seen_coverage
from jaxocean.render._footprint import Seen
from jaxocean.render._scene_light import SceneLight
from jaxocean.render._visible import Visible
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


def calm_ocean(sky):
    sea = realise(0.0 * wind_sea(10.0), CASCADE, key=jax.random.key(0))
    return jo.Ocean(sea, sky=sky, water=jo.optics.ConstantWater((0.0, 0.0, 0.0)))


@pytest.mark.slow
def test_a_flat_sea_on_a_round_planet_mirrors_the_sky_about_its_own_vertical():
    sky = jo.optics.sky.HosekWilkie(3.0, sun_elevation=0.9, sun_azimuth=2.0)
    ocean = calm_ocean(sky)
    seen = 0
    for height, pitch, view in ((3e6, 1.25, 1.0), (4e5, 0.6, 0.8), (2e4, 0.2, 0.5)):
        camera = Camera((0.0, 0.0, height), heading=0.3, pitch=pitch, field_of_view=view)
        layers = render_layers(ocean, camera, 0.0, SIZE, method=Raster(1.0), curvature=EARTH_CURVATURE)
        rays = np.asarray(camera.rays(SIZE))
        # Where each ray meets the sphere, from its centre.
        start = np.array([0.0, 0.0, 1 / EARTH_CURVATURE + height])
        middle = -rays @ start
        square = middle**2 - height * (2 / EARTH_CURVATURE + height)
        met = start + (middle - np.sqrt(np.maximum(square, 0)))[..., None] * rays
        up = met * EARTH_CURVATURE
        cosine = -np.sum(rays * up, -1)
        # A rotation about the axis across both verticals (Rodrigues), and not the product's own formula.
        axis = np.cross(up, [0.0, 0.0, 1.0])
        sine = np.linalg.norm(axis, axis=-1, keepdims=True)
        axis = axis / np.maximum(sine, 1e-12)

        def local(vector, axis=axis, sine=sine, up=up):
            along = np.sum(axis * vector, -1, keepdims=True)
            return vector * up[..., 2:] + np.cross(axis, vector) * sine + axis * along * (1 - up[..., 2:])

        mirror = local(rays) * [1, 1, -1]
        sun = local(np.broadcast_to(np.asarray(sky.sun_direction), rays.shape))
        inside = (cosine > 0.12) & (np.asarray(layers.sea) > 0.999)
        # Neither in the sun's own image nor in the night.
        chosen = inside & (np.sum(mirror * sun, -1) < 0.99) & (sun[..., 2] > 0.01)
        expected = fresnel(np.maximum(cosine, 0))[..., None] * np.asarray(sky.radiance(jnp.asarray(mirror)))
        np.testing.assert_allclose(np.asarray(layers.radiance)[chosen], expected[chosen], rtol=0.03)
        np.testing.assert_allclose(np.asarray(layers.normal)[inside], up[inside], atol=2e-3)
        seen += chosen.sum()
    assert seen > 400


def test_light_has_the_derivative_of_differences_in_curvature_and_height():
    sky = jo.optics.sky.HosekWilkie(3.0, sun_elevation=0.9, sun_azimuth=2.0)
    ocean = jo.Ocean(realise(wind_sea(10.0), CASCADE, key=jax.random.key(0)), sky=sky)
    scene = SceneLight(ocean, jnp.dtype(float), False)
    zero, one = jnp.zeros(SIZE), jnp.ones(SIZE)
    seen = Seen((zero + 0.02, zero), (zero + 0.01, zero + 0.02, zero), (zero,) * 3, (zero,) * 6, (zero,) * 3)

    def light(x, pitch):
        """Of what a camera sees that meets the sphere exactly."""
        curvature, height = EARTH_CURVATURE * x[0], 1e5 * x[1]
        camera = Camera(jnp.stack([0 * height, 0 * height, height]), pitch=pitch, field_of_view=0.6)
        slant = (1 + curvature * height) * -camera.rays(SIZE)[..., 2]
        rest = height * (2 + curvature * height)
        depth = rest / (slant + jnp.sqrt(slant**2 - curvature * rest))
        rows, hit = jnp.arange(SIZE[0], dtype=float), one > 0
        visible = Visible(
            camera, SIZE, rows, curvature, hit, depth, (zero, zero), (zero,) * 4, one, one, seen
        )
        return jnp.stack([jnp.mean(scene.light(visible, zero + 0.1).total), jnp.mean(visible.normal[..., 0])])

    value = jax.jit(light)
    change = jax.jit(lambda x, pitch, along: jax.jvp(lambda y: light(y, pitch), (x,), (along,))[1])
    # Obliquely from 100 and 800 km, and straight down.
    for x, pitch in (((1.0, 1.0), 0.8), ((1.0, 8.0), 1.2), ((1.0, 8.0), np.pi / 2)):
        x, pitch = jnp.asarray(x), jnp.asarray(pitch)
        for along in jnp.eye(2):
            expected = finite_difference(lambda y, pitch=pitch: value(y, pitch), x, along, 1e-4)
            found = change(x, pitch, along)
            np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-5 * np.abs(value(x, pitch)).max())
    # A plane is what becomes a planet: the difference goes to one side.
    x, along, pitch = jnp.asarray([0.0, 1.0]), jnp.asarray([1.0, 0.0]), jnp.asarray(0.8)
    steps = [value(x + h * along, pitch) for h in (0.0, 0.01, 0.02)]
    expected = (4 * steps[1] - steps[2] - 3 * steps[0]) / 0.02
    np.testing.assert_allclose(change(x, pitch, along), expected, rtol=5e-3)
    assert abs(float(expected[0])) > 1e-4


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
