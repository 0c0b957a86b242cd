import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import wind_sea

import jaxocean as jo
from jaxocean.surface import Cascade, realise
from jaxocean.surface.fft._sincos import sincos_turns

CASCADE = Cascade((120.0, 11.0), 64)


def single_precision(tree):
    return jax.tree.map(lambda leaf: leaf.astype(jnp.float32), tree)


def pair_of_seas(**arguments):
    dispersion = jo.spectra.Dispersion()
    key = jax.random.key(4)
    double = realise(wind_sea(), CASCADE, key=key, dispersion=dispersion, **arguments)
    single = realise(
        single_precision(wind_sea()), CASCADE, key=key, dispersion=single_precision(dispersion), **arguments
    )
    return double, single


@pytest.fixture(scope="module")
def seas():
    return pair_of_seas()


@pytest.mark.parametrize("time", [0.0, 12.375, 100_000.3, -1e6, np.float32(65536.25)])
@pytest.mark.parametrize("as_array", [False, True])
def test_a_float32_sea_keeps_its_phase_after_days(seas, time, as_array):
    double, single = seas
    if as_array:
        time = np.float32(time)
        found = jax.jit(lambda t: single.fields(t).strain)(jnp.asarray(time))
        expected = double.fields(float(time)).strain
    else:
        found, expected = single.fields(float(time)).strain, double.fields(float(time)).strain
    error = np.std(np.asarray(found) - np.asarray(expected), axis=(1, 2)) / np.std(expected, axis=(1, 2))
    # Shortest waves: ω ≈ 13 rad/s. A plain float32 product is off by 0.1 rad after a day.
    assert np.all(error < 1e-4 * max(1.0, abs(float(time)) / 2e5))


@pytest.mark.parametrize("period", [10.0, 37.3])
@pytest.mark.parametrize("which", [0, 1])
def test_a_loop_closes_exactly(period, which):
    sea = pair_of_seas(repeat_period=period)[which]
    start, later = sea.fields(1.25), sea.fields(1.25 + 3 * period)
    scale = np.std(start.strain)
    tolerance = 1e-11 if which == 0 else 1e-5
    assert np.max(np.abs(start.strain - later.strain)) < tolerance * scale
    assert np.max(np.abs(start.strain - sea.fields(1.25 + 0.5 * period).strain)) > 0.1 * scale
    traced = jax.jit(lambda t: sea.fields(t).strain)(jnp.asarray(1.25 + 3 * period, sea.frequency.dtype))
    assert np.max(np.abs(traced - start.strain)) < (1e-11 if which == 0 else 1e-3) * scale


def test_a_long_repeat_period_changes_the_sea_little():
    plain = realise(wind_sea(), CASCADE, key=jax.random.key(4))
    loop = realise(wind_sea(), CASCADE, key=jax.random.key(4), repeat_period=3600.0)
    difference = np.std(plain.fields(2.0).height - loop.fields(2.0).height)
    assert 0 < difference < 0.01 * np.std(plain.fields(2.0).height)


def test_time_derivatives_of_a_float32_sea_are_those_of_the_float64_sea(seas):
    rates = []
    for sea in seas:
        dtype = sea.frequency.dtype

        def probe(t, sea=sea, dtype=dtype):
            return sea.height(jnp.asarray([3.0, 4.0], dtype), t)

        t = jnp.asarray(1000.4, dtype)
        rates.append((jax.grad(probe)(t), jax.grad(jax.grad(probe))(t)))
    np.testing.assert_allclose(rates[1], np.asarray(rates[0]), rtol=2e-3)


def test_sine_and_cosine_are_good_to_float32_rounding():
    turns = np.linspace(-0.5, 0.5, 100_001).astype(np.float32)
    sine, cosine = sincos_turns(jnp.asarray(turns))
    exact = 2 * np.pi * turns.astype(np.float64)
    assert sine.dtype == jnp.float32
    np.testing.assert_allclose(sine, np.sin(exact), atol=4.5e-7, rtol=0)
    np.testing.assert_allclose(cosine, np.cos(exact), atol=4.5e-7, rtol=0)
    small = jnp.asarray([1e-6, 1e-3], jnp.float32)
    np.testing.assert_allclose(
        sincos_turns(small)[0], np.sin(2 * np.pi * np.asarray(small, np.float64)), rtol=3e-7
    )


def test_stiffening_is_one_in_deep_water_and_the_law_elsewhere():
    k = jnp.geomspace(1e-2, 500, 7)
    assert np.all(jo.spectra.Dispersion().stiffening(k) == 1)
    law = jo.spectra.Dispersion(depth=4.0, surface_tension=jo.spectra.Dispersion.CLEAN_WATER)
    np.testing.assert_allclose(law.stiffening(k), law.frequency(k) ** 2 / (9.81 * k), rtol=1e-12)
