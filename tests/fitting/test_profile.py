"""Profile likelihoods against parabolas, Student's likelihood, and regions that are open or in pieces."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import SPEEDS, PowerSea, WavySea
from jaxtyping import Array, Float
from scipy import stats

import fitting
from jaxocean._numerics import as_leaf

NOISE = 0.3 * np.random.default_rng(3).normal(size=SPEEDS.size)
DATA = 3e-5 * SPEEDS**2.4 * 10**NOISE
FREE = [lambda m: m.coefficient, lambda m: m.exponent]


@pytest.fixture(scope="module")
def straight():
    """A model that is linear in its exponent and in the logarithm of its coefficient."""
    target = fitting.CoveragePoints(SPEEDS, DATA, 0.3)
    return {
        name: fitting.profile(PowerSea(), FREE, target, parameter=name)
        for name in ("coefficient", "exponent")
    }


def test_profile_of_a_linear_model_is_the_parabola_of_its_standard_error(straight):
    found = straight["exponent"]
    pull = (found.grid - found.fit.values["exponent"]) / found.fit.errors["exponent"]
    np.testing.assert_allclose(found.excess, pull**2, atol=1e-5)
    np.testing.assert_allclose(found.signed_root, pull, atol=1e-2)
    assert pull[0] == pytest.approx(-4)
    for level in (0.5, 0.9, 0.99):
        interval = found.interval(level)
        half = stats.norm.ppf(0.5 * (1 + level)) * found.fit.errors["exponent"]
        assert interval.lower == pytest.approx(found.fit.values["exponent"] - half, abs=1e-4 * half)
        assert interval.upper == pytest.approx(found.fit.values["exponent"] + half, abs=1e-4 * half)
        assert not interval.lower_is_open
        assert not interval.upper_is_open
        assert found.best in interval


def test_profile_follows_the_curve_that_the_standard_error_does_not_know(straight):
    # Gaussian in the logarithm of the coefficient: the interval of the coefficient itself is lopsided.
    found = straight["coefficient"]
    interval = found.interval(0.9)
    best, error = found.fit.values["coefficient"], found.fit.errors["coefficient"]
    factor = np.exp(stats.norm.ppf(0.95) * error / best)
    assert interval.upper == pytest.approx(best * factor, rel=0.01)
    assert interval.lower == pytest.approx(best / factor, rel=0.02)


def test_the_other_numbers_do_their_best_at_every_value(straight):
    found = straight["exponent"]
    # Given the exponent, the best log coefficient is the mean of the rest.
    expected = np.exp(np.mean(np.log(DATA) - found.grid[:, None] * np.log(SPEEDS), axis=1))
    np.testing.assert_allclose(found.values[:, 0], expected, rtol=1e-5)
    np.testing.assert_allclose(found.values[:, 1], found.grid, rtol=1e-12)


def test_with_an_unknown_scatter_the_profile_is_students_likelihood():
    target = fitting.CoveragePoints(SPEEDS, DATA, fitting.FreeScatter(0.5))
    found = fitting.profile(PowerSea(), FREE, target, parameter="exponent", grid=np.linspace(1.0, 4.0, 13))
    rest = np.log10(DATA)[None] - found.grid[:, None] * np.log10(SPEEDS)
    squares = np.sum((rest - rest.mean(axis=1, keepdims=True)) ** 2, axis=1)
    x, y = np.log10(SPEEDS), np.log10(DATA)
    least = np.sum((y - np.polyval(np.polyfit(x, y, 1), x)) ** 2)
    np.testing.assert_allclose(found.excess, SPEEDS.size * np.log(squares / least), rtol=1e-4, atol=1e-4)


def test_a_single_free_number_has_a_profile_too():
    target = fitting.CoveragePoints(SPEEDS, DATA, 0.3)
    found = fitting.profile(PowerSea(), lambda m: m.exponent, target, parameter="exponent", grid=[1.0, 2.5])
    assert found.grid.size == 3
    predicted = np.log10(1e-5) + found.grid[:, None] * np.log10(SPEEDS)
    cost = np.sum(((predicted - np.log10(DATA)) / 0.3) ** 2, axis=1)
    np.testing.assert_allclose(found.excess, cost - cost.min(), rtol=1e-6, atol=1e-6)


class Saturating(eqx.Module):
    """A coverage that no longer changes where the rate is large."""

    rate: Float[Array, ""] = eqx.field(converter=as_leaf, default=1.0)

    def log_coverage(self, wind):
        return -6 - jnp.exp(-self.rate)


def test_an_end_that_the_data_do_not_give_is_reported_as_open():
    target = fitting.CoveragePoints([8.0], [np.exp(-6 - np.exp(-2.0))], 0.3)
    found = fitting.profile(
        Saturating(), lambda m: m.rate, target, parameter="rate", grid=np.linspace(-2.0, 12.0, 57)
    )
    interval = found.interval(0.9)
    # −6 − e^{−r} lies 1.645 scatters below the datum at the lower end, and nowhere above.
    lower = -np.log(np.exp(-2.0) + stats.norm.ppf(0.95) * 0.3 * np.log(10))
    assert interval.lower == pytest.approx(lower, abs=0.02)
    assert interval.upper_is_open
    assert not interval.lower_is_open
    assert interval.upper == 12.0
    assert 100.0 in interval
    assert -1.0 not in interval
    assert "no upper end up to 12" in interval.words("rate")
    assert found.as_dict(0.9)["upper"] is None


def test_a_grid_that_ends_inside_the_region_has_open_ends(straight):
    target = fitting.CoveragePoints(SPEEDS, DATA, 0.3)
    best, error = (getattr(straight["exponent"].fit, what)["exponent"] for what in ("values", "errors"))
    found = fitting.profile(
        PowerSea(), FREE, target, parameter="exponent", grid=best + error * np.linspace(-1.0, 4.0, 40)
    )
    interval = found.interval(0.9)
    assert interval.lower_is_open
    assert not interval.upper_is_open
    assert f"exponent < {interval.upper:.4g}; no lower end down to" in interval.words("exponent")


class Endless(eqx.Module):
    """The larger the distance the better, for ever: no fit settles."""

    slope: Float[Array, ""] = eqx.field(converter=as_leaf, default=0.3)
    distance: Float[Array, ""] = eqx.field(converter=as_leaf, default=0.0)

    def log_coverage(self, wind):
        return -6 + jnp.exp(-self.distance) + self.slope * (wind.speed - 10)


def test_where_no_fit_settles_a_given_grid_still_shows_the_ridge():
    target = fitting.CoveragePoints([8.0, 12.0], [np.exp(-6), np.exp(-6)], 0.3)
    free = [lambda m: m.slope, lambda m: m.distance]
    with pytest.raises(fitting.FitError):
        fitting.profile(Endless(), free, target, parameter="distance")
    found = fitting.profile(Endless(), free, target, parameter="distance", grid=np.linspace(-1.0, 6.0, 57))
    assert found.fit is None
    assert "no fit to compare with" in found.warnings[0]
    cost = 2 * (np.exp(-found.grid) / (0.3 * np.log(10))) ** 2
    np.testing.assert_allclose(found.excess, cost - cost[-1], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.values[:, 0], 0.0, atol=1e-6)
    interval = found.interval(0.9)
    assert interval.upper_is_open
    assert interval.lower == pytest.approx(-np.log(0.3 * np.log(10) * 1.645 / np.sqrt(2)), abs=0.05)


def test_another_valley_is_seen_and_said():
    target = fitting.CoveragePoints(SPEEDS, np.exp(-6 + np.sin(0.8 * SPEEDS)), 0.5)
    free = fitting.Parameter(lambda m: m.rate, bounds=fitting.Interval(0.0, 1.5))
    stuck = fitting.profile(WavySea(0.1), free, target, parameter="rate", grid=np.linspace(0.01, 1.49, 149))
    assert stuck.best == pytest.approx(0.8, abs=0.01)
    assert "more than one valley" in stuck.warnings[0]
    # A level that the wrong valleys reach too.
    interval = stuck.interval(0.99)
    assert interval.pieces > 1
    assert "pieces" in interval.words("rate")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            {"parameter": "threshold"},
            "`parameter` must be one of `coefficient`, `exponent`, but is 'threshold'",
        ),
        ({"parameter": "exponent", "grid": [2.0]}, "`grid` must hold at least two different values"),
        ({"parameter": "exponent", "points": 4}, "`points` must be at least 5, but is 4"),
        ({"parameter": "coefficient", "grid": [-1.0, 1.0]}, "`coefficient` that are greater than 0"),
    ],
)
def test_senseless_requests_are_refused(options, sentence):
    target = fitting.CoveragePoints(SPEEDS, DATA, 0.3)
    with pytest.raises(ValueError, match=sentence):
        fitting.profile(PowerSea(), FREE, target, **options)


def test_a_level_in_percent_is_refused(straight):
    with pytest.raises(ValueError, match="`level` must lie between 0 and 1"):
        straight["exponent"].interval(90.0)
