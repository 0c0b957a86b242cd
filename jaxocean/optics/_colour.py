"""Spectra become colours: spectrum → CIE XYZ → linear sRGB."""

import functools
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

SRGB_TO_XYZ = np.array(
    [
        [0.41239079926595934, 0.357584339383878, 0.1804807884018343],
        [0.21263900587151027, 0.715168678767756, 0.07219231536073371],
        [0.01933081871559182, 0.11919477979462598, 0.9505321522496607],
    ]
)
"""Linear sRGB to XYZ, from the primaries and the white D65 of IEC 61966-2-1 without the rounding of the standard."""

XYZ_TO_SRGB = np.linalg.inv(SRGB_TO_XYZ)
"""XYZ to linear sRGB."""


@functools.cache
def observer() -> np.ndarray:
    """The rows (wavelength [nm], x̄, ȳ, z̄, D65) of `cie_1931.csv`, every 5 nm from 360 to 830 nm.

    The CIE 1931 2° standard observer and the illuminant D65 (its last value held beyond 780 nm), taken from
    colour-science 0.4.7.
    """
    return np.loadtxt(Path(__file__).with_name("cie_1931.csv"), delimiter=",", skiprows=1)


def _hats(wavelengths: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Each sample's share (w, fine) of the linear interpolation at the wavelengths `fine`; held at both ends."""
    return np.stack([np.interp(fine, wavelengths, unit) for unit in np.eye(len(wavelengths))])


def _weights(wavelengths: np.ndarray, illuminant: bool) -> np.ndarray:
    grid = np.asarray(wavelengths, np.float64)
    if grid.ndim != 1 or grid.size < 2 or not np.all(np.diff(grid) > 0):
        raise ValueError(
            "Argument `wavelengths` must be at least two increasing numbers [nm], "
            f"but is {np.array2string(grid, threshold=8)}."
        )
    table = observer()
    fine = np.union1d(np.arange(table[0, 0], table[-1, 0] + 0.5), grid[(grid > 360.0) & (grid < 830.0)])
    x, y, z, light = (np.interp(fine, table[:, 0], table[:, i]) for i in range(1, 5))
    light = light if illuminant else np.ones_like(light)
    step = np.zeros_like(fine)
    step[1:] += 0.5 * np.diff(fine)
    step[:-1] += 0.5 * np.diff(fine)
    matching = np.stack([x, y, z], axis=1) * (light * step)[:, None]
    return _hats(grid, fine) @ matching / np.sum(y * light * step)


def matching_weights(wavelengths: np.ndarray) -> np.ndarray:
    """Weights that turn a sampled spectrum of light into XYZ.

    $$ X = \\frac{\\int L(\\lambda)\\, \\bar x(\\lambda)\\, d\\lambda}{\\int \\bar y(\\lambda)\\, d\\lambda} $$

    and likewise Y and Z: a spectrum that is 1 everywhere has Y = 1. The spectrum is linear between its samples and
    held at both ends.

    **Arguments:** `wavelengths`: (w,) increasing [nm].

    **Returns:** (w, 3), float64: XYZ = spectrum @ weights.

    **Raises:** `ValueError` if the wavelengths do not increase.

    **Source:** CIE 015:2018, §7.
    """
    return _weights(wavelengths, illuminant=False)


def reflectance_weights(wavelengths: np.ndarray) -> np.ndarray:
    """Weights that turn a sampled reflectance into the XYZ that it shows under D65.

    As `matching_weights` with the illuminant as a factor in both integrals: a reflectance of 1 everywhere is white,
    that is (1, 1, 1) in linear sRGB but for the rounding of the published tables, under 5e-4.

    **Arguments:** `wavelengths`: (w,) increasing [nm]. **Returns:** (w, 3), float64.
    **Raises:** `ValueError` if the wavelengths do not increase.
    """
    return _weights(wavelengths, illuminant=True)


def xyz_to_srgb(xyz: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
    """CIE XYZ to linear sRGB; colours outside of the gamut have negative parts."""
    return xyz @ jnp.asarray(XYZ_TO_SRGB.T, xyz.dtype)


def srgb_to_xyz(rgb: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
    """Linear sRGB to CIE XYZ."""
    return rgb @ jnp.asarray(SRGB_TO_XYZ.T, rgb.dtype)


def luminance(rgb: Float[Array, "*b 3"]) -> Float[Array, "*b"]:
    """Luminance Y of a linear sRGB colour, in the colour's own unit."""
    return rgb @ jnp.asarray(SRGB_TO_XYZ[1], rgb.dtype)


def light_to_srgb(wavelengths: np.ndarray, spectrum: Float[Array, "*b w"]) -> Float[Array, "*b 3"]:
    """The linear sRGB colour of a spectrum of light.

    **Arguments:** `wavelengths`: (w,) increasing [nm]; `spectrum`: at those, per nm.

    **Returns:** (*b, 3) in the spectrum's unit, such that a spectrum of 1 has the luminance 1 (and is a little
    reddish: equal energy is not the white D65).

    **Raises:** `ValueError` if the wavelengths do not increase.
    """
    return spectrum @ jnp.asarray(matching_weights(wavelengths) @ XYZ_TO_SRGB.T, spectrum.dtype)


def reflectance_to_srgb(wavelengths: np.ndarray, reflectance: Float[Array, "*b w"]) -> Float[Array, "*b 3"]:
    """The linear sRGB reflectance of a spectral reflectance, as seen under D65; 1 everywhere is white.

    **Arguments:** `wavelengths`: (w,) increasing [nm]; `reflectance`: at those [-].
    **Raises:** `ValueError` if the wavelengths do not increase.
    """
    return reflectance @ jnp.asarray(reflectance_weights(wavelengths) @ XYZ_TO_SRGB.T, reflectance.dtype)
