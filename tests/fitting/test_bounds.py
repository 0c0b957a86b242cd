"""Bounds: bijections that never leave their range."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches

import fitting

CASES = [
    (fitting.Real(), (-3.0, 0.0, 7.5)),
    (fitting.Positive(), (1e-6, 0.5, 80.0)),
    (fitting.Positive(2.0), (2.001, 5.0)),
    (fitting.Interval(-1.0, 3.0), (-0.999, 0.0, 2.9)),
]
EACH = pytest.mark.parametrize(("bounds", "values"), CASES, ids=lambda x: str(x))


@EACH
def test_values_survive_the_way_to_free_space_and_back(bounds, values):
    values = jnp.asarray(values)
    np.testing.assert_allclose(bounds.constrain(bounds.unconstrain(values)), values, rtol=1e-12)


@EACH
def test_derivatives_match_finite_differences_and_never_vanish_inside(bounds, values):
    for value in values:
        free = float(bounds.unconstrain(jnp.asarray(value)))
        assert_derivative_matches(bounds.constrain, free, rtol=1e-6)
        assert float(jax.grad(bounds.constrain)(free)) > 0


@EACH
def test_any_free_number_lands_inside(bounds, values):
    inside = np.asarray(bounds.constrain(jnp.linspace(-30.0, 30.0, 61)))
    assert bounds.contains(inside)


@EACH
def test_drawn_starts_lie_inside_and_differ(bounds, values):
    normal = jax.random.normal(jax.random.key(3), (200,))
    start = jnp.full(200, values[1])
    drawn = np.asarray(bounds.draw(normal, start))
    assert bounds.contains(drawn)
    assert np.std(drawn) > 0.01


def test_a_value_outside_is_not_contained():
    assert not fitting.Interval(0, 1).contains(np.asarray(1.0))
    assert not fitting.Positive().contains(np.asarray([1.0, 0.0]))
    assert not fitting.Real().contains(np.asarray(np.nan))


def test_an_interval_that_is_empty_is_refused():
    with pytest.raises(ValueError, match="lower < upper, but are 2 and 1"):
        fitting.Interval(2.0, 1.0)


def test_values_at_an_edge_are_noticed():
    assert fitting.Interval(0.0, 3.0).touched(2.999) == 3.0
    assert fitting.Interval(0.0, 3.0).touched(1e-4) == 0.0
    assert fitting.Interval(0.0, 3.0).touched(1.0) is None
    assert fitting.Real().touched(1e9) is None


@EACH
def test_the_samplers_line_goes_there_and_back_and_knows_its_own_derivative(bounds, values):
    values = jnp.asarray(values)
    line = bounds.stretch(values)
    back, log_slope = bounds.shrink(line)
    np.testing.assert_allclose(back, values, rtol=1e-9, atol=1e-12)
    for at, slope in zip(line, log_slope, strict=True):
        assert_derivative_matches(lambda y: bounds.shrink(y)[0], float(at), rtol=1e-6)
        np.testing.assert_allclose(jnp.log(jax.grad(lambda y: bounds.shrink(y)[0])(at)), slope, atol=1e-9)


@EACH
def test_the_samplers_line_is_one_to_one_and_finite_far_out(bounds, values):
    line = jnp.linspace(-30.0, 30.0, 61)
    inside, log_slope = bounds.shrink(line)
    assert np.all(np.diff(inside) > 0)
    assert np.all(np.isfinite(log_slope))
    assert np.isfinite(jax.grad(lambda y: bounds.shrink(y)[1])(800.0 if "between" in str(bounds) else 80.0))
