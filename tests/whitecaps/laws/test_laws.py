"""Whitecap laws against the values of their papers, their limits and their derivatives."""

import warnings

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches

from jaxocean.whitecaps import laws
from jaxocean.wind import Wind, WuDrag

EACH = pytest.mark.parametrize("law", laws.ALL, ids=lambda law: type(law).__name__)


def coverage(law, speed, **of_wind):
    """W without the warning: tests that look outside the range say so by calling this."""
    return law.coverage(Wind(speed, **of_wind))


@pytest.mark.parametrize(
    ("law", "percent"),
    [
        (laws.Monahan1980(), (0.093, 0.987, 3.93, 10.5)),
        (laws.MonahanOMuircheartaigh1986(), (0.118, 0.692, 1.95, 4.05)),
        (laws.Callaghan2008(), (0.007, 0.795, 2.36, 5.12)),
        (laws.Salisbury2013(), (0.513, 1.54, 2.94, 4.65)),
    ],
)
def test_laws_give_the_published_values(law, percent):
    for speed, expected in zip((5.0, 10.0, 15.0, 20.0), percent, strict=True):
        digit = 0.0005 if expected < 1 else 0.005 if expected < 10 else 0.05
        assert 100 * float(coverage(law, speed)) == pytest.approx(expected, abs=1.02 * digit)


@pytest.mark.parametrize(
    ("law", "speed", "expected"),
    [
        # Worked by hand from the printed formulas.
        (laws.Monahan1980LeastSquares(), 10.0, 2.95e-6 * 10**3.52),
        (laws.GoddijnMurphy2011(), 10.0, 1.59e-5 * 10**2.7),
        (laws.StramskaPetelski2003Undeveloped(), 10.0, 8.75e-5 * 3.67**3),
        (laws.StramskaPetelski2003Developed(), 10.0, 5.0e-5 * 5.53**3),
        (laws.COARE36(), 10.0, 7.3e-4 * 8**1.43),
        (laws.COARE36(), 2.05, 1e-5),
    ],
)
def test_laws_give_their_printed_formula(law, speed, expected):
    assert float(law(Wind(speed))) == pytest.approx(expected, rel=1e-12)


def test_monahan_and_lu_depend_on_the_water_temperature_through_its_viscosity():
    # 20 °C: ν = 0.010656 cm²/s, (gν 1e-4)^(1/3) = 0.021866.
    bracket = 10 / (9.81 * 0.010656e-4) ** (1 / 3) - 75.9
    decaying = laws.MonahanLu1990StageB(water_temperature=20.0)(Wind(10.0))
    active = laws.MonahanLu1990StageA(water_temperature=20.0)(Wind(10.0))
    assert float(decaying) == pytest.approx((5.21e-4 * bracket) ** 3, rel=1e-9)
    assert float(decaying / active) == pytest.approx(9.7)
    assert laws.MonahanLu1990StageB(water_temperature=0.0)(Wind(10.0)) < decaying


def test_warm_water_under_cold_air_whitens_more():
    law = laws.MonahanOMuircheartaigh1986()
    ratio = coverage(law, 10.0, sea_air_temperature_difference=2.0) / coverage(law, 10.0)
    assert float(ratio) == pytest.approx(np.exp(0.0861 * 2), rel=1e-12)


def test_zhao_toba_sees_friction_and_wave_age():
    wind = Wind(12.0, drag=WuDrag())
    friction = 12.0 * np.sqrt((0.8 + 0.065 * 12.0) * 1e-3)
    for age in (0.84, 2.0):
        breaking = friction**2 * 12.0 / (1.5e-5 * 9.81 * age)
        assert float(laws.ZhaoToba2001(inverse_wave_age=age)(wind)) == pytest.approx(3.88e-7 * breaking**1.09)
    by_fetch = laws.ZhaoToba2001()(Wind(12.0, fetch=2e4, drag=WuDrag()))
    assert by_fetch < laws.ZhaoToba2001()(wind)


