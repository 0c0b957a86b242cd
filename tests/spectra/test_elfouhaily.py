"""The unified spectrum: reference values, sea truth, its options and its edges."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean import spectra as sp

height = eqx.filter_jit(sp.significant_wave_height)
slope = eqx.filter_jit(sp.mean_square_slope)
slopes = eqx.filter_jit(sp.slope_variance)


@pytest.mark.parametrize(
    ("speed", "hs", "mss"),
    [(5.0, 0.6441, 0.02932), (10.0, 2.606, 0.05164), (15.0, 5.869, 0.06887), (20.0, 10.42, 0.08130)],
)
def test_heights_and_slopes_are_those_of_the_reference_table(speed, hs, mss):
    sea = sp.Elfouhaily(jo.Wind(speed))
    np.testing.assert_allclose(height(sea), hs, rtol=5e-4)
    np.testing.assert_allclose(slope(sea), mss, rtol=5e-4)


@pytest.mark.parametrize("speed", [5.0, 7.0, 9.0, 11.0, 13.0, 15.0])
def test_slopes_lie_within_fifteen_percent_of_cox_and_munks_clean_sea(speed):
    # Their wind is at 12.5 m.
    wind = jo.Wind.from_meteorological(speed, from_degrees=270.0, height=12.5)
    sea = sp.Elfouhaily(wind)
    total = slope(sea, band=(1e-3, 2000.0))
    assert abs(float(total) / (0.003 + 5.12e-3 * speed) - 1) < 0.15
    upwind, crosswind, _ = slopes(sea, band=(1e-3, 2000.0))
    assert float(upwind) > float(crosswind)


def test_capillary_waves_hold_a_good_part_of_the_slopes():
    sea = sp.Elfouhaily(jo.Wind(10.0))
    assert 0.05 < float(slope(sea, band=(400.0, 4000.0)) / slope(sea, band=(1e-3, 4000.0))) < 0.3


def test_the_half_plane_keeps_all_energy_and_all_of_it_goes_downwind():
    wind = jo.Wind(10.0, 0.7)
    whole, half = sp.Elfouhaily(wind), sp.Elfouhaily(wind, half_plane=True)
    k = jnp.asarray([0.08, 1.0, 60.0])
    both = (eqx.filter_jit(sp.integrate_harmonics)(sea, k) for sea in (whole, half))
    for a, b in zip(*both, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-14)
    assert bool(jnp.all(half.density(k, jnp.full(3, 0.7 + 2.0)) == 0))
    downwind = jnp.full(3, 0.9)
    np.testing.assert_allclose(half.density(k, downwind), 2 * whole.density(k, downwind))


def test_fetch_and_inverse_wave_age_say_the_same_in_two_ways():
    age = jo.Wind(10.0, fetch=5e4).inverse_wave_age()
    by_fetch = sp.Elfouhaily(jo.Wind(10.0, fetch=5e4))
    by_age = sp.Elfouhaily(jo.Wind(10.0), age)
    np.testing.assert_allclose(height(by_fetch), height(by_age), rtol=1e-12)
    np.testing.assert_allclose(by_fetch.peak_wavenumber(), 9.81 * (float(age) / 10) ** 2)
    with pytest.raises(ValueError, match="exactly one of the wind's `fetch` and `inverse_wave_age`"):
        sp.Elfouhaily(jo.Wind(10.0, fetch=5e4), 0.84)


def test_young_seas_are_lower_and_their_peaks_sharper():
    young, old = sp.Elfouhaily(jo.Wind(10.0), 2.5), sp.Elfouhaily(jo.Wind(10.0), 0.84)
    assert float(height(young)) < 0.4 * float(height(old))
    assert float(sp.peak_period(young)) < 0.6 * float(sp.peak_period(old))


@pytest.mark.parametrize("x64", [True, False])
def test_calm_seas_are_flat_and_differentiable(x64):
    def all_numbers(u):
        sea = sp.Elfouhaily(jo.Wind(u))
        return jnp.stack([sp.significant_wave_height(sea), sp.mean_square_slope(sea)])

    with jax.enable_x64(x64):
        speeds = jnp.asarray([0.0, 1e-8, 1e-3, 0.1, 1.0, 2.0])
        values, derivatives = jax.jit(jax.vmap(lambda u: (all_numbers(u), jax.jacrev(all_numbers)(u))))(
            speeds
        )
    assert bool(jnp.all(jnp.isfinite(values)))
    assert bool(jnp.all(jnp.isfinite(derivatives)))
    assert float(jnp.max(values[:3])) == 0.0
    assert bool(jnp.all(values[4:] > 0))


def test_the_sea_grows_steadily_out_of_the_calm():
    heights = [float(height(sp.Elfouhaily(jo.Wind(u)))) for u in (0.0, 0.5, 1.0, 2.0, 3.0, 4.0)]
    assert heights == sorted(heights)
    # Hs ∝ U² as long as the spectrum is self-similar.
    np.testing.assert_allclose(heights[4] / heights[3], 9 / 4, rtol=0.02)


def test_an_impossible_wave_age_is_refused():
    with pytest.raises(ValueError, match="`inverse_wave_age` must be greater than 0, but is -1"):
        sp.Elfouhaily(jo.Wind(10.0), -1.0)
