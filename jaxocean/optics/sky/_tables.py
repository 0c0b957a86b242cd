"""The coefficient tables of the sky model, read once from the file beside this one."""

import functools
from pathlib import Path
from types import MappingProxyType

import numpy as np

WAVELENGTHS = np.arange(320.0, 721.0, 40.0)
"""The wavelengths [nm] at which the spectral tables hold."""

SEGMENTS = 45
"""The sun's radiance is a cubic in its elevation on each of so many segments, equal in the cube root of it."""


@functools.cache
def tables() -> MappingProxyType:
    """The arrays of `hosek_wilkie.npz`, float32.

    - `rgb_shape` (10, 2, 6, 3, 9), `spectral_shape` (10, 2, 6, 11, 9): the nine coefficients of the formula at
      turbidity 1 … 10, albedo 0 and 1, six control points in the sun's elevation, per channel or wavelength;
    - `rgb_radiance` (10, 2, 6, 3), `spectral_radiance` (10, 2, 6, 11): its factor;
    - `sun_radiance` (10, 45, 4, 11): at turbidity 1 … 10, the cubics in the fraction of a segment;
    - `limb_darkening` (11, 6): polynomials in the cosine at the sun's surface.

    Origin and licence: `hosek_wilkie.txt`.
    """
    with np.load(Path(__file__).with_name("hosek_wilkie.npz"), allow_pickle=False) as archive:
        return MappingProxyType({name: archive[name] for name in archive.files})
