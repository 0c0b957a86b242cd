"""The derivative of a whole picture in every number that one may want to know, against central differences."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference

import jaxocean as jo

pytestmark = pytest.mark.slow

SIZE = (24, 32)
CASCADE = jo.surface.Cascade((120.0, 17.0), 32)
NOISE = jo.surface.draw_noise(CASCADE, key=jax.random.key(3))

NAMES = (
    "speed",
    "direction",
    "choppiness 1",
    "choppiness 2",
    "threshold",
    "sun elevation",
    "height",
    "foam reflectance",
)
STEPS = (1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-3)

DOWN = (jnp.array([14.0, 0.3, 0.9, 1.1, 0.7, 0.6, 45.0, 0.25]), jnp.array([0.9, 0.2]))
HORIZON = (jnp.array([20.0, 0.3, 1.0, 1.1, 0.7, 0.4, 9.0, 0.25]), jnp.array([0.08, 0.0]))
NIGHT = (DOWN[0].at[5].set(-0.3), DOWN[1])


def brightness(x, view):
    """A number from the whole image, of everything from the wind to the foam."""
    sea = jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(x[0], x[1])), CASCADE, noise=NOISE)
    ocean = jo.Ocean(
        sea,
        choppiness=x[2:4],
        threshold=x[4],
        breaking_wavenumber=4.0,
        sky=jo.optics.sky.HosekWilkie(2.5, sun_elevation=x[5]),
        foam=jo.optics.Foam(x[7]),
    )
    camera = jo.render.Camera(
        jnp.stack([jnp.asarray(1.0), jnp.asarray(2.0), x[6]]), pitch=view[0], roll=view[1], field_of_view=0.8
    )
    image = jo.render.render(ocean, camera, 1.5, SIZE)
    return jnp.mean((image / (0.2 + image)) ** 2)


@pytest.fixture(scope="module")
def differentiate():
    """Value and gradient in reverse mode, in one program for all tests."""
    return jax.jit(jax.value_and_grad(brightness))


def derivatives(differentiate, scene, scale=1.0):
    x, view = scene
    expected = np.array(
        [
            finite_difference(lambda y: differentiate(y, view)[0], x, along, scale * step)
            for along, step in zip(jnp.eye(x.size), STEPS, strict=True)
        ]
    )
    return np.asarray(differentiate(x, view)[1]), expected


def test_derivatives_of_a_picture_without_silhouettes_are_those_of_differences(differentiate):
    found, expected = derivatives(differentiate, DOWN)
    assert np.all(np.abs(expected) > 1e-7)
    for name, one, other in zip(NAMES, found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0.01, err_msg=name)


def test_derivatives_of_a_picture_with_crests_and_horizon_are_those_of_differences(differentiate):
    found, expected = derivatives(differentiate, HORIZON, scale=3.0)
    for name, one, other in zip(NAMES, found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0.05, err_msg=name)


def test_derivatives_are_the_same_each_time(differentiate):
    first, second = (differentiate(*HORIZON)[1] for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_at_night_a_picture_is_dark_and_its_derivatives_are_numbers(differentiate):
    value, gradient = differentiate(*NIGHT)
    assert 0 <= value < 1e-3 * float(differentiate(*DOWN)[0])
    assert np.all(np.isfinite(gradient))
