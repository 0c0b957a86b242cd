"""Fits of a cheap model: recovery, errors, priors, failures, types and derivatives."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import SPEEDS, PowerSea, WavySea

import fitting

COEFFICIENT, EXPONENT = 3e-5, 2.4
TRUTH = COEFFICIENT * SPEEDS**EXPONENT


def both(model):
    return model.coefficient, model.exponent


def points(scatter=0.2, noise=None):
    values = TRUTH if noise is None else TRUTH * 10**noise
    return fitting.CoveragePoints(SPEEDS, values, scatter)


SOLVERS = [
    fitting.LevenbergMarquardt(),
    fitting.GaussNewton(),
    fitting.Dogleg(),
    fitting.BFGS(),
    fitting.LBFGS(),
    fitting.NelderMead(),
]


@pytest.mark.parametrize("solver", SOLVERS, ids=str)
def test_every_solver_recovers_the_numbers_behind_exact_data(solver):
    fit = fitting.fit(PowerSea(), both, points(), solver=solver)
    assert fit.values["coefficient"] == pytest.approx(COEFFICIENT, rel=1e-4)
    assert fit.values["exponent"] == pytest.approx(EXPONENT, rel=1e-4)
    assert fit.cost < 1e-8
    assert fit.steps > 1
    assert fit.seconds > 0


@pytest.mark.parametrize("solver", [fitting.LevenbergMarquardt(), fitting.Dogleg()], ids=str)
def test_rounding_of_the_cost_does_not_slow_the_last_steps(solver):
    noise = 0.3 * np.random.default_rng(3).normal(size=(60, SPEEDS.size))
    steps = [fitting.fit(PowerSea(), both, points(noise=row), solver=solver).steps for row in noise]
    assert max(steps) < 2 * min(steps)


def test_residuals_are_in_log10_and_their_rms_is_not_weighted():
    fit = fitting.fit(PowerSea(TRUTH[0]), lambda m: m.coefficient, points(scatter=0.01))
    (name,) = fit.residuals
    predicted = np.log10(fit.values["coefficient"] * SPEEDS**3.0)
    np.testing.assert_allclose(fit.residuals[name], predicted - np.log10(TRUTH), atol=1e-9)
    assert fit.rms[name] == pytest.approx(np.sqrt(np.mean(fit.residuals[name] ** 2)))
    assert fit.cost == pytest.approx(0.5 * np.sum((fit.residuals[name] / 0.01) ** 2))


def test_predictions_have_the_errors_that_the_parameters_give_them():
    fit = fitting.fit(PowerSea(), both, points(fitting.FreeScatter(0.2), noise=0.1 * np.cos(3.0 * SPEEDS)))
    # log10 W = log10 A + n log10 U
    rows = np.stack([np.full(SPEEDS.size, 1 / (fit.values["coefficient"] * np.log(10))), np.log10(SPEEDS)])
    covariance = fit.covariance[:2, :2]
    expected = np.sqrt(np.einsum("ir,ij,jr->r", rows, covariance, rows))
    np.testing.assert_allclose(fit.targets[0].error, expected, rtol=1e-6)


def test_errors_are_those_of_repeated_measurements():
    scatter = np.linspace(0.1, 0.4, SPEEDS.size)
    noise = np.random.default_rng(7).normal(size=(200, SPEEDS.size)) * scatter
    fits = [fitting.fit(PowerSea(), both, points(scatter, row)) for row in noise]
    values = np.asarray([[np.log(f.values["coefficient"]), f.values["exponent"]] for f in fits])
    errors = np.asarray(
        [[f.errors["coefficient"] / f.values["coefficient"], f.errors["exponent"]] for f in fits]
    )
    # 300 repetitions know a standard deviation to 4 %.
    np.testing.assert_allclose(np.std(values, axis=0), np.median(errors, axis=0), rtol=0.13)
    correlation = np.corrcoef(values.T)[0, 1]
    assert fits[0].correlations[0, 1] == pytest.approx(correlation, abs=0.02)
    np.testing.assert_allclose(np.mean(values, axis=0), [np.log(COEFFICIENT), EXPONENT], atol=0.08)


def test_a_prior_adds_its_information_and_pulls():
    data = points(0.2)
    free = fitting.fit(PowerSea(), lambda m: m.exponent, data)
    width = free.errors["exponent"]
    prior = fitting.Normal(free.values["exponent"] + 1.0, width, where=lambda m: m.exponent)
    pulled = fitting.fit(PowerSea(), lambda m: m.exponent, data, priors=[prior])
    # Two equally good sources meet halfway with an error smaller by √2; the model is linear in the exponent.
    assert pulled.values["exponent"] == pytest.approx(free.values["exponent"] + 0.5, rel=1e-6)
    assert pulled.errors["exponent"] == pytest.approx(width / np.sqrt(2), rel=1e-6)
    inside = fitting.Parameter(lambda m: m.exponent, prior=fitting.Normal(prior.mean, prior.deviation))
    assert fitting.fit(PowerSea(), inside, data).values == pulled.values


def test_a_free_scatter_settles_at_the_rms_and_has_its_own_error():
    noise = np.random.default_rng(1).normal(size=SPEEDS.size) * 0.3
    for solver in (fitting.LevenbergMarquardt(), fitting.BFGS()):
        fit = fitting.fit(PowerSea(), both, points(fitting.FreeScatter(1.0), noise), solver=solver)
        (rms,) = fit.rms.values()
        assert fit.values["scatter"] == pytest.approx(rms, rel=1e-5)
        assert fit.errors["scatter"] == pytest.approx(rms / np.sqrt(2 * SPEEDS.size), rel=1e-5)
    known = fitting.fit(PowerSea(), both, points(rms, noise))
    assert fit.values["exponent"] == pytest.approx(known.values["exponent"], rel=1e-5)
    np.testing.assert_allclose(fit.covariance[:2, :2], known.covariance, rtol=1e-4)


def test_two_targets_with_their_own_scatter_weigh_each_other():
    rng = np.random.default_rng(5)
    good = fitting.CoveragePoints(
        SPEEDS, TRUTH * 10 ** rng.normal(0, 0.05, 9), fitting.FreeScatter(0.5), "good"
    )
    poor = fitting.CoveragePoints(
        SPEEDS, TRUTH * 10 ** (0.5 + rng.normal(0, 0.5, 9)), fitting.FreeScatter(0.5), "poor"
    )
    fit = fitting.fit(PowerSea(), both, good + poor)
    assert fit.values["scatter of good"] < 0.1
    assert fit.values["scatter of poor"] > 0.3
    assert set(fit.residuals) == {"good", "poor"}
    alone = fitting.fit(PowerSea(), both, good)
    assert fit.values["exponent"] == pytest.approx(alone.values["exponent"], abs=0.1)


def test_a_parameter_per_wind_fits_each_wind_by_itself():
    bent = TRUTH * 10 ** (0.1 * np.sin(SPEEDS))
    data = fitting.CoveragePoints(SPEEDS, bent)
    repeated = fitting.CoveragePoints(SPEEDS[2:4], bent[2:4])
    free = fitting.Parameter(lambda m: m.coefficient, per_wind=True)
    fit = fitting.fit(PowerSea(), free, [data, repeated])
    np.testing.assert_allclose(fit.values["coefficient"], bent / SPEEDS**3.0, rtol=1e-6)
    np.testing.assert_allclose(fit.winds, SPEEDS)
    relative = fit.errors["coefficient"] / fit.values["coefficient"]
    np.testing.assert_allclose(relative[2] * np.sqrt(2), relative[0], rtol=1e-6)
    assert fit.labels[1] == "coefficient(6 m/s)"
    assert fit.model.coefficient.shape == ()


def test_shared_and_per_wind_parameters_mix():
    data = fitting.CoveragePoints([6.0, 6.0, 12.0, 12.0], [0.001, 0.002, 0.02, 0.01], [0.1, 0.1, 0.2, 0.2])
    free = [fitting.Parameter(lambda m: m.coefficient, per_wind=True), lambda m: m.exponent]
    prior = fitting.Normal(3.0, 0.1, where=lambda m: m.exponent)
    fit = fitting.fit(PowerSea(), free, data, priors=[prior])
    expected = np.sqrt([0.001 * 0.002, 0.02 * 0.01]) / np.asarray([6.0, 12.0]) ** 3
    np.testing.assert_allclose(fit.values["coefficient"], expected, rtol=1e-5)
    assert fit.values["exponent"] == pytest.approx(3.0, abs=1e-6)


def test_several_starts_find_the_deeper_valley_and_repeat_themselves():
    target = fitting.CoveragePoints(SPEEDS, np.exp(-6 + np.sin(0.8 * SPEEDS)))
    free = fitting.Parameter(lambda m: m.rate, bounds=fitting.Interval(0.0, 1.5))
    one = fitting.fit(WavySea(0.1), free, target)
    many = fitting.fit(WavySea(0.1), free, target, starts=12, key=jax.random.key(2))
    again = fitting.fit(WavySea(0.1), free, target, starts=12, key=jax.random.key(2))
    assert one.cost > 0.5
    assert many.values["rate"] == pytest.approx(0.8, rel=1e-5)
    assert many.start_costs.shape == (12,)
    assert many.start_costs[0] == pytest.approx(one.cost, rel=1e-6)
    assert again.values == many.values


def test_a_float32_model_goes_in_and_comes_out_as_float32():
    model = jax.tree.map(lambda leaf: leaf.astype(jnp.float32), PowerSea())
    fit = fitting.fit(model, both, points())
    assert fit.model.exponent.dtype == jnp.float32
    # float32 arithmetic could not bring the cost this far down.
    assert fit.cost < 1e-12
    with jax.enable_x64(False):
        single = fitting.fit(PowerSea(), both, points())
        assert single.model.exponent.dtype == jnp.float32
    assert single.values["exponent"] == pytest.approx(EXPONENT, rel=1e-6)


def test_python_numbers_in_a_model_can_be_fitted_too():
    class Plain(eqx.Module):
        exponent: float = 3.0

        def coverage(self, wind):
            return COEFFICIENT * wind.speed**self.exponent

    fit = fitting.fit(Plain(), lambda m: m.exponent, points())
    assert isinstance(fit.model.exponent, float)
    assert fit.model.exponent == pytest.approx(EXPONENT)


def test_report_holds_every_number_in_words_and_plain_values():
    fit = fitting.fit(PowerSea(), both, points())
    text = str(fit)
    assert "Levenberg-Marquardt" in text
    assert "±" in text
    assert "rms" in text
    plain = fit.as_dict()
    assert plain["parameters"][1]["value"] == fit.values["exponent"]
    assert len(plain["targets"][0]["predicted"]) == SPEEDS.size
