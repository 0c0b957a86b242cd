"""The mean reflectance of a rough sea against draws of its facets and against its own quadrature."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

from jaxocean.optics import (
    ExactFresnel,
    SchlickFresnel,
    SlopeQuadrature,
    bruneton_mean_fresnel,
    fresnel,
    mean_fresnel,
)

DRAWS = np.random.default_rng(0).standard_normal((400_000, 2))


def direction(cosine: float, azimuth: float = 0.0) -> jax.Array:
    sine = np.sqrt(1 - cosine**2)
    return jnp.array([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine])


def covariance_of(along: float, across: float, turn: float) -> np.ndarray:
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return rotation @ np.diag([along**2, across**2]) @ rotation.T


def drawn(view, mean, covariance) -> float:
    """Mean reflectance of drawn facets, weighted by the area that each shows."""
    slopes = mean + DRAWS @ np.linalg.cholesky(covariance).T
    facing = np.maximum(view[2] - slopes @ np.asarray(view[:2]), 0)
    cosine = facing / np.sqrt(1 + np.sum(slopes**2, axis=1))
    reflected = np.asarray(fresnel(jnp.asarray(cosine), 1.34))
    return float(np.sum(reflected * facing) / np.sum(facing))


CASES = [
    (cosine, along, mean, turn)
    for along, turn in ((0.05, 0.0), (0.15, 0.6), (0.22, 1.2))
    for cosine, mean in ((0.95, (0.0, 0.0)), (0.5, (0.1, -0.05)), (0.2, (-0.1, 0.2)), (0.03, (0.0, 0.0)))
]


@pytest.mark.parametrize(("cosine", "along", "mean", "turn"), CASES)
def test_three_slopes_reflect_what_drawn_facets_reflect(cosine, along, mean, turn):
    view = direction(cosine, 0.3)
    covariance = covariance_of(along, 0.8 * along, turn)
    expected = drawn(view, np.array(mean), covariance)
    arguments = view, jnp.asarray(mean), jnp.asarray(covariance)
    np.testing.assert_allclose(mean_fresnel(*arguments), expected, rtol=0.007)
    np.testing.assert_allclose(mean_fresnel(*arguments, visible=SlopeQuadrature(12, 3)), expected, rtol=0.005)


@pytest.fixture(scope="module")
def table():
    """Reflectance over views and roughness by the reference, by three slopes and by Bruneton's fit."""
    cosine, deviation = np.meshgrid(
        np.concatenate([[0.005, 0.02, 0.05], np.linspace(0.1, 1, 19)]), np.linspace(0, 0.3, 13)
    )
    view = jnp.asarray(np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], axis=-1))
    covariance = jnp.asarray(deviation[..., None, None] ** 2 * np.diag([1.0, 0.64]))
    slope = jnp.zeros((*cosine.shape, 2))
    reference = jax.jit(lambda *a: mean_fresnel(*a, visible=SlopeQuadrature(12, 3)))(view, slope, covariance)
    three = jax.jit(mean_fresnel)(view, slope, covariance)
    fit = bruneton_mean_fresnel(jnp.asarray(cosine), jnp.asarray(deviation**2))
    return deviation, *(np.asarray(each) for each in (reference, three, fit))


def test_three_slopes_are_within_a_percent_of_the_quadrature_where_seas_are_and_two_beyond(table):
    deviation, reference, three, _ = table
    error = np.abs(three / reference - 1)
    assert np.max(error[deviation <= 0.23]) < 0.007
    assert np.max(error) < 0.015


def test_brunetons_fit_is_ten_times_worse(table):
    _, reference, three, fit = table
    error = fit / reference - 1
    assert -0.3 < np.min(error) < -0.1
    assert 0.1 < np.max(error) < 0.2
    assert np.max(np.abs(three / reference - 1)) < 0.1 * np.max(np.abs(error))


def test_brunetons_fit_is_the_printed_one():
    for cosine, deviation in ((0.3, 0.2), (0.8, 0.1)):
        expected = 0.02 + 0.98 * (1 - cosine) ** (5 * np.exp(-2.69 * deviation)) / (1 + 22.7 * deviation**1.5)
        got = bruneton_mean_fresnel(jnp.array(cosine), jnp.array(deviation**2))
        np.testing.assert_allclose(got, expected, rtol=1e-12)


