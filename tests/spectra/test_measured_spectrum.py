"""A tabulated spectrum: energy kept exactly, directions kept exactly, and the tail above the cut-off."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _seas import table

import jaxocean as jo
from jaxocean import spectra as sp

height = eqx.filter_jit(sp.significant_wave_height)
variance = eqx.filter_jit(sp.height_variance)
slope = eqx.filter_jit(sp.mean_square_slope)
density = eqx.filter_jit(lambda s, k, phi: s.density(k, phi))
harmonics = eqx.filter_jit(lambda s, k: s.harmonics(k))

F = np.array([0.04, 0.05, 0.065, 0.08, 0.1, 0.105, 0.15, 0.2, 0.3, 0.45])


def rough(tail=None, depth=None, seed=1):
    """A table as rough as a real record."""
    energy = np.random.default_rng(seed).gamma(0.5, 1.0, (F.size, 24))
    return sp.MeasuredSpectrum(
        energy, F, 1.0, tail=sp.NoTail() if tail is None else tail, dispersion=sp.Dispersion(depth)
    )


@pytest.mark.parametrize("depth", [None, 15.0])
def test_the_variance_is_that_of_the_table(depth):
    spectrum = rough(depth=depth)
    cells = np.gradient(F)  # as wavespectra integrates
    expected = np.sum(np.asarray(spectrum.energy).sum(axis=1) * (2 * np.pi / 24) * cells)
    np.testing.assert_allclose(variance(spectrum), expected, rtol=1e-12)
    assert not np.isclose(expected, np.trapezoid(np.asarray(spectrum.energy).sum(axis=1) * 2 * np.pi / 24, F))


def test_a_band_takes_its_part_of_the_table():
    spectrum = rough()
    k = sp.Dispersion().wavenumber(jnp.asarray(2 * np.pi * np.array([0.0451, 0.172])))
    lower, upper = float(k[0]), float(k[1])
    f = np.linspace(0.0451, 0.172, 200001)
    per_frequency = np.asarray(spectrum.energy).sum(axis=1) * 2 * np.pi / 24
    expected = np.trapezoid(np.interp(f, F, per_frequency), f)
    np.testing.assert_allclose(variance(spectrum, band=(lower, upper)), expected, rtol=1e-8)


def test_the_density_goes_through_the_table():
    spectrum = rough(depth=15.0)
    phi = 1.0 + np.arange(24) * (2 * np.pi / 24)
    relation = spectrum.dispersion
    k = relation.wavenumber(jnp.asarray(2 * np.pi * F))
    jacobian = np.asarray(relation.group_speed(k) / (2 * np.pi * k))
    grid = density(spectrum, *jnp.broadcast_arrays(k[:-1, None], jnp.asarray(phi)))
    np.testing.assert_allclose(grid, np.asarray(spectrum.energy[:-1]) * jacobian[:-1, None], rtol=1e-9)
    # Half-way between two directions lies the mean of the two.
    middle = density(spectrum, k[3], jnp.asarray(phi[5] + np.pi / 24))
    expected = 0.5 * (spectrum.energy[3, 5] + spectrum.energy[3, 6]) * jacobian[3]
    np.testing.assert_allclose(middle, expected, rtol=1e-9)
    # And the last direction is the first one's neighbour.
    across = density(spectrum, k[3], jnp.asarray(1.0 - np.pi / 24))
    np.testing.assert_allclose(
        across, 0.5 * (spectrum.energy[3, -1] + spectrum.energy[3, 0]) * jacobian[3], rtol=1e-9
    )


def test_turning_the_table_turns_the_sea():
    still, turned = rough(), eqx.tree_at(lambda s: s.first_direction, rough(), jnp.asarray(1.7))
    k, phi = jnp.asarray([0.15, 0.3]), jnp.asarray([2.0, -1.0])
    np.testing.assert_allclose(density(turned, k, phi + 0.7), density(still, k, phi), rtol=1e-9)
    np.testing.assert_allclose(variance(turned), variance(still), rtol=1e-12)


def test_without_a_tail_nothing_is_above_the_cut_off():
    spectrum = rough()
    cut_off = float(spectrum.cut_off_wavenumber())
    np.testing.assert_allclose(spectrum.cut_off(), 0.45 + 0.075)
    np.testing.assert_allclose(cut_off, (2 * np.pi * 0.525) ** 2 / 9.81)
    k = jnp.asarray([cut_off * 0.999, cut_off * 1.001])
    below, above = harmonics(spectrum, k).mean
    assert float(below) > 0
    assert float(above) == 0


@pytest.mark.parametrize("exponent", [-5.0, -4.0])
def test_a_power_tail_is_continuous_and_has_its_exponent(exponent):
    spectrum = rough(sp.PowerTail(exponent))
    cut_off = float(spectrum.cut_off())
    f = jnp.asarray([cut_off * (1 - 1e-9), cut_off * (1 + 1e-9), cut_off * 2, cut_off * 20])
    before, after, twice, far = eqx.filter_jit(sp.frequency_spectrum)(spectrum, f)
    np.testing.assert_allclose(before, after, rtol=1e-6)
    np.testing.assert_allclose(twice / after, 2**exponent, rtol=1e-6)
    np.testing.assert_allclose(far / after, 20**exponent, rtol=1e-6)
    # In every direction it is continuous too.
    k = spectrum.dispersion.wavenumber(2 * np.pi * f[:2])
    phi = jnp.linspace(0, 6, 7)
    inside, outside = density(spectrum, *jnp.broadcast_arrays(k[:, None], phi))
    np.testing.assert_allclose(inside, outside, rtol=1e-6)
    # ∫ E_c (f/f_c)ⁿ df = E_c f_c/(−n − 1)
    extra = variance(spectrum, band=(1e-3, 1e4)) - variance(rough(), band=(1e-3, 1e4))
    np.testing.assert_allclose(extra, after * cut_off / (-exponent - 1), rtol=1e-4)


def test_the_tail_goes_the_way_of_the_last_bins():
    spectrum = rough(sp.PowerTail())
    k = jnp.asarray([5.0, 50.0])
    means = harmonics(spectrum, k)
    last = np.asarray(spectrum.energy[-3:]).sum(axis=0)
    phi = 1.0 + np.arange(24) * (2 * np.pi / 24)
    hat = np.sinc(2 / 24) ** 2  # of the linear interpolation between directions 15° apart
    expected = hat * np.sum(last * np.cos(2 * phi)) / np.sum(last)
    np.testing.assert_allclose(means.cos2 / means.mean, expected, rtol=1e-9)


def test_an_elfouhaily_tail_is_that_of_the_wind_and_leaves_the_measurement_alone():
    wind = jo.Wind(9.0, 0.5)
    spectrum, power, model = rough(sp.ElfouhailyTail(wind)), rough(sp.PowerTail()), sp.Elfouhaily(wind)
    cut_off = float(spectrum.cut_off_wavenumber())
    band = (1e-3, cut_off)
    np.testing.assert_allclose(variance(spectrum, band=band), variance(power, band=band), rtol=1e-10)
    k = jnp.asarray([cut_off * 1.5**2 * 1.01, 10.0, 300.0])
    phi = jnp.asarray([0.2, 0.6, 2.0])
    np.testing.assert_allclose(density(spectrum, k, phi), density(model, k, phi), rtol=1e-9)
    k = jnp.asarray([cut_off * 1.000001, cut_off * 1.3])
    np.testing.assert_allclose(harmonics(spectrum, k).mean[0], harmonics(power, k).mean[0], rtol=1e-4)
    middle = float(harmonics(spectrum, k).mean[1])
    ends = sorted(float(harmonics(one, k).mean[1]) for one in (power, model))
    assert ends[0] < middle < ends[1]


def test_the_tail_decides_the_slopes_and_not_the_height():
    tails = [sp.NoTail(), sp.PowerTail(), sp.PowerTail(-4.0), sp.ElfouhailyTail(jo.Wind(10.0))]
    seas = [eqx.tree_at(lambda s: s.tail, table(), tail) for tail in tails]
    heights = [float(height(sea)) for sea in seas]
    slopes = [float(slope(sea)) for sea in seas]
    assert max(heights) < 1.02 * min(heights)
    assert max(slopes) > 3 * min(slopes)
    assert all(rough(tail).tail is tail for tail in tails)


def test_a_record_without_energy_in_its_last_bins_has_no_power_tail():
    energy = np.array(rough().energy)
    energy[-4:] = 0
    spectrum = sp.MeasuredSpectrum(energy, F)
    slope_and_gradient = jax.jit(jax.value_and_grad(lambda s: sp.mean_square_slope(s, band=(5.0, 100.0))))
    value, gradient = slope_and_gradient(spectrum)
    assert float(value) == 0.0
    assert all(bool(jnp.all(jnp.isfinite(leaf))) for leaf in jax.tree.leaves(gradient))


def test_a_sea_can_be_fitted_through_its_table():
    # The height's derivative in the energy of one cell: dHs/dE = 8 Δf Δφ / Hs.
    spectrum = rough()
    gradient = eqx.filter_jit(eqx.filter_grad(sp.significant_wave_height))(spectrum)
    expected = 8 * np.gradient(F)[4] * (2 * np.pi / 24) / float(height(spectrum))
    np.testing.assert_allclose(gradient.energy[4, 7], expected, rtol=1e-9)


@pytest.mark.parametrize(
    ("energy", "frequency", "message"),
    [
        (np.ones((3, 8)), [0.1, 0.2], r"`energy` must be of shape \(frequency, direction\)"),
        (np.ones((2, 3)), [0.1, 0.2], "at least 5 directions"),
        (-np.ones((2, 8)), [0.1, 0.2], "`energy` must be finite and at least 0"),
        (np.full((2, 8), np.nan), [0.1, 0.2], "`energy` must be finite and at least 0"),
        (np.ones((2, 8)), [0.2, 0.1], "`frequency` must be at least two increasing numbers"),
        (np.ones((2, 8)), [0.0, 0.1], "`frequency` must be at least two increasing numbers greater than 0"),
    ],
)
def test_a_table_that_is_none_is_refused(energy, frequency, message):
    with pytest.raises(ValueError, match=message):
        sp.MeasuredSpectrum(energy, np.asarray(frequency))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sp.PowerTail(-1.0), "`exponent` must be at most -1.01"),
        (lambda: sp.ElfouhailyTail(jo.Wind(10.0), blend=1.0), "`blend` must be at least 1.01"),
    ],
)
def test_impossible_tails_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()
