"""What holds for every spectrum: moments, harmonics, batching, precision, the ends of the axis."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _seas import SEAS, WAVENUMBERS, directions, table

import jaxocean as jo
from jaxocean import spectra as sp

every_sea = pytest.mark.parametrize("name", SEAS)
K = WAVENUMBERS


def values(spectrum, k, phi):
    """Everything that a spectrum says at once."""
    height, slope = sp.significant_wave_height(spectrum), sp.mean_square_slope(spectrum)
    return spectrum.density(k, phi), spectrum.harmonics(k), height, slope


evaluate = eqx.filter_jit(values)
numerical_harmonics = eqx.filter_jit(sp.integrate_harmonics)
plane_density = eqx.filter_jit(lambda spectrum, kx, ky: spectrum(kx, ky))
variance = eqx.filter_jit(sp.height_variance)


@every_sea
def test_harmonics_are_integrals_over_direction(name):
    spectrum = SEAS[name]()
    k = jnp.asarray(K)
    _, harmonics, _, _ = evaluate(spectrum, k, directions(k))
    expected = numerical_harmonics(spectrum, k, directions=1024)
    energetic = np.asarray(expected.mean) > 1e-9 * np.max(expected.mean)
    # Kinks of tables, of |cos|ᵖ and of half-planes slow the trapezoidal rule down.
    for exact, numerical in zip(harmonics, expected, strict=True):
        error = np.abs(exact - numerical) / np.where(energetic, expected.mean, np.inf)
        assert np.max(error) < 3e-4


@every_sea
def test_the_variance_is_the_integral_over_the_plane(name):
    spectrum = SEAS[name]()
    _, _, height, slope = evaluate(spectrum, jnp.asarray(K), directions(jnp.asarray(K)))
    # A plain sum over a polar grid of Ψ itself.
    log_k = np.linspace(np.log(1e-3), np.log(400.0), 4001)
    k = np.exp(log_k)
    phi = np.arange(120) * (2 * np.pi / 120)
    kx, ky = jnp.asarray(k[:, None] * np.cos(phi)), jnp.asarray(k[:, None] * np.sin(phi))
    density = np.asarray(plane_density(spectrum, kx, ky)).mean(axis=1) * 2 * np.pi
    np.testing.assert_allclose(height**2 / 16, np.trapezoid(density * k**2, log_k), rtol=1e-3)
    np.testing.assert_allclose(slope, np.trapezoid(density * k**4, log_k), rtol=1e-3)


@every_sea
def test_nothing_is_infinite_or_negative_from_sixty_kilometres_to_half_a_millimetre(name):
    k = jnp.asarray(K)
    density, harmonics, _, _ = evaluate(SEAS[name](), k, directions(k))
    assert bool(jnp.all(jnp.isfinite(density)))
    assert bool(jnp.all(density >= 0))
    assert all(bool(jnp.all(jnp.isfinite(h))) for h in harmonics)


@every_sea
def test_float32_agrees_with_float64(name):
    k = jnp.asarray(K)
    density, harmonics, height, slope = evaluate(SEAS[name](), k, directions(k))
    with jax.enable_x64(False):
        k32 = jnp.asarray(K, jnp.float32)
        single, single_harmonics, single_height, single_slope = evaluate(SEAS[name](), k32, directions(k32))
    assert single.dtype == single_harmonics.mean.dtype == single_height.dtype == jnp.float32
    assert np.all(np.isfinite(single))
    assert all(np.all(np.isfinite(h)) for h in single_harmonics)
    np.testing.assert_allclose(single_height, height, rtol=1e-4)
    np.testing.assert_allclose(single_slope, slope, rtol=1e-3)
    inner = (K > 2e-2) & (K < 200)
    np.testing.assert_allclose(
        single_harmonics.mean[inner], harmonics.mean[inner], rtol=2e-3, atol=1e-9 * np.max(harmonics.mean)
    )
    bulk = inner & (np.abs(np.asarray(directions(k)) - 0.3) < 1.3)  # off the edges of half-planes
    np.testing.assert_allclose(single[bulk], density[bulk], rtol=5e-3, atol=1e-9 * np.max(density))


@every_sea
def test_gradients_are_finite_in_float32_even_at_the_mean_level(name):
    @eqx.filter_jit
    @eqx.filter_grad
    def gradient(arguments):
        spectrum, k, phi, point = arguments
        return jnp.sum(spectrum.density(k, phi)) + spectrum(point[0], point[1])

    with jax.enable_x64(False):
        k = jnp.asarray(K, jnp.float32)
        leaves = jax.tree.leaves(gradient((SEAS[name](), k, directions(k), jnp.zeros(2, jnp.float32))))
    assert len(leaves) > 5
    assert all(bool(jnp.all(jnp.isfinite(leaf))) for leaf in leaves)


def logarithms(spectrum):
    """Hs, mean-square slope and Ψ here and there, in one number that weighs them alike."""
    k = jnp.asarray([0.11, 0.35, 1.7, 9.0, 80.0])
    density = spectrum.density(k, jnp.asarray([0.24, 0.9, -0.4, 0.5, 0.0]))
    hs = sp.significant_wave_height(spectrum)
    return jnp.log(hs) + jnp.log(sp.mean_square_slope(spectrum)) + jnp.sum(jnp.log(density)) / 7


@every_sea
def test_every_leaf_has_the_derivative_that_finite_differences_show(name):
    leaves, structure = jax.tree.flatten(SEAS[name]())
    sizes = np.cumsum([leaf.size for leaf in leaves])[:-1]

    @jax.jit
    def function(x):
        parts = zip(jnp.split(x, sizes), leaves, strict=True)
        return logarithms(jax.tree.unflatten(structure, [part.reshape(leaf.shape) for part, leaf in parts]))

    x = np.concatenate([np.ravel(leaf) for leaf in leaves])
    gradient = np.asarray(jax.grad(function)(x))
    _, along = jax.jvp(function, (x,), (np.ones_like(x),))
    np.testing.assert_allclose(along, gradient.sum(), rtol=1e-9)
    chosen = range(x.size) if x.size < 40 else [0, 5, 53, 77, 101, x.size - 3, x.size - 1]
    for i in chosen:
        h = 1e-4 * max(1.0, abs(x[i])) if x[i] == 0 or abs(x[i]) > 1e-3 else 1e-3 * abs(x[i])
        step = np.zeros_like(x)
        step[i] = h
        near = (function(x + step) - function(x - step)) / (2 * h)
        far = (function(x + 2 * step) - function(x - 2 * step)) / (4 * h)
        np.testing.assert_allclose(gradient[i], (4 * near - far) / 3, rtol=1e-6, atol=2e-9)


@every_sea
def test_the_mean_level_has_no_waves(name):
    assert float(plane_density(SEAS[name](), jnp.zeros(()), jnp.zeros(()))) == 0.0


@every_sea
def test_spectra_are_batched_with_vmap(name):
    k = jnp.asarray(K)
    arrays, rest = eqx.partition(SEAS[name](), eqx.is_array)
    changed = jax.tree.map(lambda leaf: leaf * 1.01, arrays)
    both = jax.tree.map(lambda *pair: jnp.stack(pair), arrays, changed)
    batched = jax.jit(jax.vmap(lambda one: values(eqx.combine(one, rest), k, directions(k))))(both)
    for i, one in enumerate((arrays, changed)):
        single = evaluate(eqx.combine(one, rest), k, directions(k))
        for a, b in zip(jax.tree.leaves(batched), jax.tree.leaves(single), strict=True):
            np.testing.assert_allclose(a[i], b, rtol=1e-9, atol=1e-13 * np.max(np.abs(b)))


def test_sums_add_variances_and_factors_scale_them():
    first, second = SEAS["Elfouhaily"](), table()
    total = first + 0.25 * second
    kx, ky = jnp.asarray([0.1, -0.7]), jnp.asarray([0.02, 0.4])
    parts = plane_density(first, kx, ky) + 0.25 * plane_density(second, kx, ky)
    np.testing.assert_allclose(plane_density(total, kx, ky), parts)
    np.testing.assert_allclose(variance(total), variance(first) + 0.25 * variance(second), rtol=1e-6)
    np.testing.assert_allclose(variance(4.0 * first), 4 * variance(first), rtol=1e-12)
    assert total.kinks().size == second.kinks().size
    with pytest.raises(TypeError):
        first + 1.0
    with pytest.raises(TypeError):
        first * second
    with pytest.raises(ValueError, match="`factor` must be at least 0, but is -1"):
        -1.0 * first


def test_slope_variances_add_up_to_the_mean_square_slope():
    slopes = eqx.filter_jit(sp.slope_variance)
    sea = lambda direction: sp.JONSWAP(significant_wave_height=2.0, peak_period=8.0, direction=direction)
    x, y, xy = slopes(sea(0.3))
    np.testing.assert_allclose(x + y, sp.mean_square_slope(sea(0.3)), rtol=1e-12)
    # In the axes of the sea the two are uncorrelated and the upwind one is larger.
    upwind, crosswind, none = slopes(sea(0.0))
    assert float(upwind) > float(crosswind)
    np.testing.assert_allclose(none, 0.0, atol=1e-18)
    c, s = np.cos(0.3), np.sin(0.3)
    np.testing.assert_allclose(x, c * c * upwind + s * s * crosswind, rtol=1e-10)
    np.testing.assert_allclose(xy, c * s * (upwind - crosswind), rtol=1e-10)


def test_bands_share_the_variance_without_gaps():
    spectrum = SEAS["Elfouhaily"]()
    parts = [variance(spectrum, band=band) for band in ((1e-3, 0.1), (0.1, 2.0), (2.0, 400.0))]
    np.testing.assert_allclose(sum(map(float, parts)), variance(spectrum), rtol=1e-9)


@pytest.mark.parametrize("band", [(0.0, 1.0), (2.0, 1.0), (1.0, float("inf")), (float("nan"), 1.0)])
def test_a_band_that_is_none_is_refused(band):
    with pytest.raises(ValueError, match="`band` must be"):
        sp.significant_wave_height(SEAS["Elfouhaily"](), band=band)


@pytest.mark.parametrize("name", ["Elfouhaily", "JONSWAP, sech² spreading, 20 m deep, capillary", "measured"])
def test_the_frequency_spectrum_holds_the_same_variance(name):
    spectrum = SEAS[name]()
    log_f = np.linspace(np.log(0.02), np.log(8.0), 6001)
    energy = eqx.filter_jit(sp.frequency_spectrum)(spectrum, jnp.asarray(np.exp(log_f)))
    hs = 4 * np.sqrt(np.trapezoid(np.asarray(energy) * np.exp(log_f), log_f))
    np.testing.assert_allclose(hs, 4 * np.sqrt(variance(spectrum)), rtol=1e-3)


peak_period = eqx.filter_jit(sp.peak_period)


def test_the_peak_period_of_a_sum_is_that_of_its_highest_peak():
    swell = sp.JONSWAP(significant_wave_height=2.0, peak_period=14.0)
    wind_sea = sp.JONSWAP(significant_wave_height=1.0, peak_period=5.0)
    np.testing.assert_allclose(peak_period(1.0 * swell + wind_sea), 14.0, rtol=1e-3)
    np.testing.assert_allclose(peak_period(0.01 * swell + wind_sea), 5.0, rtol=1e-3)


def test_the_peak_period_moves_with_the_wind():
    # T_p ∝ U_19.5 for a fully developed sea.
    sea = lambda u: sp.PiersonMoskowitz.from_wind(jo.Wind(u))
    value, change = jax.jit(jax.value_and_grad(lambda u: sp.peak_period(sea(u))))(10.0)
    exact, exact_change = jax.value_and_grad(lambda u: sea(u).peak_period)(10.0)
    np.testing.assert_allclose(value, exact, rtol=1e-6)
    np.testing.assert_allclose(change, exact_change, rtol=1e-3)


def test_a_range_of_frequencies_that_is_none_is_refused():
    with pytest.raises(ValueError, match="`frequencies` must be"):
        sp.peak_period(SEAS["Elfouhaily"](), frequencies=(1.0, 0.1))
