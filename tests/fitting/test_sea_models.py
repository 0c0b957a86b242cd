"""Fits of real seas: the reference fit, the ridge of coverage alone, and counting against quadrature."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import SPEEDS

import fitting
from jaxocean import Wind
from jaxocean.spectra import Elfouhaily
from jaxocean.surface import Cascade
from jaxocean.whitecaps import (
    ExactClosure,
    GaussianClosure,
    HardBreaking,
    SmoothBreaking,
    laws,
    strain_statistics,
)

BAND = (1e-3, 400.0)
WINDS = np.asarray([8.0, 12.0, 16.0])


def threshold(model):
    return model.threshold


def reference_sea(choppiness=1.0, closure=None):
    closure = ExactClosure("rest") if closure is None else closure
    return fitting.SpectralModel(
        0.5, choppiness, band=BAND, spectrum=fitting.ElfouhailySea(0.84), closure=closure
    )


@pytest.fixture(scope="module")
def monahan():
    with pytest.warns(laws.RangeWarning, match="18, 20 m/s"):
        return fitting.CoverageLaw(laws.Monahan1980(), SPEEDS)


def test_the_reference_fit_is_reproduced(monahan):
    fit = fitting.fit(reference_sea(), threshold, monahan)
    assert fit.values["threshold"] == pytest.approx(0.539, abs=0.003)
    (rms,) = fit.rms.values()
    assert rms == pytest.approx(0.213, abs=0.001)
    (residuals,) = fit.residuals.values()
    assert residuals[0] == pytest.approx(0.21, abs=0.01)
    assert residuals[-1] == pytest.approx(-0.42, abs=0.01)
    assert any("18, 20 m/s" in text for text in fit.warnings)


@pytest.mark.parametrize(("choppiness", "expected"), [(3.1, -0.15), (4.6, -0.7), (6.2, -1.5)])
def test_the_ridge_of_equally_good_pairs_runs_where_it_is_known_to(monahan, choppiness, expected):
    fit = fitting.fit(reference_sea(choppiness), threshold, monahan)
    assert fit.values["threshold"] == pytest.approx(expected, abs=0.02)
    assert next(iter(fit.rms.values())) < 0.16


def test_coverage_alone_cannot_tell_choppiness_from_threshold(monahan):
    fit = fitting.fit(reference_sea(), lambda m: (m.threshold, m.choppiness), monahan)
    assert fit.correlations[0, 1] < -0.93
    assert fit.condition_number > 5
    (advice,) = (text for text in fit.warnings if "cannot be separated" in text)
    assert advice.startswith("threshold and choppiness cannot be separated from this data (correlation -0.9")
    assert "fix choppiness, give it a prior, or add a target" in advice


def test_each_wind_can_have_its_own_threshold(monahan):
    free = fitting.Parameter(threshold, per_wind=True)
    fit = fitting.fit(reference_sea(closure=GaussianClosure("rest")), free, monahan)
    (residuals,) = fit.residuals.values()
    np.testing.assert_allclose(residuals, 0.0, atol=1e-6)
    assert fit.values["threshold"].shape == SPEEDS.shape
    # The Gaussian closure has far too much foam in weak winds, so their threshold must be lower.
    assert fit.values["threshold"][0] < fit.values["threshold"][-1] - 0.1


def test_the_fitted_threshold_follows_the_law_it_is_fitted_to():
    model = reference_sea(closure=GaussianClosure("rest"))

    def fitted(scale):
        law = laws.Monahan1980(coefficient=3.84e-6 * scale)
        return fitting.solve_values(model, threshold, fitting.CoverageLaw(law, WINDS))["threshold"]

    slope = float(jax.jit(jax.grad(fitted))(1.0))
    step = 1e-3
    expected = float((fitted(1 + step) - fitted(1 - step)) / (2 * step))
    assert slope == pytest.approx(expected, rel=1e-5)
    assert slope > 0


def test_preparing_changes_no_number():
    wind = Wind(11.0, 0.4)
    cascade = Cascade((200.0, 31.0), 64)
    model = fitting.SpectralModel(
        0.4, jnp.asarray([1.2, 0.8]), cascade=cascade, breaking_wavenumber=5.0, closure=ExactClosure("rest")
    )
    direct, prepared, statistics = eqx.filter_jit(
        lambda m: (
            m.log_coverage(wind),
            m.prepared(m.prepare(wind)).log_coverage(wind),
            m.statistics(wind).covariance,
        )
    )(model)
    np.testing.assert_allclose(prepared, direct, rtol=1e-13)
    expected = strain_statistics(
        Elfouhaily(wind), jnp.asarray([1.2, 0.8]), cascade=cascade, breaking_wavenumber=5.0
    )
    np.testing.assert_allclose(statistics, expected.covariance, rtol=1e-12)


def test_free_leaves_of_the_spectrum_are_fitted_through_their_moments():
    closure = GaussianClosure("rest")
    truth = fitting.SpectralModel(
        0.5, 1.0, spectrum=fitting.ElfouhailySea(1.6), band=BAND, breaking_wavenumber=120.0, closure=closure
    )
    winds = fitting.CoveragePoints(WINDS, np.full(3, 0.1)).winds
    coverage, slopes = eqx.filter_jit(jax.vmap(lambda w: (truth.coverage(w), truth.mean_square_slope(w))))(
        winds
    )

    def law(wind):
        return fitting.Slopes(jnp.interp(wind.speed, winds.speed, slopes), jnp.zeros_like(wind.speed))

    targets = fitting.CoveragePoints(winds, coverage, 0.1) + fitting.SlopeVariance(winds, law, label="a law")
    start = fitting.SpectralModel(
        0.5, 1.0, spectrum=fitting.ElfouhailySea(1.2), band=BAND, breaking_wavenumber=80.0, closure=closure
    )
    fit = fitting.fit(start, lambda m: (m.spectrum.inverse_wave_age, m.breaking_wavenumber), targets)
    assert fit.values["inverse_wave_age"] == pytest.approx(1.6, rel=1e-5)
    assert fit.values["breaking_wavenumber"] == pytest.approx(120.0, rel=1e-5)
    assert fit.parameters[1].unit == "rad/m"


def test_a_sea_model_takes_exactly_one_of_band_and_cascade():
    with pytest.raises(ValueError, match="exactly one of `band` and `cascade`, but neither is"):
        fitting.SpectralModel(0.5, 1.0)
    with pytest.raises(ValueError, match="but both are"):
        fitting.SpectralModel(0.5, 1.0, band=BAND, cascade=Cascade())
    with pytest.raises(ValueError, match="one for each of the 2 patterns, but has shape"):
        fitting.SpectralModel(0.5, [1.0, 1.0, 1.0], cascade=Cascade((200.0, 31.0), 64))


CASCADE = Cascade((80.0, 13.0), 64)


def realised(key, **options):
    return fitting.RealisedModel(0.45, 1.2, cascade=CASCADE, key=jax.random.key(key), seeds=6, **options)


@pytest.fixture(scope="module")
def counted_target():
    """Coverage of the closure at a threshold of 0.5, so that both ways know what they look for."""
    model = fitting.SpectralModel(0.5, 1.2, cascade=CASCADE)
    winds = fitting.CoveragePoints(WINDS, np.full(3, 0.1)).winds
    return fitting.CoveragePoints(winds, eqx.filter_jit(eqx.filter_vmap(model.coverage))(winds))


def test_threshold_counted_on_realisations_agrees_with_quadrature_within_its_error(counted_target):
    narrow = SmoothBreaking(0.01)
    fits = [fitting.fit(realised(key, breaking=narrow), threshold, counted_target) for key in range(4)]
    values = np.asarray([fit.values["threshold"] for fit in fits])
    error = np.std(values, ddof=1) / np.sqrt(len(values))
    assert error < 0.02
    # Student's t with three degrees of freedom: 99 % within 5.8 errors.
    assert abs(np.mean(values) - 0.5) < 5.8 * error
    assert np.ptp(values) > 0


def test_a_hard_threshold_is_refused(counted_target):
    with pytest.raises(fitting.FitError, match="`threshold` did not move"):
        fitting.fit(realised(0, breaking=HardBreaking()), threshold, counted_target)


def test_random_numbers_are_drawn_once():
    wind = Wind(12.0)
    model = realised(1)
    first, again, other = eqx.filter_jit(
        lambda a, b: (a.coverages(wind), a.coverages(wind), b.coverages(wind))
    )(model, realised(2))
    np.testing.assert_array_equal(first, again)
    assert not np.allclose(first, other)
    assert first.shape == (6,)
    same = fitting.RealisedModel(0.45, 1.2, cascade=CASCADE, noise=model.noise)
    np.testing.assert_array_equal(same.noise, model.noise)


def test_a_realised_model_takes_exactly_one_of_key_and_noise():
    with pytest.raises(ValueError, match="exactly one of `key` and `noise`, but neither is"):
        fitting.RealisedModel(cascade=CASCADE)
    noise = jnp.zeros((1, 2, 64, 64), complex)
    with pytest.raises(ValueError, match="but both are"):
        fitting.RealisedModel(cascade=CASCADE, noise=noise, key=jax.random.key(0))
    with pytest.raises(ValueError, match="`seeds` must be at least 1"):
        fitting.RealisedModel(cascade=CASCADE, key=jax.random.key(0), seeds=0)
