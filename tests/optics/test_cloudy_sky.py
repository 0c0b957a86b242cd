"""A sky with clouds: Moon & Spencer's overcast, and what is between it and a clear one."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

from jaxocean.optics import luminance
from jaxocean.optics.sky import CloudySky, ConstantSky, HosekWilkie


def dome(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions in the middles of cells of equal solid angle on the upper half, and that angle."""
    heights = (np.arange(count) + 0.5) / count
    azimuths = 2 * np.pi * (np.arange(2 * count) + 0.5) / (2 * count)
    z, phi = (grid.ravel() for grid in np.meshgrid(heights, azimuths))
    flat = np.sqrt(1 - z**2)
    return np.stack([flat * np.cos(phi), flat * np.sin(phi), z], axis=-1), 2 * np.pi / z.size


@eqx.filter_jit
def seen(sky, directions):
    return sky.radiance(directions)


def test_an_overcast_sky_is_three_times_as_bright_overhead_as_at_the_horizon_and_grey():
    sky = CloudySky(HosekWilkie(3.0, sun_elevation=0.7), 1.0)
    up, aside = seen(sky, jnp.asarray([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]))
    np.testing.assert_allclose(up, 3 * aside, rtol=1e-9)
    np.testing.assert_allclose(up, np.full(3, up[0]), rtol=1e-9)
    np.testing.assert_array_equal(sky.sun_irradiance, 0.0)


def test_its_light_on_the_sea_is_the_given_share_of_what_comes_without_clouds():
    clear = HosekWilkie(3.0, sun_elevation=0.7)
    sky = CloudySky(clear, 1.0, 0.25)
    whole = clear.irradiance() + clear.sun_irradiance * np.sin(0.7)
    directions, angle = dome(200)
    counted = np.sum(np.asarray(seen(sky, jnp.asarray(directions))) * directions[:, 2:], axis=0) * angle
    np.testing.assert_allclose(counted, np.full(3, 0.25 * float(luminance(whole))), rtol=1e-4)
    np.testing.assert_allclose(sky.irradiance(), counted, rtol=1e-4)


def test_without_cover_it_is_the_clear_sky_and_with_some_of_it_a_mean():
    clear = ConstantSky((0.1, 0.2, 0.3), 2.0, 0.8)
    around = jnp.asarray(dome(5)[0])
    np.testing.assert_allclose(seen(CloudySky(clear, 0.0), around), seen(clear, around), rtol=1e-12)
    half = 0.5 * (seen(clear, around) + seen(CloudySky(clear, 1.0), around))
    np.testing.assert_allclose(seen(CloudySky(clear, 0.5), around), half, rtol=1e-12)
    np.testing.assert_allclose(CloudySky(clear, 0.25).sun_irradiance, 0.75 * clear.sun_irradiance, rtol=1e-12)


def test_a_lobe_sees_the_mean_of_the_clouds():
    sky = CloudySky(ConstantSky(0.0, 1.0, 0.9), 1.0)
    axis = np.array([0.6, 0.0, 0.8])
    across = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0]])
    random = np.random.default_rng(0).normal(size=(200_000, 2)) * 0.1
    length = np.linalg.norm(random, axis=1, keepdims=True)
    # Turned away from the axis by the length of a random step on the tangent plane.
    turned = np.cos(length) * axis + np.sinc(length / np.pi) * (random @ across)
    counted = np.asarray(seen(sky, jnp.asarray(turned))).mean(axis=0)
    lobe = sky.lobe_radiance(jnp.asarray(axis), jnp.asarray(0.01))
    np.testing.assert_allclose(lobe, counted, rtol=1e-3)


def test_derivatives_match_differences():
    directions = jnp.asarray([[0.6, 0.0, 0.8], [0.995, 0.0, 0.0998749]])

    def light(p):
        sky = CloudySky(HosekWilkie(3.0, sun_elevation=p[2]), p[0], p[1])
        return jnp.sum(sky.radiance(directions)) + jnp.sum(sky.irradiance()) + jnp.sum(sky.sun_irradiance)

    assert_gradient_matches(light, [[0.4, 0.25, 0.7], [1e-3, 0.5, 0.2]], rtol=1e-5)


def test_a_baked_one_keeps_its_light():
    from jaxocean.optics.sky import bake

    sky = CloudySky(HosekWilkie(4.0, sun_elevation=0.5), 0.6)
    np.testing.assert_allclose(bake(sky, 128).irradiance(), sky.irradiance(), rtol=5e-3)
    assert np.all(np.isfinite(jax.grad(lambda c: jnp.sum(bake(CloudySky(sky.clear, c), 32).image))(0.3)))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((ConstantSky(0.1), 1.5), "Argument `cover`"),
        ((ConstantSky(0.1), 0.5, -0.1), "Argument `transmitted`"),
    ],
)
def test_wrong_arguments_are_named(arguments, words):
    with pytest.raises(ValueError, match=words):
        CloudySky(*arguments)
