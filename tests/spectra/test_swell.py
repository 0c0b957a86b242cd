"""Swell, and the split of three bulk numbers into wind sea and swell, against wavespectra and SciPy."""

import warnings

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches
from scipy import integrate, optimize

import jaxocean as jo
from jaxocean import spectra as sp

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import wavespectra  # noqa: F401 (registers the accessor `spec`)
    from wavespectra.construct import frequency as oracle

height = eqx.filter_jit(sp.significant_wave_height)
mean_square_slope = eqx.filter_jit(sp.mean_square_slope)


@pytest.mark.parametrize(("hs", "tp", "width"), [(2.0, 12.0, 0.1), (0.5, 18.0, 0.03), (3.0, 7.0, 0.25)])
def test_swell_is_the_gaussian_spectrum_of_wavespectra(hs, tp, width):
    f = np.linspace(1e-3, 0.5, 4000)
    swell = sp.Swell(significant_wave_height=hs, peak_period=tp, width=width)
    expected = oracle.gaussian(f, hs=hs, fp=1 / tp, gw=width / tp)
    found = eqx.filter_jit(sp.frequency_spectrum)(swell, jnp.asarray(f))
    np.testing.assert_allclose(found, expected.values, rtol=2e-3, atol=1e-9)
    np.testing.assert_allclose(height(swell), hs, rtol=1e-3)


@pytest.mark.parametrize("width", [0.01, 0.1, 0.3])
def test_the_quadrature_resolves_the_narrow_band(width):
    swell = sp.Swell(significant_wave_height=2.0, peak_period=10.0, width=width)

    def slope(x):  # x = f/f_p; k² E(f) df in deep water, by SciPy
        return ((0.2 * np.pi * x) ** 2 / 9.80665) ** 2 * np.exp(-0.5 * ((x - 1) / width) ** 2)

    ends = max(1e-3, 1 - 8 * width), 1 + 8 * width
    expected = 0.25 * integrate.quad(slope, *ends, points=[1.0])[0] / (width * np.sqrt(2 * np.pi))
    np.testing.assert_allclose(mean_square_slope(swell), expected, rtol=1e-3)


def test_swell_beside_a_wind_sea_does_not_spoil_its_quadrature():
    wind_sea = sp.Elfouhaily(jo.Wind(10.0))
    both = wind_sea + sp.Swell(significant_wave_height=0.0, peak_period=12.0)
    np.testing.assert_allclose(mean_square_slope(both), mean_square_slope(wind_sea), rtol=1e-4)


def test_swell_has_no_tail_that_would_break():
    # A JONSWAP sea of the same height and period has short waves; swell has lost them on its way.
    hs, tp, short = 2.0, 10.0, (1.0, 400.0)
    swell = sp.Swell(significant_wave_height=hs, peak_period=tp)
    jonswap = sp.JONSWAP(significant_wave_height=hs, peak_period=tp, peak_enhancement=10.0)
    assert float(mean_square_slope(swell, band=short)) < 1e-12
    assert float(mean_square_slope(jonswap, band=short)) > 1e-4


def test_swell_travels_where_it_is_told_in_any_depth():
    for depth in (None, 15.0):
        relation = sp.Dispersion(depth)
        swell = sp.Swell(significant_wave_height=1.0, peak_period=11.0, direction=2.0, dispersion=relation)
        k = relation.wavenumber(jnp.asarray(2 * np.pi / 11))
        phi = jnp.linspace(-np.pi, np.pi, 721)
        density = swell.density(jnp.full(721, k), phi)
        np.testing.assert_allclose(phi[jnp.argmax(density)], 2.0, atol=0.01)
        np.testing.assert_allclose(height(swell), 1.0, rtol=1e-5)


