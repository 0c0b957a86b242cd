import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import wind_sea

import jaxocean as jo
from jaxocean.surface import Cascade, cell_energy, draw_noise, realise

SMALL = Cascade((60.0, 9.0), 16)
KEY = jax.random.key(11)


def mean_square_height(speed, noise):
    sea = realise(wind_sea(speed), SMALL, noise=noise)
    return jnp.mean(jnp.sum(sea.fields(0.7).height, axis=0) ** 2)


def test_a_key_and_its_noise_make_the_same_sea():
    from_key = realise(wind_sea(), SMALL, key=KEY)
    from_noise = realise(wind_sea(), SMALL, noise=draw_noise(SMALL, KEY))
    np.testing.assert_array_equal(from_key.fields(1.0).height, from_noise.fields(1.0).height)
    other = realise(wind_sea(), SMALL, key=jax.random.key(12))
    assert not np.allclose(from_key.fields(1.0).height, other.fields(1.0).height)


@pytest.mark.parametrize("given", [{}, {"key": KEY, "noise": draw_noise(SMALL, KEY)}])
def test_exactly_one_of_key_and_noise_is_wanted(given):
    with pytest.raises(ValueError, match="exactly one of `key` and `noise`"):
        realise(wind_sea(), SMALL, **given)


def test_noise_of_another_cascade_and_senseless_repeat_periods_are_refused():
    with pytest.raises(ValueError, match="cascade's shape"):
        realise(wind_sea(), SMALL, noise=draw_noise(Cascade((60.0, 9.0), 32), KEY))
    for period in (0.0, -3.0, float("nan")):
        with pytest.raises(ValueError, match="repeat_period"):
            realise(wind_sea(), SMALL, key=KEY, repeat_period=period)


def test_the_noise_of_a_wave_does_not_depend_on_the_resolution():
    coarse, fine = (np.asarray(draw_noise(Cascade((60.0, 9.0), n), KEY)) for n in (16, 64))
    index = np.r_[0:8, 57:64]
    np.testing.assert_array_equal(
        coarse[:, np.r_[0:8, 9:16]][:, :, np.r_[0:8, 9:16]], fine[:, index][:, :, index]
    )


def test_a_finer_grid_with_the_same_bands_is_the_same_sea():
    middle = np.pi * 32 / 60 * 0.8
    bands = [(0.1, middle), (middle, 6.0)]
    coarse, fine = (
        realise(wind_sea(), Cascade((60.0, 9.0), n, bands=bands), key=KEY).fields(2.0) for n in (32, 64)
    )
    np.testing.assert_allclose(fine.height[:, ::2, ::2], coarse.height, atol=1e-12)


def test_gradients_with_respect_to_wind_and_noise_are_right():
    noise = draw_noise(SMALL, KEY)
    step = draw_noise(SMALL, jax.random.key(12))
    assert_derivative_matches(
        lambda q: mean_square_height(q[0], noise + q[1].astype(noise.dtype) * step), [8.0, 0.3], step=1e-5
    )


def test_gradient_with_respect_to_depth_is_right_also_late():
    noise = draw_noise(SMALL, KEY)

    def late(depth):
        sea = realise(wind_sea(), SMALL, noise=noise, dispersion=jo.spectra.Dispersion(depth=depth))
        return sea.fields(40.3).height[0, 2, 3]

    assert_derivative_matches(late, 3.0, step=1e-5, rtol=1e-5)


def test_gradients_are_finite_for_a_calm_and_a_light_wind():
    noise = draw_noise(SMALL, KEY)
    gradient = jax.jit(jax.grad(mean_square_height))
    for speed in (0.0, 0.01, 1.0):
        assert np.isfinite(gradient(speed, noise))


@pytest.mark.parametrize("x64", [False, True])
def test_precision_is_that_of_the_spectrum(x64):
    with jax.enable_x64(x64):
        speed = np.float64(8.0) if x64 else np.float32(8.0)
        sea = realise(wind_sea(speed, speed * 0), SMALL, key=jax.random.key(1))
        fields = sea.fields(1.0, (1.0, 0.5), 20.0)
        p = jnp.ones((3, 2), fields.height.dtype)
        outputs = [
            fields.height,
            fields.strain,
            sea.displacement(p, 1.0),
            sea.height_bound(),
            sea.amplitude.real,
        ]
        expected = jnp.float64 if x64 else jnp.float32
        assert {o.dtype for o in outputs} == {jnp.dtype(expected)}


def test_a_float32_sea_in_a_float64_session_stays_float32():
    spectrum = wind_sea(jnp.float32(8.0), jnp.float32(0.4))
    spectrum = jax.tree.map(lambda leaf: leaf.astype(jnp.float32), spectrum)
    sea = realise(
        spectrum, SMALL, key=KEY, dispersion=jo.spectra.Dispersion(surface_tension=jnp.float32(0.0))
    )
    double = realise(wind_sea(), SMALL, key=KEY)
    assert sea.fields(1.0).height.dtype == jnp.float32
    np.testing.assert_allclose(sea.fields(1.0).height, double.fields(1.0).height, atol=2e-5)


def test_seeds_can_be_mapped_and_jitted():
    keys = jax.random.split(KEY, 3)

    @jax.jit
    def heights(keys):
        return jax.vmap(lambda key: realise(wind_sea(), SMALL, key=key).fields(1.0).height)(keys)

    alone = [realise(wind_sea(), SMALL, key=key).fields(1.0).height for key in keys]
    np.testing.assert_allclose(heights(keys), jnp.stack(alone), atol=1e-12)


def test_winds_times_and_choppiness_can_be_mapped():
    noise = draw_noise(SMALL, KEY)
    p = jnp.asarray([[1.0, 2.0], [30.0, -4.0]])

    def answer(speed, time, choppiness):
        sea = realise(wind_sea(speed), SMALL, noise=noise)
        return (
            sea.fields(time, choppiness),
            sea.strain(p, time, choppiness, 12.0),
            cell_energy(wind_sea(speed), SMALL),
        )

    speeds, times, lam = jnp.asarray([5.0, 9.0]), jnp.asarray([0.0, 7.0]), jnp.asarray([0.3, 0.7])
    mapped = eqx.filter_vmap(answer)(speeds, times, lam)
    alone = answer(speeds[1], times[1], lam[1])
    jax.tree.map(lambda many, one: np.testing.assert_allclose(many[1], one, atol=1e-9), mapped, alone)
    np.testing.assert_allclose(mapped[0].strain[1], alone[0].strain, atol=1e-9)
