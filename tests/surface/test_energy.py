"""The variance of the lattice is that of the spectrum, whatever the lattice."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import half_noise, strain_variances, wind_sea

import jaxocean as jo
from jaxocean.surface import Cascade, cell_energy, draw_noise, realise

energy = jax.jit(cell_energy, static_argnums=1)


@pytest.mark.parametrize(
    ("sizes", "resolution"),
    [
        ((893.0, 101.0, 21.0, 11.0), 128),
        ((893.0, 101.0, 21.0, 11.0), 512),
        ((37.0, 500.0), 256),
        ((700.0,), 128),
    ],
)
def test_variance_of_every_pattern_is_the_integral_over_its_band(sizes, resolution):
    cascade, spectrum = Cascade(sizes, resolution), wind_sea()
    found = np.sum(energy(spectrum, cascade), axis=(1, 2))
    expected = [jo.spectra.height_variance(spectrum, band=band) for band in cascade.bands]
    np.testing.assert_allclose(found, expected, rtol=3e-4)


@pytest.mark.parametrize(
    ("waves_per_pattern", "peak_enhancement"), [(2.5, 1.0), (2.5, 3.3), (2.5, 7.0), (2.9, 7.0), (7.0, 3.3)]
)
def test_a_narrow_peak_between_the_waves_of_a_coarse_lattice_keeps_its_energy(
    waves_per_pattern, peak_enhancement
):
    spectrum = jo.spectra.JONSWAP(
        significant_wave_height=2.0,
        peak_period=8.0,
        peak_enhancement=peak_enhancement,
        direction=0.3,
    )
    peak = (2 * np.pi / 8.0) ** 2 / 9.81
    size = waves_per_pattern * 2 * np.pi / peak
    resolution = 2 * int(np.ceil(10 * peak * size / np.pi / 2))
    cascade = Cascade((size,), resolution)
    expected = float(jo.spectra.height_variance(spectrum, band=cascade.band))
    assert expected > 0.95 * 0.25
    assert float(jnp.sum(energy(spectrum, cascade))) == pytest.approx(expected, rel=3e-3)


def test_an_edge_near_the_first_cell_loses_nothing():
    spectrum = jo.spectra.PiersonMoskowitz(significant_wave_height=1.0, peak_period=4.0)
    peak = (2 * np.pi / 4.0) ** 2 / 9.81
    size = 2 * np.pi / peak
    cascade = Cascade((size,), 16)
    expected = float(jo.spectra.height_variance(spectrum, band=cascade.band))
    assert float(jnp.sum(energy(spectrum, cascade))) == pytest.approx(expected, rel=3e-3)


def test_mean_and_nyquist_carry_nothing():
    cascade = Cascade((100.0, 20.0), 16, bands=[(0.1, 0.5), (0.5, 2.5)])
    e = np.asarray(energy(wind_sea(), cascade))
    assert np.all(e[:, 0, 0] == 0)
    assert np.all(e[:, 8] == 0)
    assert np.all(e[:, :, 8] == 0)
    assert np.all(e >= 0)


def test_bands_are_disjoint():
    cascade = Cascade((100.0, 20.0), 64)
    e = np.asarray(energy(wind_sea(), cascade))
    for pattern, (lower, upper) in enumerate(cascade.bands):
        width = 2 * np.pi / cascade.sizes[pattern]
        index = np.fft.fftfreq(64, 1 / 64)
        k = np.hypot(index[:, None], index) * width
        outside = (k < lower - 0.8 * width) | (k > upper + 0.8 * width)
        assert np.all(e[pattern][outside] == 0)


def test_heights_on_the_grid_have_the_variance_of_the_spectrum():
    spectrum, cascade = wind_sea(), Cascade((400.0, 50.0), 128)
    fields = realise(spectrum, cascade, noise=half_noise(cascade)).fields(3.0)
    expected = [jo.spectra.height_variance(spectrum, band=band) for band in cascade.bands]
    np.testing.assert_allclose(np.var(fields.height, axis=(1, 2)), expected, rtol=3e-4)


def test_low_passed_strain_does_not_depend_on_the_resolution():
    spectrum, found = wind_sea(), []
    for resolution in (128, 256, 512):
        cascade = Cascade((60.0, 9.0), resolution)
        fields = realise(spectrum, cascade, noise=half_noise(cascade)).fields(0.0, 1.0, 40.0)
        found.append(np.sum(np.var(fields.strain, axis=(1, 2)), axis=0))
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=2e-3)
    unfiltered = strain_variances(spectrum, (np.pi / 60, 40.0))
    assert np.all(found[0] < 0.98 * unfiltered)


@pytest.fixture(scope="module")
def ensemble():
    cascade, spectrum = Cascade((120.0, 15.0), 64), wind_sea()
    seeds = jax.random.split(jax.random.key(5), 48)

    @jax.jit
    def statistics(keys):
        fields = jax.vmap(lambda key: realise(spectrum, cascade, key=key).fields(1.5))(keys)
        square = jnp.mean(fields.strain**2, axis=(2, 3))
        return jnp.mean(fields.height**2, axis=(2, 3)), square

    return cascade, spectrum, *statistics(seeds)


def test_ensemble_variances_agree_with_quadrature_within_their_own_error(ensemble):
    cascade, spectrum, height, strain = ensemble
    for pattern, band in enumerate(cascade.bands):
        expected = np.array(
            [float(jo.spectra.height_variance(spectrum, band=band)), *strain_variances(spectrum, band)]
        )
        found = np.concatenate([np.asarray(height)[:, pattern, None], np.asarray(strain)[:, pattern]], axis=1)
        error = found.std(axis=0, ddof=1) / np.sqrt(len(found))
        # Half a part in a hundred for the lattice: k is that of the cell's middle.
        assert np.all(np.abs(found.mean(axis=0) - expected) < 4 * error + 5e-3 * expected)
        assert np.all(error < 0.06 * expected)


def test_amplitudes_are_gaussian_and_not_only_the_phases():
    noise = np.asarray(draw_noise(Cascade((10.0,), 512), jax.random.key(3)))
    square = np.abs(noise) ** 2
    count = square.size
    assert abs(square.mean() - 1) < 5 / np.sqrt(count)
    assert abs((square**2).mean() - 2) < 5 * np.sqrt(20 / count)
    assert abs((noise**2).mean()) < 5 * np.sqrt(2 / count)
