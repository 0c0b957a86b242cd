"""Parametric spectra against wavespectra, the literature's relations and each other."""

import warnings

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import integrate

import jaxocean as jo
from jaxocean import spectra as sp

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import wavespectra  # noqa: F401 (registers the accessor `spec`)
    from wavespectra.construct import frequency as oracle

F = np.geomspace(0.02, 3.0, 2000)
height = eqx.filter_jit(sp.significant_wave_height)
peak_period = eqx.filter_jit(sp.peak_period)
frequency_spectrum = eqx.filter_jit(sp.frequency_spectrum)


def assert_same_sea(spectrum, expected, *, rtol=5e-3):
    """Hs and T_p of E(f) and of Ψ against a frequency spectrum of wavespectra on the grid F."""
    hs = float(4 * np.sqrt(np.trapezoid(expected.values, F)))
    tp = 1 / F[np.argmax(expected.values)]
    energy = np.asarray(frequency_spectrum(spectrum, jnp.asarray(F)))
    np.testing.assert_allclose(4 * np.sqrt(np.trapezoid(energy, F)), hs, rtol=rtol)
    np.testing.assert_allclose(height(spectrum, band=(1e-3, 50.0)), hs, rtol=rtol)
    np.testing.assert_allclose(peak_period(spectrum), tp, rtol=rtol)
    energetic = expected.values > 1e-3 * expected.values.max()
    # The two differ in g (9.81 and 9.80665) and in how they normalise.
    np.testing.assert_allclose(energy[energetic], expected.values[energetic], rtol=1e-2)


@pytest.mark.parametrize(("hs", "tp"), [(1.0, 4.0), (3.0, 9.0), (8.0, 14.0)])
def test_pierson_moskowitz_agrees_with_wavespectra(hs, tp):
    spectrum = sp.PiersonMoskowitz(significant_wave_height=hs, peak_period=tp)
    assert_same_sea(spectrum, oracle.pierson_moskowitz(F, fp=1 / tp, hs=hs))


def test_pierson_moskowitz_with_its_own_alpha_agrees_with_wavespectra():
    spectrum = sp.PiersonMoskowitz.from_alpha(peak_period=9.0)
    assert_same_sea(spectrum, oracle.pierson_moskowitz(F, fp=1 / 9.0))
    np.testing.assert_allclose(spectrum.alpha(), 0.0081, rtol=1e-12)


@pytest.mark.parametrize(("hs", "tp", "gamma"), [(1.0, 4.0, 1.0), (3.0, 9.0, 3.3), (8.0, 14.0, 7.0)])
def test_jonswap_agrees_with_wavespectra(hs, tp, gamma):
    spectrum = sp.JONSWAP(significant_wave_height=hs, peak_period=tp, peak_enhancement=gamma)
    assert_same_sea(spectrum, oracle.jonswap(F, fp=1 / tp, gamma=gamma, hs=hs))


def test_jonswap_with_a_given_alpha_agrees_with_wavespectra():
    spectrum = sp.JONSWAP.from_alpha(alpha=0.012, peak_period=7.0)
    assert_same_sea(spectrum, oracle.jonswap(F, fp=1 / 7.0, alpha=0.012))
    np.testing.assert_allclose(spectrum.alpha(), 0.012, rtol=1e-12)


@pytest.mark.parametrize(("tp", "depth"), [(9.0, 8.0), (9.0, 25.0), (5.0, 60.0)])
def test_tma_agrees_with_wavespectra(tp, depth):
    spectrum = sp.TMA(significant_wave_height=2.5, peak_period=tp, dispersion=sp.Dispersion(depth))
    with np.errstate(over="ignore"):  # its sinh, in deep water
        expected = oracle.tma(F, fp=1 / tp, dep=depth, hs=2.5)
    assert_same_sea(spectrum, expected)


def test_jonswap_in_finite_depth_keeps_its_height_and_period():
    spectrum = sp.JONSWAP(significant_wave_height=2.0, peak_period=10.0, dispersion=sp.Dispersion(6.0))
    assert_same_sea(spectrum, oracle.jonswap(F, fp=0.1, hs=2.0))
    assert float(spectrum.peak_wavenumber()) > 1.2 * (2 * np.pi / 10) ** 2 / 9.81


def test_in_deep_water_tma_is_jonswap():
    k = jnp.asarray(np.geomspace(0.02, 20.0, 50))
    arguments = {"significant_wave_height": 2.0, "peak_period": 6.0, "dispersion": sp.Dispersion(3000.0)}
    a, b = (kind(**arguments).harmonics(k).mean for kind in (sp.TMA, sp.JONSWAP))
    np.testing.assert_allclose(a, b, rtol=1e-5)


