"""Synthetic data, and how often intervals contain the truth."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import SPEEDS, PowerSea
from scipy import stats

import fitting
from fitting._coverage_shares import binomial_share

PRIOR = fitting.Normal(2.4, 0.2)
SCATTER = 0.3


def model():
    return PowerSea(coefficient=3e-5, exponent=2.4)


def free(prior=PRIOR):
    return [lambda m: m.coefficient, fitting.Parameter(lambda m: m.exponent, prior=prior)]


def target(scatter=SCATTER):
    return fitting.CoveragePoints(SPEEDS, np.full(SPEEDS.size, 1e-3), scatter)


@pytest.fixture(scope="module")
def thousand():
    return fitting.coverage_probability(model(), free(), target(), sets=1000)


def test_synthetic_data_scatter_around_the_model_as_the_target_says():
    scatter = np.linspace(0.1, 0.9, SPEEDS.size)
    slopes = fitting.SlopeVariance([5.0], law=lambda wind: fitting.Slopes(wind.speed, wind.speed))

    class Both(PowerSea):
        def slope_variance(self, wind):
            return fitting.Slopes(0.01 * wind.speed, 0.02 * wind.speed)

    sea = Both(coefficient=3e-5, exponent=2.4)
    sets = fitting.synthetic(sea, [target(scatter), slopes], count=4000, key=jax.random.key(0))
    drawn = np.stack([each[0].observed() for each in sets])
    truth = np.log10(3e-5 * SPEEDS**2.4)
    np.testing.assert_allclose(drawn.mean(axis=0), truth, atol=4 * 0.9 / np.sqrt(4000))
    np.testing.assert_allclose(drawn.std(axis=0), scatter, rtol=0.06)
    pulls = (drawn - truth) / scatter
    assert stats.kstest(pulls.ravel(), "norm").pvalue > 1e-3
    assert np.abs(np.corrcoef(pulls.T) - np.eye(SPEEDS.size)).max() < 0.08
    other = np.stack([each[1].observed() for each in sets])
    assert np.mean(other) == pytest.approx(np.log(0.15), abs=4 * 0.1 / np.sqrt(4000))
    assert np.std(other) == pytest.approx(0.1, rel=0.06)


def test_synthetic_data_can_be_fitted_and_lead_back_to_the_truth():
    (one,) = fitting.synthetic(model(), target(1e-4), key=jax.random.key(1))
    found = fitting.fit(PowerSea(), free(None), one)
    assert found.values["exponent"] == pytest.approx(2.4, abs=5e-4)
    assert found.targets[0].name == "measured coverage"


@pytest.mark.parametrize("method", ["laplace", "profile"])
@pytest.mark.parametrize("level", [0.5, 0.9, 0.99])
def test_intervals_contain_the_truth_as_often_as_they_promise(thousand, method, level):
    # The exponent is linear: both kinds of interval are exact, and the number of hits is binomial.
    share = thousand.share(method, "exponent", level)
    assert share.total == 1000
    low, high = stats.binom.interval(0.999, 1000, level)
    assert low <= share.hits <= high
    assert share.lower < share.hits / share.total < share.upper


def test_truths_with_a_prior_are_drawn_from_it_and_others_are_the_models_own(thousand):
    assert thousand.labels == ("coefficient", "exponent")
    assert stats.kstest(thousand.truths[:, 1], stats.norm(2.4, 0.2).cdf).pvalue > 1e-3
    np.testing.assert_array_equal(thousand.truths[:, 0], 3e-5)
    np.testing.assert_allclose(thousand.truths[0, 0], 3e-5)


def test_an_interval_that_leans_on_a_wrong_prior_breaks_its_promise():
    wrong = fitting.coverage_probability(model(), free(fitting.Normal(2.4, 0.02)), target(), sets=50)
    right = wrong.share("laplace", "exponent", 0.9)
    assert right.hits >= 40
    # The same intervals against truths as wide as the real world's: most miss.
    pulls = (2.4 + 0.2 * np.random.default_rng(0).normal(size=50) - wrong.values[:, 1]) / wrong.errors[:, 1]
    assert np.sum(np.abs(pulls) < stats.norm.ppf(0.95)) < 25


def test_the_program_for_many_sets_gives_what_a_fit_gives_for_each(thousand):
    for i in (0, 7, 49, 50):
        data = fitting.Replayed(target(), jnp.asarray(thousand.numbers[0][i]))
        found = fitting.fit(model(), free(), data)
        np.testing.assert_allclose(thousand.values[i], list(found.values.values()), rtol=1e-5)
        np.testing.assert_allclose(thousand.errors[i], list(found.errors.values()), rtol=1e-4)
        name, truth = "exponent", thousand.truths[i, 1]
        curve = fitting.profile(model(), free(), data, parameter=name, grid=[truth, truth + 1.0])
        at = int(np.argmin(np.abs(curve.grid - truth)))
        assert thousand.roots[i, 1] == pytest.approx(curve.signed_root[at], abs=1e-3)


def test_more_sets_begin_with_the_same_ones(thousand):
    few = fitting.coverage_probability(model(), free(), target(), sets=7)
    np.testing.assert_array_equal(few.truths, thousand.truths[:7])
    np.testing.assert_array_equal(few.values, thousand.values[:7])
    other = fitting.coverage_probability(model(), free(), target(), sets=7, key=jax.random.key(1))
    assert not np.array_equal(few.truths, other.truths)


def test_posterior_intervals_are_counted_on_a_subset_and_contain_the_truth_too():
    alone = fitting.Parameter(lambda m: m.exponent, prior=PRIOR)
    found = fitting.coverage_probability(model(), alone, target(), sets=30, sampled=25, warmup=150)
    assert found.methods == ("laplace", "profile", "posterior")
    share = found.share("posterior", "exponent", 0.9)
    assert share.total == 25
    assert share.hits >= stats.binom.ppf(1e-3, 25, 0.9)
    # All is Gaussian: the truth has the rank among the draws that the fit's error gives.
    pulls = (found.truths[:25, 0] - found.values[:25, 0]) / found.errors[:25, 0]
    np.testing.assert_allclose(found.ranks[:, 0], stats.norm.cdf(pulls), atol=0.15)
    assert np.ptp(found.ranks) > 0.7


@pytest.mark.parametrize("hits", [0, 85, 100])
def test_shares_carry_wilsons_interval(hits):
    share = binomial_share(hits, 100)
    expected = stats.binomtest(hits, 100).proportion_ci(0.95, method="wilson")
    np.testing.assert_allclose([share.lower, share.upper], [expected.low, expected.high], atol=1e-12)


def test_nonsense_is_refused(thousand):
    with pytest.raises(ValueError, match="`sets` must be at least 2"):
        fitting.coverage_probability(model(), free(), target(), sets=1)
    with pytest.raises(ValueError, match=r"`sampled` must lie between 0 and `sets` \(5\), but is 6"):
        fitting.coverage_probability(model(), free(), target(), sets=5, sampled=6)
    with pytest.raises(ValueError, match="`count` must be at least 1"):
        fitting.synthetic(model(), target(), count=0, key=jax.random.key(0))
    with pytest.raises(ValueError, match='`method` must be one of "laplace", "profile"'):
        thousand.share("posterior", "exponent")
    with pytest.raises(ValueError, match="`label` must be one of `coefficient`, `exponent`"):
        thousand.share("laplace", "threshold")
    with pytest.raises(ValueError, match="one number for each of the 9 winds"):
        fitting.Replayed(target(), jnp.zeros(3))
