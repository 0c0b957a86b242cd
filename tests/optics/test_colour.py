"""Spectra become colours as in colour-science.

The reference numbers come from colour-science 0.4.7, with the CIE 1931 2° observer at 1 nm from 360 to 830 nm:

    light = colour.SpectralDistribution(values, wavelengths)
    colour.sd_to_XYZ(light, cmfs=observer, k=1 / integral_of_ybar, method="Integration")
    colour.sd_to_XYZ(light, cmfs=observer, illuminant=colour.SDS_ILLUMINANTS["D65"], method="Integration") / 100
"""

import warnings

import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean.optics import (
    light_to_srgb,
    luminance,
    matching_weights,
    reflectance_to_srgb,
    reflectance_weights,
    srgb_to_xyz,
    xyz_to_srgb,
)

FINE = np.arange(360.0, 831.0)


def black_body(wavelength):
    values = 1.0 / (wavelength**5 * np.expm1(1.4387769e7 / (5000.0 * wavelength)))
    return values / np.max(1.0 / (FINE**5 * np.expm1(1.4387769e7 / (5000.0 * FINE))))


def green(wavelength):
    return np.exp(-(((wavelength - 550.0) / 40.0) ** 2))


def ramp(wavelength):
    return (wavelength - 300.0) / 530.0


SPECTRA = [
    (black_body, (0.964680, 0.982869, 0.847805), (0.914648, 0.981856, 0.927466)),
    (green, (0.311155, 0.553032, 0.0330574), (0.306715, 0.566039, 0.0364480)),
    (ramp, (0.512785, 0.490928, 0.290783), (0.478387, 0.484490, 0.319636)),
]


@pytest.mark.parametrize(("spectrum", "light", "reflected"), SPECTRA)
@pytest.mark.parametrize(("step", "within"), [(1.0, 5e-4), (10.0, 2.5e-3)])
def test_spectra_have_the_tristimulus_values_of_colour_science(spectrum, light, reflected, step, within):
    grid = np.arange(360.0, 831.0, step)
    np.testing.assert_allclose(spectrum(grid) @ matching_weights(grid), light, atol=within)
    np.testing.assert_allclose(spectrum(grid) @ reflectance_weights(grid), reflected, atol=within)


def test_the_tables_and_the_matrix_are_those_of_colour_science():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        colour = pytest.importorskip("colour")
        observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].align(
            colour.SpectralShape(360, 830, 5)
        )
        srgb = colour.RGB_COLOURSPACES["sRGB"].copy()
        srgb.use_derived_transformation_matrices(True)
        xyz = jnp.array([[0.3, 0.4, 0.1], [0.9, 1.0, 1.1]])
        expected = xyz @ srgb.matrix_XYZ_to_RGB.T
    from jaxocean.optics._colour import observer as table

    np.testing.assert_allclose(table()[:, 1:4], observer.values, atol=1e-9)
    np.testing.assert_allclose(xyz_to_srgb(xyz), expected, atol=1e-7)


def test_light_of_one_everywhere_has_luminance_one_however_it_is_sampled():
    for grid in (np.array([300.0, 900.0]), np.array([400.0, 550.0, 551.0, 700.0]), FINE):
        np.testing.assert_allclose(luminance(light_to_srgb(grid, jnp.ones(grid.size))), 1.0, rtol=1e-9)


def test_a_perfect_reflector_is_white_and_a_red_one_is_red():
    grid = np.array([400.0, 550.0, 580.0, 600.0, 700.0])
    np.testing.assert_allclose(reflectance_to_srgb(grid, jnp.ones(5)), 1.0, atol=5e-4)
    red, other, blue = reflectance_to_srgb(grid, jnp.array([0.0, 0.0, 0.0, 1.0, 1.0]))
    assert red > 0.5
    assert max(float(other), float(blue)) < 0.2


def test_colours_come_back_from_xyz():
    rgb = jnp.asarray(np.random.default_rng(0).uniform(-0.2, 1.5, (7, 3)))
    np.testing.assert_allclose(xyz_to_srgb(srgb_to_xyz(rgb)), rgb, atol=1e-12)
    np.testing.assert_allclose(srgb_to_xyz(rgb)[:, 1], luminance(rgb), atol=1e-14)
    # The white of sRGB is D65: x = 0.3127, y = 0.3290.
    x, y, z = srgb_to_xyz(jnp.ones(3))
    np.testing.assert_allclose([x / (x + y + z), y / (x + y + z)], [0.3127, 0.3290], atol=1e-12)


@pytest.mark.parametrize("wrong", [[500.0], [500.0, 400.0], [400.0, 400.0, 500.0]])
def test_wavelengths_must_increase(wrong):
    with pytest.raises(ValueError, match="`wavelengths` must be at least two increasing"):
        matching_weights(np.array(wrong))