def test_callaghan_is_continuous_where_its_branches_cross_and_zero_below_its_onset():
    law = laws.Callaghan2008()
    speeds = jnp.linspace(9.0, 12.0, 3001)
    w = jax.vmap(lambda u: law.coverage(Wind(u)))(speeds)
    assert float(jnp.max(jnp.abs(jnp.diff(w)))) < 5e-6
    crossing = (3.7 * 3.18e-5 ** (1 / 3) + 1.98 * 4.82e-6 ** (1 / 3)) / (
        3.18e-5 ** (1 / 3) - 4.82e-6 ** (1 / 3)
    )
    assert crossing == pytest.approx(10.19, abs=0.01)
    assert float(law(Wind(9.5))) == pytest.approx(3.18e-5 * 5.8**3)
    assert float(law(Wind(11.0))) == pytest.approx(4.82e-6 * 12.98**3)
    assert float(coverage(law, 3.6)) == 0.0


@EACH
def test_derivatives_match_finite_differences(law):
    def value_and_log(u):
        return law.coverage(Wind(u)) + law.log(Wind(u))

    assert_derivative_matches(value_and_log, 12.1)
    if isinstance(law, laws.Callaghan2008):
        assert_derivative_matches(value_and_log, 7.3)


@EACH
def test_value_and_derivative_stay_finite_from_calm_to_storm(law):
    speeds = jnp.asarray([0.0, 1e-12, 1e-4, 1.0, 2.0, 2.1, 3.7, 4.47, 6.33, 10.19, 60.0])
    value, slope = jax.vmap(jax.value_and_grad(lambda u: law.coverage(Wind(u))))(speeds)
    assert bool(jnp.all(jnp.isfinite(value)))
    assert bool(jnp.all(jnp.isfinite(slope)))
    assert bool(jnp.all(value >= 0))
    log_value, log_slope = jax.vmap(jax.value_and_grad(lambda u: law.log(Wind(u))))(speeds[2:])
    assert bool(jnp.all(jnp.isfinite(log_slope)))
    np.testing.assert_allclose(jnp.exp(log_value), value[2:], rtol=1e-12)


@EACH
def test_logarithm_of_no_whitecaps_is_minus_infinity_with_a_finite_derivative(law):
    value, slope = jax.value_and_grad(lambda u: law.log(Wind(u)))(0.0)
    assert value == -jnp.inf or isinstance(law, laws.COARE36)
    assert bool(jnp.isfinite(slope))


@EACH
def test_wind_outside_the_range_warns_once_and_a_traced_wind_never(law):
    lower, upper = law.range
    with pytest.warns(laws.RangeWarning, match="outside the range") as caught:
        law(Wind(upper + 1.0))
    assert len(caught) == 1
    if lower > 0:
        with pytest.warns(laws.RangeWarning):
            law.log(Wind(0.5 * lower))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        law(Wind(lower))
        law(Wind(upper))
        law(Wind(float(np.float32(upper))))
        jax.jit(lambda u: law(Wind(u)))(upper + 1.0)
    assert bool(law.in_range(Wind(0.5 * (lower + upper))))
    assert not bool(law.in_range(Wind(upper + 1.0)))


@EACH
def test_precision_follows_the_wind_and_winds_can_be_batched(law):
    assert coverage(law, jnp.float64(10.0)).dtype == jnp.float64
    winds = eqx.filter_vmap(Wind)(jnp.asarray([8.0, 12.0]))
    batched = eqx.filter_vmap(law)(winds)
    np.testing.assert_allclose(batched, [law(Wind(8.0)), law(Wind(12.0))], rtol=1e-14)
    with jax.enable_x64(False):
        w = law(Wind(jnp.float32(10.0)))
        assert w.dtype == jnp.float32
    np.testing.assert_allclose(w, coverage(law, jnp.float64(10.0)), rtol=2e-6)


def test_constants_can_be_differentiated():
    def w(coefficient):
        return laws.Monahan1980(coefficient=coefficient)(Wind(10.0))

    assert float(jax.grad(w)(3.84e-6)) == pytest.approx(10**3.41)


def test_every_law_is_listed_once_with_its_source():
    assert len({type(law) for law in laws.ALL}) == len({law.name for law in laws.ALL}) == len(laws.ALL) == 12
    for law in laws.ALL:
        assert any(character.isdigit() for character in law.citation)