def test_in_shallow_water_tma_has_the_cubic_tail():
    # φ → (ωd)²/(2gd): the f⁻⁵ range becomes f⁻³.
    spectrum = sp.TMA(significant_wave_height=1.0, peak_period=40.0, dispersion=sp.Dispersion(0.5))
    f = jnp.asarray([0.1, 0.2])
    low, high = frequency_spectrum(spectrum, f)
    np.testing.assert_allclose(np.log(high / low) / np.log(2), -3, atol=0.15)


@pytest.mark.parametrize("gamma", [1.0, 2.2, 3.3, 7.0, 20.0])
def test_the_height_of_jonswap_is_right_whatever_the_enhancement(gamma):
    spectrum = sp.JONSWAP(significant_wave_height=2.0, peak_period=8.0, peak_enhancement=gamma)

    def energy(f):
        return float(spectrum.energy(jnp.asarray(f), jnp.asarray(0.0)))

    pieces = [(0.03, 0.09), (0.09, 0.125), (0.125, 0.2), (0.2, 20.0)]
    m0 = sum(integrate.quad(energy, a, b, epsrel=1e-8, limit=200)[0] for a, b in pieces)
    np.testing.assert_allclose(4 * np.sqrt(m0), 2.0, rtol=1e-6)


def test_jonswap_without_enhancement_is_pierson_moskowitz():
    k = jnp.asarray(np.geomspace(1e-3, 1e3, 200))
    arguments = {"alpha": 0.0081, "peak_period": 8.0, "direction": 0.3}
    jonswap = sp.JONSWAP.from_alpha(peak_enhancement=1.0, **arguments)
    pierson_moskowitz = sp.PiersonMoskowitz.from_alpha(**arguments)
    phi = jnp.linspace(-3, 3, 200)
    np.testing.assert_allclose(jonswap.density(k, phi), pierson_moskowitz.density(k, phi), rtol=4e-15)


def test_jonswap_grows_with_fetch_as_hasselmann_found():
    wind = jo.Wind(12.0, 0.5)
    spectrum = sp.JONSWAP.from_fetch(wind, fetch=8e4)
    x = 9.81 * 8e4 / 144
    np.testing.assert_allclose(spectrum.alpha(), 0.076 * x**-0.22, rtol=1e-12)
    np.testing.assert_allclose(1 / spectrum.peak_period, 3.5 * 9.81 / 12 * x**-0.33, rtol=1e-12)
    np.testing.assert_allclose(spectrum.direction, 0.5)
    assert_same_sea(spectrum, oracle.jonswap(F, fp=3.5 * 9.81 / 12 * x**-0.33, alpha=0.076 * x**-0.22))
    own = sp.JONSWAP.from_fetch(jo.Wind(12.0, 0.5, fetch=8e4))
    assert float(own.significant_wave_height) == float(spectrum.significant_wave_height)


@pytest.mark.parametrize(
    ("wind_fetch", "fetch", "given"), [(None, None, "neither is"), (1e4, 1e4, "both are")]
)
def test_jonswap_wants_exactly_one_fetch(wind_fetch, fetch, given):
    with pytest.raises(ValueError, match=f"exactly one of `fetch` and the wind's own `fetch`, but {given}"):
        sp.JONSWAP.from_fetch(jo.Wind(10.0, fetch=wind_fetch), fetch=fetch)


def test_pierson_moskowitz_of_a_wind_has_the_published_height_and_period():
    wind = jo.Wind(15.0)
    speed = float(wind.at_height(19.5))
    spectrum = sp.PiersonMoskowitz.from_wind(wind)
    # Hs = 2 √(α/0.74) U²/g and ω_p = 0.877 g/U.
    np.testing.assert_allclose(
        spectrum.significant_wave_height, 2 * np.sqrt(0.0081 / 0.74) * speed**2 / 9.81, rtol=1e-12
    )
    np.testing.assert_allclose(2 * np.pi / spectrum.peak_period, 0.877 * 9.81 / speed, rtol=1e-3)
    assert 1.05 < speed / 15.0 < 1.08


@pytest.mark.parametrize(
    "make",
    [
        sp.PiersonMoskowitz.from_wind,
        lambda wind: sp.JONSWAP.from_fetch(wind, fetch=1e5),
        lambda wind: sp.Phillips(wind, 0.01),
    ],
)
@pytest.mark.parametrize("x64", [True, False])
def test_without_wind_the_sea_is_flat_and_differentiable(make, x64):
    with jax.enable_x64(x64):
        function = lambda u: (
            sp.significant_wave_height(make(jo.Wind(u))) + sp.mean_square_slope(make(jo.Wind(u)))
        )
        values, slopes = jax.jit(jax.vmap(jax.value_and_grad(function)))(jnp.asarray([0.0, 1e-6, 1e-2, 1.0]))
        assert float(values[0]) == 0.0
        assert bool(jnp.all(jnp.isfinite(values)))
        assert bool(jnp.all(jnp.isfinite(slopes)))