def test_derivatives_of_swell():
    def slope(x):
        swell = sp.Swell(significant_wave_height=x[0], peak_period=x[1], width=x[2], direction=x[3])
        return swell(jnp.asarray(0.03), jnp.asarray(0.01))

    assert_gradient_matches(slope, [[2.0, 11.0, 0.1, 0.4]], rtol=1e-5)
    calm = jax.grad(
        lambda h: sp.significant_wave_height(sp.Swell(significant_wave_height=h, peak_period=9.0))
    )
    assert np.isfinite(calm(0.0))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"significant_wave_height": -1.0, "peak_period": 9.0}, "significant_wave_height.*at least 0"),
        ({"significant_wave_height": 1.0, "peak_period": 0.0}, "peak_period.*greater than 0"),
        ({"significant_wave_height": 1.0, "peak_period": 9.0, "width": 1e-3}, "width.*at least 0.01"),
    ],
)
def test_swell_refuses_what_is_no_swell(arguments, says):
    with pytest.raises(ValueError, match=says):
        sp.Swell(**arguments)


@eqx.filter_jit
@jax.vmap
def split(speed, hs, peak_speed):
    """Ω, whether it was raised, Hs of the swell, Hs of both."""
    parts = sp.wind_sea_and_swell(jo.Wind(speed), significant_wave_height=hs, peak_speed=peak_speed)
    total = sp.significant_wave_height(parts.spectrum())
    return parts.inverse_wave_age, parts.younger, parts.swell.significant_wave_height, total


@pytest.fixture(scope="module")
def seas():
    """Three known seas and 400 of any kind: what was measured, and its parts."""
    rng = np.random.default_rng(3)
    speed = np.append([10.0, 10.0, 12.0], rng.uniform(0.5, 20, 400))
    hs = np.append([3.5, 2.0, 2.0], 10 ** rng.uniform(-1.5, 1, 400))
    peak_speed = np.append([16.0, 6.0, 16.0], rng.uniform(2, 25, 400))
    return hs, *map(np.asarray, split(speed, hs, peak_speed))


def test_wind_sea_and_swell_have_the_height_that_was_measured(seas):
    hs, omega, younger, swell, total = seas
    np.testing.assert_allclose(total, hs, rtol=2e-4)
    assert 50 < np.sum(younger) < 350  # both kinds are among them
    assert (omega >= 0.84).all()
    assert (omega <= 5.0 + 1e-9).all()
    assert (swell[younger] == 0).all()


def test_a_developed_wind_sea_leaves_the_rest_to_swell(seas):
    _, omega, younger, swell, _ = seas
    # Hs of the developed sea at 10 m/s is 2.606 m (SciPy).
    np.testing.assert_allclose(swell[0], np.sqrt(3.5**2 - 2.606**2), rtol=1e-3)
    np.testing.assert_allclose(omega[0], 0.84)
    assert not younger[0]


def test_slow_peaks_make_a_young_wind_sea(seas):
    _, omega, younger, _, _ = seas
    np.testing.assert_allclose(omega[1], 10 / 6)
    assert not younger[1]


def test_a_wind_sea_that_would_be_too_high_is_younger(seas):
    def too_high(omega):
        return float(height(sp.Elfouhaily(jo.Wind(12.0), omega))) - 2.0

    _, omega, younger, _, _ = seas
    np.testing.assert_allclose(omega[2], optimize.brentq(too_high, 0.84, 5.0, xtol=1e-10), rtol=1e-7)
    assert younger[2]


def test_the_parts_are_differentiable_in_all_that_was_measured():
    def slope(x):
        parts = sp.wind_sea_and_swell(jo.Wind(x[0]), significant_wave_height=x[1], peak_speed=16.0)
        return sp.mean_square_slope(parts.wind_sea) + 0.01 * parts.swell.significant_wave_height

    # With swell, and too young for it.
    assert_gradient_matches(slope, [[8.0, 3.0], [12.0, 2.0]], rtol=1e-5)
    assert np.isfinite(jax.jit(jax.grad(slope))(jnp.asarray([0.0, 1.0]))).all()


def test_bulk_numbers_that_fit_no_sea_are_refused():
    with pytest.raises(ValueError, match="`wind` must have no fetch"):
        sp.wind_sea_and_swell(jo.Wind(8.0, fetch=1e5), significant_wave_height=1.0, peak_speed=9.0)
    with pytest.raises(ValueError, match=r"`peak_speed` must be greater than 0 m/s, but is -1"):
        sp.wind_sea_and_swell(jo.Wind(8.0), significant_wave_height=1.0, peak_speed=-1.0)
