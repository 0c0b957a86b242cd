"""Pixels: transfer function and tone mapping against colour-science and their formulas; distances between images."""

import warnings

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches, assert_gradient_matches
from scipy.ndimage import gaussian_filter

from jaxocean.imagery import (
    Bruneton,
    Exposure,
    Filmic,
    decode_srgb,
    encode_srgb,
    from_bytes,
    largest_error,
    mean_absolute_error,
    mean_square_error,
    psnr,
    structural_similarity,
    to_bytes,
    white_balance,
)

# colour-science 0.4.7: colour.models.eotf_inverse_sRGB and eotf_sRGB
ENCODED = {
    0.0: 0.0,
    0.001: 0.01292,
    0.0031308: 0.040449936,
    0.01: 0.09985282273,
    0.18: 0.4613561295,
    0.5: 0.73535698305,
    0.9: 0.95468717189,
    1.0: 1.0,
}
DECODED = {
    0.0: 0.0,
    0.02: 0.0015479876161,
    0.2: 0.03310476657,
    0.5: 0.21404114048,
    0.8: 0.60382733886,
    1.0: 1.0,
}
TONES = [Exposure(0.8), Bruneton(1.05), Filmic(1.3)]


def test_the_transfer_function_is_that_of_colour_science():
    np.testing.assert_allclose(encode_srgb(jnp.array(list(ENCODED))), list(ENCODED.values()), atol=1e-10)
    np.testing.assert_allclose(decode_srgb(jnp.array(list(DECODED))), list(DECODED.values()), atol=1e-10)


def test_the_transfer_function_is_that_of_an_installed_colour_science():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        colour = pytest.importorskip("colour")
        grid = np.linspace(0.0, 1.0, 1001)
        encoded, decoded = colour.models.eotf_inverse_sRGB(grid), colour.models.eotf_sRGB(grid)
    np.testing.assert_allclose(encode_srgb(jnp.asarray(grid)), encoded, atol=1e-12)
    np.testing.assert_allclose(decode_srgb(jnp.asarray(grid)), decoded, atol=1e-12)


def test_decoding_undoes_encoding_and_bytes_come_back():
    light = jnp.linspace(0.0, 1.0, 500)
    np.testing.assert_allclose(decode_srgb(encode_srgb(light)), light, atol=1e-7)
    code = jnp.arange(256, dtype=jnp.uint8)
    np.testing.assert_array_equal(to_bytes(from_bytes(code)), code)
    wild = jnp.array([-1.0, 0.498, 2.0, jnp.inf, jnp.nan])
    np.testing.assert_array_equal(to_bytes(wild), [0, 127, 255, 255, 0])


def test_brunetons_tone_has_the_published_formula():
    light = jnp.array([1e-4, 0.01, 0.5, 1.4, 1.5, 6.0])
    expected = np.where(light < 1.413, (0.38317 * light) ** (1 / 2.2), 1 - np.exp(-light))
    np.testing.assert_allclose(Bruneton(1.0)(light), expected, rtol=1e-12)
    np.testing.assert_allclose(Bruneton(2.0)(light / 2), expected, rtol=1e-12)


def test_the_filmic_tone_has_the_published_formula_and_reaches_white():
    x = np.array([0.01, 0.18, 1.0, 5.0])
    linear = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
    np.testing.assert_allclose(decode_srgb(Filmic(1.0)(jnp.asarray(x))), linear, atol=1e-7)
    assert Filmic(1.0)(jnp.array(7.2)) < 1.0
    assert Filmic(1.0)(jnp.array(7.25)) > 1.0 - 1e-12


def test_plain_exposure_clips_and_scales():
    np.testing.assert_allclose(
        decode_srgb(Exposure(2.0)(jnp.array([-1.0, 0.1, 0.3, 9.0]))), [0.0, 0.2, 0.6, 1.0], atol=1e-7
    )


@pytest.mark.parametrize("tone", TONES)
def test_tones_start_at_black_never_fall_and_stay_below_white(tone):
    light = jnp.concatenate([jnp.array([-5.0, 0.0]), jnp.logspace(-9, 6, 20000)])
    code = tone(light)
    assert code[0] == code[1] == 0.0
    assert np.all(np.diff(code) >= -1e-15)
    # No step anywhere: neighbours are less than a per mille apart in light.
    assert np.max(np.diff(code)) < 2e-3
    assert float(jnp.max(code)) <= 1.0
    # Strictly rising where a display shows differences.
    middle = (light > 1e-6) & (light < 0.7)
    assert np.all(np.diff(code[middle]) > 0)


