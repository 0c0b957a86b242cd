"""The wind: directions, heights, units, drag and fetch."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches

import jaxocean as jo
from jaxocean.wind import (
    ElfouhailyDrag,
    WuDrag,
    direction_from_meteorological,
    inverse_wave_age_from_fetch,
    knots,
)


@pytest.mark.parametrize(
    ("from_degrees", "towards"),
    [(270.0, (1, 0)), (180.0, (0, 1)), (90.0, (-1, 0)), (0.0, (0, -1)), (225.0, (0.5**0.5, 0.5**0.5))],
)
def test_a_wind_from_the_west_blows_towards_the_east(from_degrees, towards):
    direction = jo.Wind.from_meteorological(8.0, from_degrees=from_degrees).direction
    np.testing.assert_allclose([jnp.cos(direction), jnp.sin(direction)], towards, atol=1e-12)


def test_directions_lie_within_one_turn():
    directions = direction_from_meteorological(np.arange(0.0, 721.0, 15.0))
    assert float(jnp.min(directions)) >= 0
    assert float(jnp.max(directions)) < 2 * math.pi


def test_a_knot_is_one_nautical_mile_per_hour():
    np.testing.assert_allclose(knots(20.0), 20 * 1852 / 3600)


def test_wind_measured_at_18_metres_is_weaker_at_10():
    wind = jo.Wind.from_meteorological(12.0, from_degrees=0.0, height=18.0)
    # By bisection of the neutral profile U18 = U10 + u*/κ ln 1.8, u* from the roughness of a developed sea.
    low, high = 5.0, 12.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        roughness = 3.7e-5 * middle**2 / 9.81 * 0.84**0.9
        friction = 0.41 * middle / math.log(10 / roughness)
        low, high = (middle, high) if middle + friction / 0.41 * math.log(1.8) < 12.0 else (low, middle)
    np.testing.assert_allclose(wind.speed, low, rtol=1e-10)


def test_conversion_of_heights_goes_there_and_back():
    wind = jo.Wind.from_meteorological(9.0, from_degrees=30.0, height=19.5)
    np.testing.assert_allclose(wind.at_height(19.5), 9.0, rtol=1e-10)
    assert float(wind.at_height(4.0)) < float(wind.speed) < 9.0


def test_a_wind_at_10_metres_is_taken_as_it_is():
    assert float(jo.Wind.from_meteorological(7.5, from_degrees=10.0).speed) == 7.5


def test_drag_laws_give_the_published_friction_velocities():
    # SPEC §2's formulas written out for U10 = 10 m/s.
    roughness = 3.7e-5 * 100 / 9.81 * 0.84**0.9
    np.testing.assert_allclose(jo.Wind(10.0).friction_velocity(), 4.1 / math.log(10 / roughness), rtol=1e-12)
    wu = jo.Wind(10.0, drag=WuDrag()).friction_velocity()
    np.testing.assert_allclose(wu, 10 * math.sqrt((0.8 + 0.65) * 1e-3), rtol=1e-12)


def test_young_waves_drag_more_by_one_law_and_not_by_the_other():
    young, old = (jo.Wind(10.0, drag=ElfouhailyDrag()).friction_velocity(age) for age in (2.0, 0.84))
    assert float(young) > float(old)
    young, old = (jo.Wind(10.0, drag=WuDrag()).friction_velocity(age) for age in (2.0, 0.84))
    assert float(young) == float(old)


def test_waves_grow_old_with_fetch():
    ages = [float(jo.Wind(10.0, fetch=fetch).inverse_wave_age()) for fetch in (1e4, 1e5, 1e6, 1e8)]
    assert ages == sorted(ages, reverse=True)
    np.testing.assert_allclose(ages[-1], 0.84, rtol=1e-6)
    x = 9.81 * 1e5 / 100
    np.testing.assert_allclose(ages[1], 0.84 * math.tanh((x / 2.2e4) ** 0.4) ** -0.75, rtol=1e-12)


@pytest.mark.parametrize("drag", [ElfouhailyDrag(), WuDrag()])
def test_friction_velocity_is_differentiable(drag):
    assert_derivative_matches(lambda u: jo.Wind(u, drag=drag).friction_velocity(), 9.0)
    assert_derivative_matches(
        lambda u: jo.Wind.from_meteorological(u, from_degrees=0.0, height=18.0).speed, 9.0
    )
    assert_derivative_matches(lambda u: inverse_wave_age_from_fetch(u, 5e4), 9.0)


@pytest.mark.parametrize("drag", [ElfouhailyDrag(), WuDrag()])
def test_calm_air_has_no_drag_and_finite_derivatives(drag):
    value, slope = jax.value_and_grad(lambda u: jo.Wind(u, drag=drag).friction_velocity())(0.0)
    assert float(value) == 0.0
    assert math.isfinite(float(slope))
    slope = jax.grad(
        lambda u: jo.Wind.from_meteorological(u, from_degrees=0.0, height=18.0, drag=drag).speed
    )(0.0)
    assert math.isfinite(float(slope))


def test_winds_are_batched_with_vmap():
    speeds = jnp.array([3.0, 8.0, 15.0])
    winds = eqx.filter_vmap(lambda u: jo.Wind(u, fetch=1e5))(speeds)
    frictions = eqx.filter_vmap(lambda wind: wind.friction_velocity(wind.inverse_wave_age()))(winds)
    expected = [jo.Wind(u, fetch=1e5) for u in speeds]
    np.testing.assert_allclose(frictions, [w.friction_velocity(w.inverse_wave_age()) for w in expected])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"speed": -1.0}, "`speed` must be at least 0 m/s, but is -1"),
        ({"speed": float("nan")}, "`speed` must be finite, but is nan"),
        ({"speed": [1.0, 2.0]}, "`speed` must be one number"),
        ({"speed": 10.0, "fetch": 0.0}, "`fetch` must be greater than 0 m, but is 0"),
        ({"speed": 10.0, "direction": float("inf")}, "`direction` must be finite"),
    ],
)
def test_a_bad_wind_is_refused_in_one_sentence(arguments, message):
    values = {name: jnp.asarray(value, float) for name, value in arguments.items()}
    with pytest.raises(ValueError, match=message):
        jo.Wind(**values)


@pytest.mark.parametrize("height", [0.0, -10.0, float("nan")])
def test_a_bad_height_is_refused(height):
    with pytest.raises(ValueError, match=r"`height` must be greater than 0\.01 m"):
        jo.Wind.from_meteorological(10.0, from_degrees=0.0, height=height)
    with pytest.raises(ValueError, match=r"`height` must be greater than 0\.01 m"):
        jo.Wind(10.0).at_height(height)