def test_tessendorfs_amplitude_gives_his_sea_on_his_grid():
    # His synthesis written out: h̃0 = (ξr + iξi)/√2 √P, η = Σ (h̃0(k) + h̃0*(−k)) e^{ik·x}; Var η = 2 Σ P.
    size, count, amplitude, speed = 1000.0, 256, 6e-7, 30.0
    n = np.arange(-count // 2, count // 2) * (2 * np.pi / size)
    kx, ky = np.meshgrid(n, n)
    k2 = kx**2 + ky**2
    k2[count // 2, count // 2] = np.inf
    longest = speed**2 / 9.81
    p = amplitude * np.exp(-1 / (k2 * longest**2)) / k2**2 * ((kx + ky) / np.sqrt(2)) ** 2 / k2
    sea = sp.Phillips.from_tessendorf(jo.Wind(speed, np.pi / 4), amplitude=amplitude, size=size)
    ours = np.array(jax.jit(lambda s, x, y: s(x, y))(sea, jnp.asarray(kx), jnp.asarray(ky)))
    np.testing.assert_allclose(ours * (2 * np.pi / size) ** 2 / 2, p, rtol=1e-10, atol=1e-11 * p.max())
    np.testing.assert_allclose(np.sum(ours) * (2 * np.pi / size) ** 2, 2 * np.sum(p), rtol=1e-10)
    np.testing.assert_allclose(
        height(sea) ** 2 / 16, 0.5 * np.pi * float(sea.amplitude) * longest**2, rtol=1e-4
    )


def test_phillips_options_take_energy_where_they_say():
    wind = jo.Wind(10.0, 0.4)
    k, phi = jnp.asarray([0.3, 0.3, 30.0]), jnp.asarray([0.4, 0.4 + np.pi, 0.4])
    plain = sp.Phillips(wind, 0.01).density(k, phi)
    np.testing.assert_allclose(plain[0], plain[1])
    np.testing.assert_allclose(
        sp.Phillips(wind, 0.01, opposing=0.1).density(k, phi), plain * jnp.asarray([1.0, 0.1, 1.0])
    )
    short = sp.Phillips(wind, 0.01, smallest_wave=0.1).density(k, phi)
    np.testing.assert_allclose(short / plain, np.exp(-((np.asarray(k) * 0.1) ** 2)), rtol=1e-12)
    sideways = jnp.full(3, 1.4)
    np.testing.assert_allclose(
        sp.Phillips(wind, 0.01, exponent=6.0).density(k, sideways),
        sp.Phillips(wind, 0.01).density(k, sideways) * np.cos(1.0) ** 4,
        rtol=1e-12,
    )


def test_the_peak_of_phillips_spectrum_is_where_it_says():
    sea = sp.Phillips(jo.Wind(12.0), 0.01)
    k = np.geomspace(0.01, 1.0, 20001)
    energy = np.asarray(sea.harmonics(jnp.asarray(k)).mean)
    np.testing.assert_allclose(k[np.argmax(energy)], sea.peak_wavenumber(), rtol=1e-3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: sp.JONSWAP(significant_wave_height=-1.0, peak_period=8.0),
            "`significant_wave_height` must be at",
        ),
        (
            lambda: sp.JONSWAP(significant_wave_height=1.0, peak_period=0.0),
            "`peak_period` must be greater than 0 s",
        ),
        (
            lambda: sp.JONSWAP(significant_wave_height=1.0, peak_period=8.0, peak_enhancement=0.0),
            "`peak_enhancement` must be greater than 0",
        ),
        (
            lambda: sp.PiersonMoskowitz(significant_wave_height=float("nan"), peak_period=8.0),
            "`significant_wave_height` must be finite",
        ),
        (lambda: sp.PiersonMoskowitz.from_alpha(alpha=-1.0, peak_period=8.0), "`alpha` must be at least 0"),
        (
            lambda: sp.TMA(significant_wave_height=1.0, peak_period=8.0, dispersion=sp.Dispersion()),
            "`dispersion` must have a depth for TMA",
        ),
        (lambda: sp.Phillips(jo.Wind(10.0), -0.1), "`amplitude` must be at least 0"),
        (lambda: sp.Phillips(jo.Wind(10.0), 0.1, opposing=2.0), "`opposing` must be at most 1"),
        (
            lambda: sp.Phillips.from_tessendorf(jo.Wind(10.0), amplitude=1e-6, size=0.0),
            "`size` must be greater than 0 m",
        ),
    ],
)
def test_impossible_seas_are_refused_in_one_sentence(make, message):
    with pytest.raises(ValueError, match=message):
        make()