@pytest.mark.parametrize("visible", [None, SlopeQuadrature(8, 3)])
def test_a_sea_without_variance_reflects_like_one_facet(visible):
    options = {} if visible is None else {"visible": visible}
    for cosine in (1.0, 0.7, 0.1):
        got = mean_fresnel(direction(cosine), jnp.zeros(2), jnp.zeros((2, 2)), **options)
        np.testing.assert_allclose(got, fresnel(jnp.array(cosine), 1.34), rtol=1e-9)
    # A facet that is tilted towards the viewer.
    view, slope = direction(0.3, 0.4), jnp.array([-0.2, -0.1])
    normal = np.array([0.2, 0.1, 1.0]) / np.sqrt(1.05)
    got = mean_fresnel(view, slope, jnp.zeros((2, 2)), **options)
    np.testing.assert_allclose(got, fresnel(jnp.asarray(view @ normal), 1.34), rtol=1e-9)


def test_any_law_of_reflection_is_averaged():
    view, covariance = direction(0.2), 0.02 * jnp.eye(2)
    got = mean_fresnel(view, jnp.zeros(2), covariance, SchlickFresnel(1.0))
    np.testing.assert_allclose(got, 1.0, rtol=1e-12)
    less, more = (mean_fresnel(view, jnp.zeros(2), covariance, ExactFresnel(n)) for n in (1.2, 1.5))
    assert less < more


def test_a_small_variance_changes_the_mean_by_its_second_derivative():
    """From the zenith F is even, and so the first term in σ² is known: no rule may lose it."""

    def mean(variance):
        return mean_fresnel(direction(0.6), jnp.zeros(2), variance * jnp.diag(jnp.array([1.0, 0.0])))

    def exact(variance):
        return mean_fresnel(
            direction(0.6),
            jnp.zeros(2),
            variance * jnp.diag(jnp.array([1.0, 0.0])),
            visible=SlopeQuadrature(12, 1),
        )

    for variance in (1e-6, 1e-4):
        got, expected = (jax.grad(f)(jnp.array(variance)) for f in (mean, exact))
        np.testing.assert_allclose(got, expected, rtol=0.02)


def test_derivatives_match_differences_and_are_finite_at_singular_points():
    def reflected(p):
        covariance = jnp.stack([p[4], p[5], p[5], p[6]]).reshape(2, 2)
        view = jnp.stack([jnp.sin(p[0]) * jnp.cos(p[1]), jnp.sin(p[0]) * jnp.sin(p[1]), jnp.cos(p[0])])
        fit = bruneton_mean_fresnel(view[2], p[4])
        return mean_fresnel(view, p[2:4], covariance, ExactFresnel(p[7])) + fit

    points = [[1.2, 0.4, 0.05, -0.1, 0.03, 0.008, 0.012, 1.34], [0.3, 2.0, 0.0, 0.0, 0.01, 0.0, 0.01, 1.34]]
    assert_gradient_matches(reflected, points, rtol=1e-5, atol=1e-9, step=1e-5)
    gradient = jax.jit(jax.grad(reflected))
    for zenith in (0.0, 1.0, np.pi / 2):
        for variance in (0.0, 0.04):
            found = gradient(jnp.array([zenith, 0.0, 0.0, 0.0, variance, 0.0, variance, 1.34]))
            assert np.all(np.isfinite(found))


def test_single_precision_follows_double_everywhere(table):
    rng = np.random.default_rng(3)
    cosine, azimuth = rng.uniform(0.002, 1, 4000), rng.uniform(0, 6.3, 4000)
    sine = np.sqrt(1 - cosine**2)
    view = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=-1)
    slope = rng.normal(0, 0.1, (4000, 2))
    covariance = np.einsum("n,ij->nij", 10 ** rng.uniform(-8, -1.2, 4000), np.eye(2))
    wide = mean_fresnel(*(jnp.asarray(each) for each in (view, slope, covariance)))
    single = mean_fresnel(*(jnp.asarray(each, jnp.float32) for each in (view, slope, covariance)))
    assert single.dtype == jnp.float32
    np.testing.assert_allclose(single, wide, rtol=2e-3)


def test_a_quadrature_without_nodes_is_refused():
    with pytest.raises(ValueError, match="along"):
        SlopeQuadrature(0, 3)
