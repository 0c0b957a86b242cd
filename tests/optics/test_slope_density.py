"""The Gaussian of slopes and what it says along one azimuth."""

import jax
import jax.numpy as jnp
import numpy as np
from _derivatives import assert_gradient_matches
from scipy.stats import multivariate_normal

from jaxocean.optics import directional_variance, slope_density

MEAN = np.array([0.05, -0.12])
COVARIANCE = np.array([[0.03, 0.008], [0.008, 0.012]])


def test_the_density_integrates_to_one():
    axis = jnp.linspace(-1.3, 1.3, 401)
    grid = jnp.stack(jnp.meshgrid(axis, axis, indexing="ij"), axis=-1)
    ones = jnp.ones((401, 401))
    density = slope_density(grid, ones[..., None] * MEAN, ones[..., None, None] * COVARIANCE)
    np.testing.assert_allclose(jnp.sum(density) * (axis[1] - axis[0]) ** 2, 1.0, rtol=1e-10)


def test_the_density_is_scipys():
    slopes = np.random.default_rng(0).normal(0, 0.2, (50, 2))
    expected = multivariate_normal(MEAN, COVARIANCE).pdf(slopes)
    got = jax.vmap(lambda s: slope_density(s, jnp.asarray(MEAN), jnp.asarray(COVARIANCE)))(slopes)
    np.testing.assert_allclose(got, expected, rtol=1e-10)


def test_the_variance_along_an_azimuth_is_that_of_drawn_slopes():
    slopes = np.random.default_rng(1).multivariate_normal([0, 0], COVARIANCE, 400_000)
    for azimuth in (0.0, 0.7, 2.5):
        along = np.array([np.cos(azimuth), np.sin(azimuth)])
        got = directional_variance(jnp.asarray(COVARIANCE), jnp.asarray(along))
        np.testing.assert_allclose(got, np.var(slopes @ along), rtol=0.01)


def test_a_covariance_without_area_gives_zero_with_finite_derivatives():
    for singular in (np.zeros((2, 2)), np.array([[0.02, 0.0], [0.0, 0.0]])):
        value, gradient = jax.value_and_grad(slope_density, argnums=(0, 1, 2))(
            jnp.asarray(MEAN), jnp.asarray(MEAN), jnp.asarray(singular)
        )
        assert value == 0.0
        assert all(np.all(np.isfinite(each)) for each in gradient)


def test_derivatives_match_differences():
    def density(p):
        covariance = jnp.stack([p[4], p[5], p[5], p[6]]).reshape(2, 2)
        return slope_density(p[:2], p[2:4], covariance) + directional_variance(covariance, p[:2])

    assert_gradient_matches(density, [[0.1, 0.0, 0.05, -0.12, 0.03, 0.008, 0.012]], rtol=1e-5)
