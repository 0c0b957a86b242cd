"""Targets: what they observe, and what they refuse."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import PowerSea

import fitting
from jaxocean import Wind
from jaxocean.spectra import Elfouhaily, mean_square_slope
from jaxocean.whitecaps import laws


def test_winds_may_be_speeds_or_winds_in_any_shape():
    speeds = [5.0, 8.0]
    forms = (
        speeds,
        np.asarray(speeds),
        jnp.asarray(speeds),
        [Wind(5.0), Wind(8.0)],
        eqx.filter_vmap(Wind)(jnp.asarray(speeds)),
    )
    for winds in forms:
        target = fitting.CoverageLaw(laws.Monahan1980(), winds)
        np.testing.assert_allclose(target.observed(), np.log10(3.84e-6 * np.asarray(speeds) ** 3.41))
    assert fitting.CoverageLaw(laws.Monahan1980(), Wind(5.0)).size == 1
    assert fitting.CoverageLaw(laws.Monahan1980(), 5.0).size == 1


def test_a_law_that_knows_the_temperature_sees_it():
    winds = [Wind(8.0, sea_air_temperature_difference=d) for d in (0.0, 3.0)]
    cold, warm = fitting.CoverageLaw(laws.MonahanOMuircheartaigh1986(), winds).observed()
    assert float(warm - cold) == pytest.approx(3 * 0.0861 / np.log(10))


@pytest.mark.parametrize("winds", [[], [-1.0], [np.nan], np.ones((2, 2))])
def test_winds_that_make_no_sense_are_refused(winds):
    with pytest.raises(ValueError, match="Argument `winds` must"):
        fitting.CoverageLaw(laws.Monahan1980(), winds)


def test_a_law_outside_its_range_warns_with_the_winds_at_fault():
    with pytest.warns(laws.RangeWarning, match="0 to 17 m/s, but is a target at 18, 20 m/s"):
        fitting.CoverageLaw(laws.Monahan1980(), [16.0, 18.0, 20.0])


def test_a_law_without_whitecaps_cannot_be_a_target():
    with pytest.raises(ValueError, match="gives none at 3 m/s"):
        fitting.CoverageLaw(laws.Callaghan2008(), [3.0, 8.0])


@pytest.mark.parametrize("coverage", [[0.0, 0.1], [0.1, 1.2], [0.1, np.nan]])
def test_measured_coverage_must_be_a_fraction(coverage):
    with pytest.raises(ValueError, match="fractions greater than 0 and at most 1"):
        fitting.CoveragePoints([5.0, 6.0], coverage)


def test_measured_coverage_must_have_one_number_for_each_wind():
    with pytest.raises(ValueError, match="one number for each of the 2 winds, but has shape"):
        fitting.CoveragePoints([5.0, 6.0], [0.1])
    with pytest.raises(ValueError, match="Argument `scatter` must be one number or one for each"):
        fitting.CoveragePoints([5.0, 6.0], [0.1, 0.2], [0.1, 0.2, 0.3])


@pytest.mark.parametrize("scatter", [0.0, -1.0, np.inf])
def test_scatter_must_be_positive(scatter):
    with pytest.raises(ValueError, match="greater than 0"):
        fitting.CoveragePoints([5.0, 6.0], [0.1, 0.2], scatter)


def test_columns_become_points_and_a_missing_column_is_named():
    columns = {"U10": [5.0, 9.0], "W": [0.1, 0.9], "sigma": [0.3, 0.6]}
    target = fitting.CoveragePoints.from_columns(
        columns, wind="U10", coverage="W", scatter="sigma", percent=True
    )
    np.testing.assert_allclose(target.observed(), np.log10([0.001, 0.009]))
    np.testing.assert_allclose(target.scatter.value, [0.3, 0.6])
    with pytest.raises(ValueError, match="`wind` must be present, but the columns are `U10`, `W`, `sigma`"):
        fitting.CoveragePoints.from_columns(columns)


def test_targets_add_in_any_grouping():
    a = fitting.CoverageLaw(laws.Monahan1980(), [5.0])
    b = fitting.CoveragePoints([6.0], [0.01])
    c = fitting.SlopeVariance([7.0])
    assert (a + b + c).targets == (a, b, c)
    assert (a + (b + c)).targets == (a, b, c)
    with pytest.raises(ValueError, match="at least one target"):
        fitting.fit(PowerSea(), lambda m: m.coefficient, [])


def test_cox_and_munk_take_the_wind_at_their_own_height():
    slopes = fitting.CoxMunk1954()(Wind(10.0))
    # u* = 0.36 m/s: the wind gains 0.2 m/s from 10 to 12.5 m.
    at_mast = 10.0 + float(Wind(10.0).friction_velocity()) / 0.41 * np.log(1.25)
    assert at_mast == pytest.approx(10.2, abs=0.02)
    assert float(slopes.upwind) == pytest.approx(3.16e-3 * at_mast)
    assert float(slopes.crosswind) == pytest.approx(0.003 + 1.92e-3 * at_mast)


def test_slope_components_turn_with_the_wind_and_add_up():
    winds = [Wind(9.0, direction) for direction in (0.0, 0.7, 2.5)]
    model = fitting.SpectralModel(band=(1e-3, 100.0))
    slopes = [eqx.filter_jit(model.slope_variance)(wind) for wind in winds]
    for one in slopes:
        np.testing.assert_allclose(one.upwind, slopes[0].upwind, rtol=1e-10)
        np.testing.assert_allclose(one.crosswind, slopes[0].crosswind, rtol=1e-10)
    assert slopes[0].upwind > slopes[0].crosswind
    total = mean_square_slope(Elfouhaily(winds[0]), band=(1e-3, 2000.0))
    np.testing.assert_allclose(slopes[1].upwind + slopes[1].crosswind, total, rtol=1e-10)
    kinds = (fitting.Total(), fitting.Upwind(), fitting.Crosswind())
    known = model.prepared(eqx.filter_jit(model.prepare)(winds[1]))
    predicted = [float(fitting.SlopeVariance([9.0], component=c).predict(known, winds[1])) for c in kinds]
    assert np.exp(predicted[0]) == pytest.approx(np.exp(predicted[1]) + np.exp(predicted[2]))


def test_a_model_without_the_question_is_named():
    with pytest.raises(ValueError, match="a PowerSea has none"):
        fitting.SlopeVariance([5.0]).predict(PowerSea(), Wind(5.0))
    with pytest.raises(ValueError, match="has neither"):
        fitting.CoverageLaw(laws.Monahan1980(), [5.0]).predict(object(), Wind(5.0))


def test_law_constants_can_be_differentiated_through_a_target():
    def observed(coefficient):
        target = fitting.CoverageLaw(laws.Monahan1980(coefficient=coefficient), [5.0])
        return target.observed()[0]

    assert float(jax.grad(observed)(3.84e-6)) == pytest.approx(1 / (3.84e-6 * np.log(10)))
