"""The inverse of closures."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

from jaxocean import Wind
from jaxocean.spectra import Elfouhaily
from jaxocean.whitecaps import ExactClosure, GaussianClosure, breaking_threshold, strain_statistics


@pytest.fixture(scope="module")
def stats():
    return strain_statistics(Elfouhaily(Wind(10.0)), 1.0, band=(1e-3, 73.0))


@pytest.mark.parametrize("closure", [ExactClosure(), ExactClosure("rest"), GaussianClosure()])
def test_it_is_the_inverse_of_the_closure(stats, closure):
    thresholds = jnp.linspace(0.1, 1.1, 6)
    coverage = closure(stats, thresholds)
    found = jax.jit(lambda w: breaking_threshold(stats, w, closure))(coverage)
    np.testing.assert_allclose(found, thresholds, atol=1e-9)


def test_in_single_precision_the_coverage_is_met(stats):
    single = jax.tree.map(lambda x: x.astype(jnp.float32), stats)
    for coverage in (1e-5, 1e-3, 0.05):
        threshold = breaking_threshold(single, coverage)
        assert threshold.dtype == jnp.float32
        np.testing.assert_allclose(ExactClosure()(single, threshold), coverage, rtol=2e-3)


def test_its_derivatives_match_differences():
    def threshold(p):
        return breaking_threshold(
            strain_statistics(Elfouhaily(Wind(p[0])), p[1], band=(1e-3, 73.0)), jnp.exp(p[2])
        )

    assert_gradient_matches(threshold, [[10.0, 1.0, -5.0], [5.0, 1.3, -8.0]], rtol=1e-4)


def test_what_no_threshold_covers_ends_at_the_end_with_finite_derivatives(stats):
    tiny, gradient = jax.value_and_grad(lambda w: breaking_threshold(stats, w))(1e-60)
    assert 0.0 <= tiny < 0.05
    assert np.isfinite(gradient)
    calm = jax.tree.map(jnp.zeros_like, stats)
    assert np.isfinite(jax.grad(lambda w: breaking_threshold(calm, w))(0.1))


@pytest.mark.parametrize("coverage", [0.0, 1.0, -0.1])
def test_a_coverage_that_is_none_is_named(stats, coverage):
    with pytest.raises(ValueError, match="Argument `coverage`"):
        breaking_threshold(stats, coverage)
