"""Fits that cannot succeed say what happened, why, and what to try; doubtful ones warn in words."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import SPEEDS, PowerSea

import fitting
import jaxocean as jo

TARGET = fitting.CoveragePoints(SPEEDS, 2e-5 * SPEEDS**2.5)


def failure(model, free, **options):
    with pytest.raises(fitting.FitError) as caught:
        fitting.fit(model, free, TARGET, **options)
    text = str(caught.value)
    assert "Likely cause:" in text
    assert "Try:" in text
    return text


def test_a_parameter_that_the_targets_do_not_see_is_refused():
    text = failure(PowerSea(), lambda m: (m.exponent, m.unseen))
    assert "`unseen` did not move" in text
    assert "hard threshold" in text
    assert "SmoothBreaking" in text


def test_a_start_without_a_finite_value_names_the_winds():
    class Dry(eqx.Module):
        exponent: jnp.ndarray

        def coverage(self, wind):
            return jnp.maximum(wind.speed - 5.0, 0.0) ** self.exponent

    text = failure(Dry(jnp.asarray(3.0)), lambda m: m.exponent)
    assert "no finite number" in text
    assert "at 4 m/s" in text


def test_a_start_without_finite_derivatives_is_refused():
    class Kink(eqx.Module):
        exponent: jnp.ndarray

        def log_coverage(self, wind):
            return wind.speed * jnp.sqrt(self.exponent)

    assert "derivatives of the model are not finite" in failure(Kink(jnp.asarray(0.0)), lambda m: m.exponent)


def test_too_few_steps_are_reported_as_no_convergence():
    solver = fitting.LevenbergMarquardt(steps=2)
    text = failure(PowerSea(), lambda m: (m.coefficient, m.exponent), solver=solver)
    assert "did not converge in 2 steps" in text
    assert "prior" in text


def test_a_solver_that_runs_off_is_reported():
    class Cliff(eqx.Module):
        exponent: jnp.ndarray

        def log_coverage(self, wind):
            # An undamped step from the flat side leaps beyond the largest number.
            return jnp.exp(self.exponent) + 0.0 * wind.speed

    text = failure(Cliff(jnp.asarray(-30.0)), lambda m: m.exponent, solver=fitting.GaussNewton())
    assert "Gauss-Newton solver" in text


def test_inseparable_parameters_are_named_with_the_ways_out():
    fit = fitting.fit(PowerSea(), lambda m: (m.threshold, m.coefficient), TARGET)
    assert (
        "threshold and coefficient cannot be separated from this data (correlation -1)" in fit.identifiability
    )
    assert "fix coefficient, give it a prior, or add a target" in fit.identifiability
    assert any("cannot be separated" in text for text in fit.warnings)
    assert fit.condition_number > 1e6


def test_a_prior_that_separates_is_named_instead_of_warned_about():
    prior = fitting.Normal(1.0, 0.1, where=lambda m: m.threshold)
    fit = fitting.fit(PowerSea(), lambda m: (m.threshold, m.coefficient), TARGET, priors=[prior])
    assert "the prior of threshold decides" in fit.identifiability
    assert fit.warnings == ()
    assert fit.errors["threshold"] == pytest.approx(0.1, rel=1e-3)


def test_separable_parameters_are_called_so():
    fit = fitting.fit(PowerSea(), lambda m: m.exponent, TARGET)
    assert fit.identifiability.startswith("Every parameter is determined")
    assert fit.condition_number == pytest.approx(1.0)
    assert fit.warnings == ()


def test_three_parameters_in_one_combination_are_noticed():
    class Three(eqx.Module):
        x: jnp.ndarray
        y: jnp.ndarray
        z: jnp.ndarray

        def log_coverage(self, wind):
            s = wind.speed / 10
            return self.x * s + self.y * jnp.cos(s) + self.z * (s + jnp.cos(s) + 1e-5 * s**2) / 2

    zero = jnp.asarray(0.1)
    fit = fitting.fit(Three(zero, zero, zero), lambda m: (m.x, m.y, m.z), TARGET)
    assert any("x" in text and "y" in text and "z" in text for text in fit.warnings) or len(fit.warnings) >= 3
    assert fit.condition_number > 1e3


def test_a_parameter_at_its_bound_is_warned_about():
    free = fitting.Parameter(lambda m: m.exponent, bounds=fitting.Interval(2.9, 3.5))
    fit = fitting.fit(PowerSea(2e-5), free, TARGET)
    assert fit.values["exponent"] == pytest.approx(2.9, abs=1e-3)
    assert any("exponent is at its bound 2.9" in text for text in fit.warnings)


def test_more_numbers_than_data_are_warned_about():
    free = [lambda m: m.exponent, fitting.Parameter(lambda m: m.coefficient, per_wind=True)]
    fit = fitting.fit(PowerSea(), free, TARGET)
    assert any("10 free numbers for 9 data and 0 priors" in text for text in fit.warnings)


def test_a_number_of_starts_below_one_is_refused():
    with pytest.raises(ValueError, match="`starts` must be at least 1, but is 0"):
        fitting.fit(PowerSea(), lambda m: m.exponent, TARGET, starts=0)


def test_scatter_of_a_perfect_model_stops_at_its_floor_with_a_warning():
    target = fitting.CoveragePoints(SPEEDS, 2e-5 * SPEEDS**2.5, fitting.FreeScatter(0.5))
    fit = fitting.fit(PowerSea(), lambda m: (m.coefficient, m.exponent), target)
    assert fit.values["scatter"] == pytest.approx(5e-4, rel=0.02)
    assert any("scatter is at its bound" in text for text in fit.warnings)
    assert np.isfinite(fit.covariance).all()


def test_an_ocean_is_refused_with_the_models_that_do_fit():
    spectrum = jo.spectra.Elfouhaily(jo.Wind(10.0))
    sea = jo.surface.realise(spectrum, jo.surface.Cascade((100.0,), 16), key=jax.random.key(0))
    with pytest.raises(ValueError, match=r"SpectralModel\(…\)"):
        fitting.fit(jo.Ocean(sea), lambda m: m.threshold, TARGET)
