"""The level of a measured spectrum's tail, from one frequency or from several."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean import spectra as sp

F = np.arange(0.05, 0.4, 0.01)
slope = eqx.filter_jit(sp.mean_square_slope)
density = eqx.filter_jit(lambda s, k, angle: s.density(k, angle))
height = eqx.filter_jit(sp.significant_wave_height)


def measured(noise=0.0, **options):
    """E ∝ f⁻⁵ above 0.1 Hz, with multiplicative noise in every bin."""
    factor = np.exp(noise * np.random.default_rng(5).standard_normal(F.size))
    energy = np.minimum((F / 0.1) ** -5.0, 1.0) * factor
    return sp.MeasuredSpectrum(energy[:, None] * np.full(12, 0.1), F, **options)


def test_a_spectrum_that_follows_its_tail_has_the_same_level_by_all_bins():
    np.testing.assert_allclose(slope(measured(tail_bins=8)), slope(measured(tail_bins=1)), rtol=1e-10)


def test_noise_of_the_last_bin_no_longer_decides_about_the_short_waves():
    truth = float(slope(measured()))
    errors = [abs(float(slope(measured(noise=0.5, tail_bins=n))) / truth - 1) for n in (1, 8)]
    assert errors[1] < 0.5 * errors[0]


def test_what_was_measured_is_left_alone_by_the_level_of_the_tail():
    one, many = measured(noise=0.5, tail=sp.NoTail()), measured(noise=0.5, tail=sp.NoTail(), tail_bins=8)
    assert float(height(one)) == float(height(many))
    k = jnp.geomspace(0.01, 0.6, 40)
    angle = jnp.zeros(40)
    with_tail = measured(noise=0.5, tail_bins=8)
    np.testing.assert_array_equal(density(one, k, angle), density(with_tail, k, angle))


def test_density_and_harmonics_have_the_same_tail():
    spectrum = measured(noise=0.5, tail_bins=8)
    k = jnp.geomspace(0.1, 50.0, 60)
    whole, own = eqx.filter_jit(lambda s: (sp.integrate_harmonics(s, k, directions=48), s.harmonics(k)))(
        spectrum
    )
    np.testing.assert_allclose(own.mean, whole.mean, rtol=1e-9)


def test_the_level_follows_the_tail_when_it_is_turned_steeper():
    @jax.jit
    def of(exponent):
        spectrum = measured(noise=0.5, tail=sp.PowerTail(exponent), tail_bins=8)
        return spectrum.density(jnp.asarray(5.0), jnp.asarray(0.0))

    value, step = of(-5.0), 1e-4
    expected = (of(-5.0 + step) - of(-5.0 - step)) / (2 * step)
    np.testing.assert_allclose(jax.jit(jax.grad(of))(-5.0), expected, rtol=1e-5)
    assert np.isfinite(value)


def test_a_number_of_bins_that_is_not_there_is_refused():
    with pytest.raises(ValueError, match=r"`tail_bins` must lie between 1 and the 35 frequencies, but is 36"):
        measured(tail_bins=36)
