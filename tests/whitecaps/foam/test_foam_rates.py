"""How the strain moves and how often a point breaks: against sums over waves, Rice's formula and Monte Carlo."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean.spectra import Harmonics
from jaxocean.whitecaps import foam
from tests._derivatives import assert_gradient_matches

BAND, LIMIT, LEVEL = (0.05, 8.0), 6.0, 0.6


def motion_of(speed=12.0, choppiness=1.0, direction=0.5):
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed, direction))
    return foam.strain_motion(spectrum, choppiness, band=BAND, breaking_wavenumber=LIMIT)


def long_crested(variance=0.03, frequency=3.0):
    """Waves of one direction and one frequency: j = 1 + a, and nothing else moves."""
    one, nothing = jnp.ones(1), jnp.zeros(1)
    return foam.StrainMotion(
        Harmonics(one, one, nothing, one, nothing), jnp.array([variance]), jnp.array([frequency])
    )


def draw(covariance, count, seed):
    noise = np.random.default_rng(seed).standard_normal((count, 3))
    return noise @ np.linalg.cholesky(np.asarray(covariance) + 1e-15 * np.eye(3)).T


def jacobian(strain):
    return (1 + strain[:, 0]) * (1 + strain[:, 1]) - strain[:, 2] ** 2


@pytest.fixture(scope="module")
def motion():
    return motion_of()


def test_at_one_time_the_motion_is_the_strain_statistics(motion):
    stats = jo.whitecaps.strain_statistics(
        jo.spectra.Elfouhaily(jo.Wind(12.0, 0.5)), 1.0, band=BAND, breaking_wavenumber=LIMIT
    )
    np.testing.assert_allclose(motion.statistics.covariance, stats.covariance, rtol=2e-5)
    np.testing.assert_allclose(motion.lagged_covariance(0.0), stats.covariance, rtol=2e-5)


def test_at_two_times_it_is_the_sum_over_the_waves_of_a_lattice():
    cascade = jo.surface.Cascade((100.0,), 128, bands=[(0.4, 4.0)])
    spectrum = jo.spectra.Elfouhaily(jo.Wind(12.0, 0.5))
    choppiness = 1.3
    motion = foam.strain_motion(spectrum, choppiness, cascade=cascade, breaking_wavenumber=3.0)
    energy = np.asarray(jo.surface.cell_energy(spectrum, cascade))[0]
    along = 2 * np.pi * np.fft.fftfreq(128, 100.0 / 128)
    kx, ky = np.meshgrid(along, along)
    k = np.hypot(kx, ky)
    filtered = np.asarray(jo.spectra.breaking_filter(jnp.asarray(k), 3.0))
    weight = choppiness**2 * energy * filtered**2 / np.where(k > 0, k, 1) ** 2
    for lag in (0.0, 0.7, 5.0):
        moving = weight * np.cos(np.sqrt(9.81 * k) * lag)
        expected = [np.sum(moving * kx**4), np.sum(moving * kx**2 * ky**2), np.sum(moving * kx**3 * ky)]
        got = motion.lagged_covariance(lag)
        scale = float(motion.lagged_covariance(0.0)[0, 0])
        np.testing.assert_allclose([got[0, 0], got[0, 1], got[0, 2]], expected, atol=0.01 * scale)
    step = 1e-3
    bend = (motion.lagged_covariance(step) - motion.lagged_covariance(0.0)) * (-2 / step**2)
    np.testing.assert_allclose(motion.rate_covariance, bend, rtol=1e-4)


@pytest.mark.parametrize("level", [0.8, 0.5, 0.0, -0.3])
def test_a_long_crested_sea_breaks_at_the_rate_of_rice(level):
    variance, frequency = 0.09, 3.0
    rice = frequency / (2 * np.pi) * np.exp(-0.5 * (1 - level) ** 2 / variance)
    np.testing.assert_allclose(foam.breaking_rate(long_crested(variance, frequency), level), rice, rtol=2e-6)


@pytest.mark.parametrize("level", [0.75, 0.6])
def test_the_rate_is_that_at_which_drawn_seas_cross_the_threshold(motion, level):
    count, step = 4_000_000, 0.02
    now = draw(motion.statistics.covariance, count, 0)
    moves = draw(motion.rate_covariance, count, 1)
    before, after = jacobian(now - 0.5 * step * moves), jacobian(now + 0.5 * step * moves)
    crossings = np.sum((before >= level) & (after < level))
    assert crossings > 100
    rate = float(foam.breaking_rate(motion, level))
    assert crossings / count / step == pytest.approx(rate, abs=3.5 * np.sqrt(crossings) / count / step)


def test_no_rate_at_a_threshold_that_rest_is_below_nor_without_waves(motion):
    assert float(foam.breaking_rate(motion, 1.2)) == 0.0
    calm = eqx.tree_at(lambda m: m.weights, motion, jnp.zeros_like(motion.weights))
    assert float(foam.breaking_rate(calm, 0.5)) == 0.0
    slope = jax.grad(lambda w: foam.breaking_rate(eqx.tree_at(lambda m: m.weights, motion, w), 0.5))
    assert np.all(np.isfinite(slope(calm.weights)))


def test_the_rate_has_the_derivatives_of_finite_differences_in_threshold_choppiness_and_wind():
    def rate(x):
        return jnp.log(foam.breaking_rate(motion_of(x[2], x[1]), x[0]))

    assert_gradient_matches(rate, [[LEVEL, 1.0, 12.0], [-0.1, 1.8, 9.0]], rtol=1e-5)


def test_recurrence_is_that_of_drawn_pairs(motion):
    point = foam.point_breaking(motion, LEVEL, horizon=20.0)
    assert point.lags is not None
    assert point.recurrence is not None
    covariance = np.asarray(motion.statistics.covariance)
    now = draw(covariance, 6_000_000, 2)
    now = now[jacobian(now) < LEVEL]
    assert len(now) > 5_000
    for place in (8, 24, 50, 80):
        lagged = np.asarray(motion.lagged_covariance(point.lags[place]))
        forward = lagged @ np.linalg.inv(covariance)
        left = covariance - forward @ lagged
        values, vectors = np.linalg.eigh(left)
        noise = np.random.default_rng(place).standard_normal((len(now), 3)) * np.sqrt(np.maximum(values, 0))
        share = float(np.mean(jacobian(now @ forward.T + noise @ vectors.T) < LEVEL))
        error = np.sqrt(max(share, 1e-4) / len(now))
        assert float(point.recurrence[place]) == pytest.approx(share, abs=4 * error + 0.003 * share)


def test_recurrence_begins_with_certainty_and_ends_at_the_coverage(motion):
    point = foam.point_breaking(motion, LEVEL, horizon=60.0)
    assert point.lags is not None
    assert point.recurrence is not None
    assert point.weights is not None
    # κ(t) ≈ 1 − ν t/W at first: as many points have stopped to break as have begun.
    part = np.interp(0.25, np.asarray(point.lags / point.duration), np.asarray(point.recurrence))
    assert part == pytest.approx(0.75, abs=0.02)
    assert float(point.recurrence[-1]) == pytest.approx(float(point.rest), rel=0.2)
    assert float(jnp.sum(point.weights)) == pytest.approx(60.0)
    assert float(point.duration + point.interval) == pytest.approx(1 / float(point.rate))


def test_errors_name_what_is_wrong(motion):
    with pytest.raises(ValueError, match="exactly one of `band` and `cascade`, but neither"):
        foam.strain_motion(jo.spectra.Elfouhaily(jo.Wind(8.0)))
    with pytest.raises(ValueError, match="0 < lower < upper"):
        foam.strain_motion(jo.spectra.Elfouhaily(jo.Wind(8.0)), band=(2.0, 1.0))
    with pytest.raises(ValueError, match="greater than 0 s"):
        foam.point_breaking(motion, 0.5, horizon=0.0)
