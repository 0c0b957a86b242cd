"""Closures over footprints: their limits, and the paper's two channels."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import wind_sea
from scipy import stats

from jaxocean.filtering import Footprint, MeanPyramid, MomentPyramid, Moments
from jaxocean.surface import Cascade, realise
from jaxocean.whitecaps import (
    ExactClosure,
    GaussianClosure,
    PrintedTwoChannelClosure,
    ProgramTwoChannelClosure,
    StrainStatistics,
    footprint_statistics,
    jacobian,
    two_channels,
)

CASCADE = Cascade((60.0, 9.0), 32)
LAMBDA = 2.0


@pytest.fixture(scope="module")
def fields():
    return realise(wind_sea(14.0), CASCADE, key=jax.random.key(1)).fields(0.0, LAMBDA)


@pytest.fixture(scope="module")
def seen(fields):
    """Points, and the whole plane."""
    places = np.random.default_rng(0).uniform(0, 180, (400, 2))
    side = np.where(np.arange(400) < 399, 0.0, 1000.0)
    return MomentPyramid.from_fields(fields, CASCADE)(Footprint.square(places, side), probes=1)


def test_at_a_point_the_exact_closure_is_the_indicator(seen):
    j = np.asarray(jacobian(seen.strain_mean))[:-1]
    coverage = np.asarray(ExactClosure("rest")(footprint_statistics(seen), 0.5))[:-1]
    clear = np.abs(j - 0.5) > 0.005
    assert 5 < np.count_nonzero(j < 0.5) < 200
    np.testing.assert_allclose(coverage[clear], (j < 0.5)[clear], atol=1e-6)


def test_in_the_whole_plane_it_is_the_coverage_of_the_sea(seen, fields):
    covariance = sum(np.cov(np.asarray(f).reshape(-1, 3), rowvar=False, bias=True) for f in fields.strain)
    sea = StrainStatistics(jnp.zeros(3), jnp.asarray(covariance))
    for closure in (ExactClosure("rest"), ExactClosure(), GaussianClosure("rest")):
        coverage = float(closure(footprint_statistics(seen), jnp.full(400, 0.5))[-1])
        assert coverage == pytest.approx(float(closure(sea, 0.5)), rel=1e-4)
        assert coverage > 1e-3


def test_the_floor_keeps_rounded_moments_positive_definite():
    flat = Moments(jnp.zeros(2), jnp.zeros((2, 2)), jnp.zeros(3), -1e-9 * jnp.eye(3))
    statistics = footprint_statistics(flat)
    assert np.all(np.linalg.eigvalsh(statistics.covariance) > 0)
    for level, expected in ((0.5, 0.0), (1.5, 1.0)):
        assert float(ExactClosure("rest")(statistics, level)) == pytest.approx(expected, abs=1e-12)


def draws(patterns: int) -> jnp.ndarray:
    """Strains of independent Gaussian patterns."""
    rng = np.random.default_rng(3)
    root = np.array([[0.2, 0.0, 0.0], [0.05, 0.15, 0.0], [0.02, 0.01, 0.1]])
    return jnp.asarray(rng.normal(size=(patterns, 200_000, 3)) @ root.T)


@pytest.mark.parametrize("patterns", [1, 3])
def test_the_means_of_k_add_up_to_that_of_j_and_the_programs_variance_is_what_it_says(patterns):
    strain = draws(patterns)
    channels = two_channels(strain, patterns)
    means = jnp.moveaxis(jnp.mean(channels, axis=1), 0, -2)
    j = jacobian(jnp.sum(strain, axis=0))
    assert float(jnp.sum(means[..., 0])) == pytest.approx(float(jnp.mean(j)), abs=2e-3)
    program = float(ProgramTwoChannelClosure().variance(means))
    k = np.asarray(channels[..., 0])
    assert program == pytest.approx(np.sum(np.var(k, axis=1)), rel=1e-9)
    if patterns == 1:
        assert program == pytest.approx(float(jnp.var(j)), rel=1e-9)
    else:
        # Without the terms between patterns it is too small.
        assert program < 0.995 * float(jnp.var(j))


def test_one_pattern_has_one_formula_and_it_is_eq_6():
    means = jnp.mean(two_channels(draws(1), 1), axis=1)[:, None]
    printed, program = PrintedTwoChannelClosure(), ProgramTwoChannelClosure()
    mu, square = (float(x) for x in means[0, 0])
    expected = stats.norm.cdf((0.6 - mu) / np.sqrt(square - mu**2))
    assert bool(printed.defined(means)[0])
    assert float(printed(means, 0.6)[0]) == pytest.approx(expected, rel=1e-9)
    assert float(program(means, 0.6)[0]) == pytest.approx(expected, rel=1e-9)


def test_the_printed_variance_of_several_patterns_is_negative_and_its_coverage_undefined(fields):
    pyramid = MeanPyramid.from_channels(two_channels(fields.strain, 2), CASCADE.sizes)
    places = np.random.default_rng(0).uniform(0, 60, (50, 2))
    means = pyramid(Footprint.square(places, np.full(50, 5.0)))
    printed, program = PrintedTwoChannelClosure(), ProgramTwoChannelClosure()
    assert not np.any(printed.defined(means))
    assert np.all(np.isnan(printed(means, 0.5)))
    coverage = np.asarray(program(means, 0.5))
    assert np.all((coverage >= 0) & (coverage < 1))
    assert np.ptp(coverage) > 0


def test_without_spread_the_two_channels_give_the_indicator():
    k = jnp.asarray([[0.3, 0.1], [0.4, 0.3]])
    means = jnp.stack([k, k**2], axis=-1)
    np.testing.assert_array_equal(ProgramTwoChannelClosure()(means, 0.5), [1.0, 0.0])
    assert np.all(np.isnan(PrintedTwoChannelClosure()(means, 0.5)))


def test_coverage_of_footprints_is_differentiable_in_their_moments_and_the_threshold():
    def coverage(q):
        spread = 0.02 * jnp.eye(3) * q[0]
        moments = Moments(jnp.zeros(2), jnp.zeros((2, 2)), jnp.stack([q[1], 0.0, 0.0]), spread)
        means = jnp.stack([jnp.stack([q[1], q[1] ** 2 + q[0]]), jnp.stack([0.5, 0.26])])
        return ExactClosure("rest")(footprint_statistics(moments), q[2]) + ProgramTwoChannelClosure()(
            means, q[2]
        )

    assert_derivative_matches(coverage, [1.0, -0.1, 0.6], step=1e-4)
    # At σ = 0 the derivative is that of an indicator: nothing, not NaN.
    still = jnp.asarray([[0.3, 0.09], [0.4, 0.16]])
    slope = jax.grad(lambda m: ProgramTwoChannelClosure()(m, 0.5))(still)
    assert np.all(np.isfinite(slope))