@pytest.mark.parametrize("tone", TONES)
def test_derivatives_of_tones_match_finite_differences(tone):
    def value(x):
        return eqx.tree_at(lambda t: t.exposure, tone, x[1])(x[0])

    assert_gradient_matches(value, [[3e-5, 0.7], [0.002, 0.7], [0.2, 0.7], [1.1, 0.7]], rtol=1e-5, step=1e-6)


@pytest.mark.parametrize("function", [*TONES, encode_srgb, decode_srgb])
def test_derivatives_are_finite_at_black_and_at_every_joint(function):
    joints = jnp.array([-1.0, 0.0, 1e-12, 1e-4 / 1.05, 0.0031308, 0.04045, 1.0, 1.413 / 1.05, 1e3, 1e30])
    slopes = jax.vmap(jax.grad(function))(joints)
    assert np.all(np.isfinite(slopes))
    assert np.all(slopes >= 0.0)


def test_distances_between_images_are_what_their_formulas_say():
    a = jnp.array([[0.0, 0.5], [1.0, 0.25]])
    b = jnp.array([[0.1, 0.5], [0.8, 0.25]])
    np.testing.assert_allclose(mean_square_error(a, b), 0.05 / 4)
    np.testing.assert_allclose(mean_absolute_error(a, b), 0.3 / 4)
    np.testing.assert_allclose(largest_error(a, b), 0.2)
    np.testing.assert_allclose(psnr(a, b), 10 * np.log10(4 / 0.05))
    np.testing.assert_allclose(psnr(255 * a, 255 * b, peak=255.0), psnr(a, b))


def test_equal_images_have_infinite_psnr_and_a_finite_gradient():
    a = jnp.full((3, 3), 0.4)
    assert psnr(a, a) == np.inf
    assert np.all(np.isfinite(jax.grad(psnr)(a, a)))
    assert_derivative_matches(lambda x: psnr(x, a), a + 0.1)


def test_structural_similarity_is_that_of_gaussian_windows_from_scipy():
    random = np.random.default_rng(0)
    a = gaussian_filter(random.uniform(size=(40, 50, 3)), (2, 2, 0))
    b = a + 0.05 * random.normal(size=a.shape)

    def window(x):
        return gaussian_filter(x, (1.5, 1.5, 0), truncate=5 / 1.5)[5:-5, 5:-5]

    mean_a, mean_b = window(a), window(b)
    covariance = window(a * b) - mean_a * mean_b
    variances = window(a * a) - mean_a**2 + window(b * b) - mean_b**2
    expected = np.mean(
        (2 * mean_a * mean_b + 1e-4)
        / (mean_a**2 + mean_b**2 + 1e-4)
        * (2 * covariance + 9e-4)
        / (variances + 9e-4)
    )
    found = structural_similarity(jnp.asarray(a), jnp.asarray(b))
    np.testing.assert_allclose(found, expected, rtol=1e-10)
    np.testing.assert_allclose(structural_similarity(jnp.asarray(a), jnp.asarray(a)), 1.0)
    assert expected < 0.9
    with pytest.raises(ValueError, match="`image` must have at least 11 pixels"):
        structural_similarity(jnp.ones((5, 40, 3)), jnp.ones((5, 40, 3)))


@pytest.mark.parametrize("kind", [Exposure, Bruneton, Filmic])
@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan])
def test_an_exposure_must_be_positive(kind, wrong):
    with pytest.raises(ValueError, match="`exposure` must be"):
        kind(wrong)


def test_the_white_becomes_grey_and_green_stays():
    white = jnp.array([1.2, 1.0, 0.8])
    balanced = white_balance(jnp.array([[0.6, 0.5, 0.4], [0.1, 0.2, 0.3]]), white)
    np.testing.assert_allclose(balanced[0], 0.5)
    np.testing.assert_allclose(balanced[1], [0.1 / 1.2, 0.2, 0.3 / 0.8])
    np.testing.assert_allclose(white_balance(balanced, jnp.full(3, 7.0)), balanced)


def test_light_without_blue_leaves_the_picture_finite():
    balanced = white_balance(jnp.array([0.5, 0.5, 0.0]), jnp.array([1.0, 0.5, -0.1]))
    assert np.all(np.isfinite(balanced))


def test_the_derivatives_of_the_white_balance_are_right():
    assert_gradient_matches(
        lambda x: jnp.sum(white_balance(x[:3], x[3:]) ** 2), [[0.3, 0.5, 0.2, 1.1, 0.9, 0.7]], rtol=1e-6
    )
