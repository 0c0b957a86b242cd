import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import GRAVITY, single_wave, wind_sea

from jaxocean.surface import Cascade, realise

CASCADE = Cascade((60.0, 9.0), 32)


@pytest.fixture(scope="module")
def sea():
    return realise(wind_sea(), CASCADE, key=jax.random.key(2))


@pytest.mark.parametrize(("iy", "ix"), [(0, 3), (5, -2), (-4, -4), (7, 0)])
def test_a_single_wave_is_the_textbook_wave(iy, ix):
    sea, h0, kx, ky = single_wave(iy, ix, CASCADE)
    time, lam = 2.3, 0.7
    k = np.hypot(kx, ky)
    x, y = np.moveaxis(CASCADE.points(0), -1, 0)
    wave = 2 * h0 * np.exp(1j * (kx * x + ky * y - np.sqrt(GRAVITY * k) * time))
    fields = sea.fields(time, lam)
    np.testing.assert_allclose(fields.height[0], wave.real, atol=1e-12)
    np.testing.assert_allclose(fields.height[1], 0, atol=1e-12)
    np.testing.assert_allclose(fields.displacement[0, ..., 0], lam * (1j * kx / k * wave).real, atol=1e-12)
    np.testing.assert_allclose(fields.displacement[0, ..., 1], lam * (1j * ky / k * wave).real, atol=1e-12)
    np.testing.assert_allclose(fields.slope[0, ..., 0], (1j * kx * wave).real, atol=1e-12)
    np.testing.assert_allclose(fields.slope[0, ..., 1], (1j * ky * wave).real, atol=1e-12)
    np.testing.assert_allclose(fields.strain[0, ..., 0], lam * (-kx * kx / k * wave).real, atol=1e-12)
    np.testing.assert_allclose(fields.strain[0, ..., 1], lam * (-ky * ky / k * wave).real, atol=1e-12)
    np.testing.assert_allclose(fields.strain[0, ..., 2], lam * (-kx * ky / k * wave).real, atol=1e-12)


def test_a_crest_is_compressed_and_a_trough_is_stretched():
    sea, _, _, _ = single_wave(2, 3, CASCADE)
    fields = sea.fields(0.4)
    a, b, c = np.moveaxis(np.asarray(fields.strain[0]), -1, 0)
    j = (1 + a) * (1 + b) - c * c
    height = np.asarray(fields.height[0])
    assert np.all(j[height > 0.5 * height.max()] < 1)
    assert np.all(j[height < 0.5 * height.min()] > 1)


def test_a_displaced_wave_is_gerstners_trochoid():
    sea, h0, kx, _ = single_wave(0, 1, CASCADE)
    fields = sea.fields(0.0)
    amplitude = 2 * abs(h0)
    theta = kx * CASCADE.points(0)[0, :, 0] + np.angle(h0)
    x = CASCADE.points(0)[0, :, 0] + np.asarray(fields.displacement)[0, 0, :, 0]
    np.testing.assert_allclose(x, CASCADE.points(0)[0, :, 0] - amplitude * np.sin(theta), atol=1e-12)
    np.testing.assert_allclose(fields.height[0, 0], amplitude * np.cos(theta), atol=1e-12)


def test_waves_travel_along_their_wave_vector():
    sea, h0, kx, _ = single_wave(0, 2, CASCADE)
    speed = np.sqrt(GRAVITY / kx)
    p = jnp.asarray([[3.0, 5.0]])
    moved = p + jnp.asarray([speed * 1.7, 0.0])
    np.testing.assert_allclose(sea.height(moved, 1.7), sea.height(p, 0.0), atol=1e-12)
    assert abs(sea.height(moved, 1.7) - sea.height(p, 1.7))[0] > 0.1 * abs(h0)


def test_transforms_leave_the_fields_real(sea):
    spectrum = np.fft.fft2(np.asarray(sea.fields(4.0).packed)[:, 0].real, norm="forward")
    mirrored = np.roll(np.flip(spectrum.conj(), (-2, -1)), 1, (-2, -1))
    np.testing.assert_allclose(spectrum, mirrored, atol=1e-14)
    # The sum over waves itself, one wave at a time, in plain NumPy.
    h0 = np.asarray(sea.amplitude)[0]
    index = np.fft.fftfreq(32, 1 / 32)
    kx, ky = np.meshgrid(index, index)
    kx, ky = kx * 2 * np.pi / 60, ky * 2 * np.pi / 60
    phases = kx * 7.1 + ky * -3.3 - np.sqrt(GRAVITY * np.hypot(kx, ky)) * 4.0
    expected = 2 * np.sum((h0 * np.exp(1j * phases)).real)
    alone = realise(wind_sea(), Cascade((60.0,), 32), noise=sea.noise[:1])
    np.testing.assert_allclose(alone.height(jnp.asarray([7.1, -3.3]), 4.0), expected, atol=1e-12)


