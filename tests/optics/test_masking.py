"""Smith's masking against its own equation, against projected areas and against profiles that really hide."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches
from scipy.special import erfc

from jaxocean.optics import (
    AzimuthCorrelatedMasking,
    HeightCorrelatedMasking,
    IndependentMasking,
    masking,
    smith_lambda,
)

FLAT = jnp.zeros(2)


def direction(zenith: float, azimuth: float = 0.0) -> jax.Array:
    return jnp.array([np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)])


def test_lambda_is_the_published_function():
    zenith, deviation = np.meshgrid(np.radians([20.0, 60.0, 80.0, 89.0]), [0.05, 0.2, 0.4])
    v = np.cos(zenith) / (np.sin(zenith) * np.sqrt(2) * deviation)
    expected = (np.exp(-v * v) - v * np.sqrt(np.pi) * erfc(v)) / (2 * v * np.sqrt(np.pi))
    got = smith_lambda(jnp.cos(zenith), jnp.asarray(deviation**2))
    np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-12)


def test_lambda_vanishes_from_above_and_without_slopes_and_grows_like_one_over_v_at_the_horizon():
    assert smith_lambda(jnp.array(1.0), jnp.array(0.04)) == 0.0
    assert smith_lambda(jnp.array(0.3), jnp.array(0.0)) == 0.0
    v = 0.002 / np.sqrt(2 * 0.04)
    np.testing.assert_allclose(
        smith_lambda(jnp.array(0.002), jnp.array(0.04)), 1 / (2 * v * np.sqrt(np.pi)), rtol=0.03
    )


@pytest.mark.parametrize("zenith", [0.3, 1.2, 1.5])
def test_what_is_seen_of_all_facets_covers_the_plane_that_they_stand_on(zenith):
    """The visible facets of a patch project to exactly the patch's own area: G1 E[max(q, 0)] = cosθ."""
    rng = np.random.default_rng(0)
    deviation = 0.2
    q = np.cos(zenith) - np.sin(zenith) * deviation * rng.standard_normal(1_000_000)
    hidden = smith_lambda(jnp.array(np.cos(zenith)), jnp.array(deviation**2))
    np.testing.assert_allclose(np.mean(np.maximum(q, 0)) / (1 + hidden), np.cos(zenith), rtol=3e-3)


@pytest.mark.parametrize("zenith", [1.35, 1.45, 1.52])
def test_a_gaussian_profile_hides_about_as_much_as_smith_says(zenith):
    """Rays over realised profiles with a Gaussian correlation; Smith leaves out correlation along the ray."""
    rng = np.random.default_rng(1)
    count, length, deviation = 1 << 16, 40.0, 0.2
    k = 2 * np.pi * np.fft.rfftfreq(count)
    amplitude = np.exp(-((k * length) ** 2) / 8) * (k > 0)
    noise = rng.standard_normal((8, k.size)) + 1j * rng.standard_normal((8, k.size))
    height = np.fft.irfft(amplitude * noise, axis=-1)
    slope = np.fft.irfft(1j * k * amplitude * noise, axis=-1)
    scale = deviation / np.std(slope)
    height, slope = height * scale, slope * scale
    # Towards a viewer at +x a point is seen if no later one stands above the ray through it.
    along = height - np.arange(count) / np.tan(zenith)
    later = np.flip(np.maximum.accumulate(np.flip(along, axis=-1), axis=-1), axis=-1)
    seen = (along >= later) & (np.cos(zenith) - slope * np.sin(zenith) > 0)
    facing = np.cos(zenith) - slope * np.sin(zenith) > 0
    seen, facing = seen[:, : count - 4000], facing[:, : count - 4000]
    expected = np.sum(seen) / np.sum(facing)
    got = 1 / (1 + smith_lambda(jnp.array(np.cos(zenith)), jnp.array(deviation**2)))
    np.testing.assert_allclose(got, expected, rtol=0.15)


def test_the_models_are_ordered_and_bounded():
    for zenith, sun, azimuth in ((1.4, 1.3, 0.0), (1.5, 0.8, 1.0), (0.5, 1.5, np.pi)):
        arguments = direction(zenith), direction(sun, azimuth), FLAT, 0.04 * jnp.eye(2)
        independent, height, aware = (
            float(masking(*arguments, model=model))
            for model in (IndependentMasking(), HeightCorrelatedMasking(), AzimuthCorrelatedMasking())
        )
        assert 0 < independent <= height <= aware <= 1


def test_whoever_looks_along_the_light_sees_no_shadow_with_the_azimuth_aware_model_only():
    view, sun = direction(1.45, 0.4), direction(1.45, 0.4)
    arguments = view, sun, FLAT, 0.04 * jnp.eye(2)
    alone = 1 / (1 + smith_lambda(view[2], jnp.array(0.04)))
    np.testing.assert_allclose(masking(*arguments, model=AzimuthCorrelatedMasking()), alone, rtol=1e-6)
    assert masking(*arguments) < 0.85 * alone


def test_nothing_is_hidden_on_a_flat_sea():
    got = masking(direction(1.5), direction(1.4, 2.0), FLAT, jnp.zeros((2, 2)))
    np.testing.assert_allclose(got, 1.0, atol=1e-6)


def test_only_the_variance_along_the_azimuth_hides():
    across = jnp.diag(jnp.array([0.0, 0.09]))
    np.testing.assert_allclose(masking(direction(1.5), direction(0.0), FLAT, across), 1.0, atol=1e-6)
    assert masking(direction(1.5, np.pi / 2), direction(0.0), FLAT, across) < 0.6


@pytest.mark.parametrize(
    "model", [HeightCorrelatedMasking(), AzimuthCorrelatedMasking(), IndependentMasking()]
)
def test_derivatives_match_differences_and_are_finite_at_singular_points(model):
    def seen(p):
        covariance = jnp.stack([p[4], p[5], p[5], p[6]]).reshape(2, 2)
        return masking(direction(1.45, 0.2), direction(1.3, 1.1) * p[0], p[2:4], covariance, model)

    points = [[1.0, 0.0, 0.02, -0.01, 0.03, 0.008, 0.012]]
    assert_gradient_matches(seen, points, rtol=1e-5, atol=1e-9, step=1e-5)
    for covariance in (jnp.zeros((2, 2)), 0.04 * jnp.eye(2)):
        for view, sun in ((direction(0.0), direction(0.0)), (direction(np.pi / 2), direction(np.pi / 2))):
            gradient = jax.grad(masking, argnums=(0, 1, 2, 3))(view, sun, FLAT, covariance, model)
            assert all(np.all(np.isfinite(each)) for each in gradient)
