"""Fits as functions: how the answer moves with the data."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _fitting_models import SPEEDS, PowerSea

import fitting
from jaxocean.whitecaps import laws

WINDS = SPEEDS[:7]


def exponent(coefficient):
    target = fitting.CoverageLaw(laws.Monahan1980(coefficient=coefficient), WINDS)
    prior = fitting.Normal(2.5, 0.5, where=lambda m: m.exponent)
    return fitting.solve_values(PowerSea(2e-5), lambda m: m.exponent, target, priors=[prior])["exponent"]


def test_values_are_those_of_the_fit():
    target = fitting.CoverageLaw(laws.Monahan1980(), WINDS)
    prior = fitting.Normal(2.5, 0.5, where=lambda m: m.exponent)
    fit = fitting.fit(PowerSea(2e-5), lambda m: m.exponent, target, priors=[prior])
    assert fit.values["exponent"] == pytest.approx(float(exponent(3.84e-6)), rel=1e-9)


def test_derivatives_in_a_law_constant_match_finite_differences():
    assert_derivative_matches(lambda x: exponent(3.84e-6 * x), 1.1, rtol=1e-5, step=1e-2)


def test_derivatives_in_measured_data_match_finite_differences():
    def fitted(log_coverage):
        target = fitting.CoveragePoints(WINDS, 10**log_coverage)
        free = fitting.Parameter(lambda m: m.exponent, bounds=fitting.Interval(1.0, 4.0))
        values = fitting.solve_values(PowerSea(), [lambda m: m.coefficient, free], target)
        return values["exponent"]

    data = jnp.asarray(np.log10(2e-5 * WINDS**2.5))
    assert_derivative_matches(fitted, data, rtol=1e-4, step=1e-2)


def test_a_singular_fit_still_has_finite_derivatives():
    def fitted(scale):
        target = fitting.CoveragePoints(WINDS, scale * WINDS**3.0)
        values = fitting.solve_values(PowerSea(), lambda m: (m.coefficient, m.threshold), target)
        return jnp.log(values["coefficient"] * values["threshold"])

    # Only the product is determined, and it follows the data one to one.
    assert float(jax.grad(fitted)(2e-5)) == pytest.approx(1 / 2e-5, rel=1e-5)


def test_fits_can_be_batched():
    scales = jnp.asarray([3.84e-6, 5e-6])
    np.testing.assert_allclose(jax.vmap(exponent)(scales), [exponent(scale) for scale in scales], rtol=1e-9)


def test_single_precision_is_refused_in_words():
    model = jax.tree.map(lambda leaf: leaf.astype(jnp.float32), PowerSea())
    with pytest.raises(ValueError, match="`exponent` must be float64 to be fitted, but is float32"):
        fitting.solve_values(model, lambda m: m.exponent, fitting.CoveragePoints(WINDS, 0.01 * np.ones(7)))