def test_choppiness_scales_displacement_and_strain_of_each_pattern_only(sea):
    plain, choppy = sea.fields(1.0), sea.fields(1.0, (0.5, 2.0))
    lam = np.array([0.5, 2.0])[:, None, None]
    np.testing.assert_allclose(choppy.height, plain.height, atol=1e-14)
    np.testing.assert_allclose(choppy.slope, plain.slope, atol=1e-14)
    np.testing.assert_allclose(choppy.displacement, lam[..., None] * plain.displacement, atol=1e-13)
    np.testing.assert_allclose(choppy.strain, lam[..., None] * plain.strain, atol=1e-13)


def test_breaking_wavenumber_filters_the_strain_and_not_the_slope(sea):
    plain, filtered = sea.fields(1.0), sea.fields(1.0, 1.0, 3.0)
    np.testing.assert_allclose(filtered.slope, plain.slope, atol=1e-14)
    np.testing.assert_allclose(filtered.displacement, plain.displacement, atol=1e-14)
    power = np.abs(np.fft.fft2(filtered.strain, axes=(1, 2), norm="forward"))
    index = np.fft.fftfreq(32, 1 / 32)
    for pattern, size in enumerate(CASCADE.sizes):
        k = np.hypot(index[:, None], index) * 2 * np.pi / size
        assert np.all(power[pattern][k >= 3.0] < 1e-15)
        whole = np.abs(np.fft.fft2(plain.strain[pattern], axes=(0, 1), norm="forward"))
        np.testing.assert_allclose(power[pattern][k <= 1.5], whole[k <= 1.5], atol=1e-15)


def test_what_the_low_pass_takes_from_the_strain_is_kept_apart(sea):
    whole, low = sea.fields(1.0), sea.fields(1.0, 1.0, 0.5)
    assert whole.short_strain is None
    assert np.std(low.short_strain) > 0.1 * np.std(whole.strain)
    np.testing.assert_allclose(low.strain + low.short_strain, whole.strain, atol=1e-12)


def test_wrong_arguments_are_refused_with_a_reason(sea):
    with pytest.raises(ValueError, match="one for each of the 2 patterns, but has shape \\(3,\\)"):
        sea.fields(1.0, (1.0, 1.0, 1.0))
    with pytest.raises(ValueError, match="choppiness` must be finite"):
        sea.fields(1.0, float("nan"))
    with pytest.raises(ValueError, match="breaking_wavenumber"):
        sea.fields(1.0, 1.0, -2.0)
    with pytest.raises(ValueError, match="time` must be finite"):
        sea.fields(float("inf"))


def test_fields_are_differentiable_in_time_choppiness_and_breaking_wavenumber(sea):
    def energy(arguments):
        fields = sea.fields(arguments[0], arguments[1], arguments[2])
        return jnp.sum(fields.strain[..., 0] ** 3) + jnp.sum(fields.height**3)

    assert_derivative_matches(energy, [1.2, 0.8, 9.0], step=1e-5)


@pytest.mark.parametrize("patterns", [1, 2, 3])
@pytest.mark.parametrize("time", [0.0, 2.3, jnp.asarray(0.7)])
def test_strains_alone_are_those_among_all_fields(patterns, time):
    cascade = Cascade((60.0, 21.0, 9.0)[:patterns], 16)
    sea = realise(wind_sea(), cascade, key=jax.random.key(3))
    choppiness = (1.2, 0.9, 0.4)[:patterns]
    expected = sea.fields(time, choppiness, 4.0).strain
    np.testing.assert_allclose(sea.strains(time, choppiness, 4.0), expected, rtol=1e-10, atol=1e-14)


def test_strains_alone_have_the_derivatives_of_all_fields(sea):
    def power(lam, limit):
        return jnp.sum(sea.strains(0.0, lam, limit) ** 2)

    assert_derivative_matches(lambda lam: power(lam, 5.0), 0.8)
    assert_derivative_matches(lambda limit: power(0.8, limit), 5.0)
