"""How sea water absorbs and scatters light."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._types import Scalar

WAVELENGTHS = np.arange(400.0, 701.0, 10.0)
"""Wavelengths λ [nm] of the tables below."""

# Absorption of pure water a_w [1/m] at WAVELENGTHS: Pope & Fry 1997, Appl. Opt. 36, table 3.
# fmt: off
PURE_WATER_ABSORPTION = np.array([
    0.00663, 0.00473, 0.00454, 0.00495, 0.00635, 0.00922, 0.00979, 0.0106, 0.0127, 0.0150,
    0.0204, 0.0325, 0.0409, 0.0434, 0.0474, 0.0565, 0.0619, 0.0695, 0.0896, 0.1351,
    0.2224, 0.2644, 0.2755, 0.2916, 0.3108, 0.340, 0.410, 0.439, 0.465, 0.516,
    0.624,
])

# Absorption of phytoplankton [-], relative to that at 440 nm: Prieur & Sathyendranath 1981, Limnol. Oceanogr. 26.
CHLOROPHYLL_ABSORPTION = np.array([
    0.687, 0.828, 0.913, 0.973, 1.000, 0.944, 0.917, 0.870, 0.798, 0.750,
    0.668, 0.618, 0.528, 0.474, 0.416, 0.357, 0.294, 0.276, 0.291, 0.282,
    0.236, 0.252, 0.276, 0.317, 0.334, 0.356, 0.441, 0.595, 0.502, 0.329,
    0.215,
])
# fmt: on


def absorption(chlorophyll: Scalar) -> Float[Array, "wavelength"]:
    """Absorption coefficient of open-ocean water.

    $$ a = (a_w + 0.06\\, a_c^*\\, C^{0.65}) (1 + 0.2\\, e^{-0.014 (λ - 440)}) $$

    The second factor is yellow substance that goes with the phytoplankton.

    **Arguments:** `chlorophyll` C [mg/m³].

    **Returns:** a [1/m] at `WAVELENGTHS`.

    **Source:** Prieur & Sathyendranath 1981, Limnol. Oceanogr. 26; Morel 1991, Prog. Oceanogr. 26, eq. 5, with a_w of
    Pope & Fry 1997, Appl. Opt. 36.
    """
    water, plankton, yellow = (
        jnp.asarray(table, chlorophyll.dtype)
        for table in (
            PURE_WATER_ABSORPTION,
            0.06 * CHLOROPHYLL_ABSORPTION,
            1.0 + 0.2 * np.exp(-0.014 * (WAVELENGTHS - 440.0)),
        )
    )
    return (water + plankton * chlorophyll**0.65) * yellow


def backscatter(chlorophyll: Scalar) -> Float[Array, "wavelength"]:
    """Backscattering coefficient of open-ocean water.

    $$ b_b = \\tfrac12 b_w + 0.30\\, C^{0.62} \\left( 0.002 + 0.02 (\\tfrac12 - \\tfrac14 \\log_{10} C)
    \\frac{550}{λ} \\right), \\quad b_w = 0.00288 (λ / 500)^{-4.32} $$

    **Arguments:** `chlorophyll` C [mg/m³], above 0.

    **Returns:** b_b [1/m] at `WAVELENGTHS`.

    **Source:** Morel 1988, J. Geophys. Res. 93, eq. 13–15; b_w of salt water: Morel 1974.
    """
    water = jnp.asarray(0.5 * 0.00288 * (WAVELENGTHS / 500.0) ** -4.32, chlorophyll.dtype)
    reddening = jnp.asarray(550.0 / WAVELENGTHS, chlorophyll.dtype)
    # Above 100 mg/m³ the particles' backscattered share would be negative in the blue.
    slope = jnp.maximum(0.5 - 0.25 * jnp.log10(chlorophyll), 0.0)
    return water + 0.30 * chlorophyll**0.62 * (0.002 + 0.02 * slope * reddening)
