"""The transfer function of sRGB between light and what a file stores."""

import jax.numpy as jnp
from jaxtyping import Array, Float, UInt8

KNEE = 0.0031308
"""Linear value where the straight part meets the power law (IEC 61966-2-1)."""


def encode_srgb(linear: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """Linear light to sRGB code values.

    $$ V = 12.92\\, L \\;\\; (L \\le 0.0031308), \\qquad V = 1.055\\, L^{1/2.4} - 0.055 $$

    Light below 0 gives 0 and above 1 gives 1, without derivative there.

    **Arguments:** `linear`: any shape, 1 is the display's white.

    **Returns:** code values from 0 to 1.

    **Source:** IEC 61966-2-1:1999.
    """
    light = jnp.clip(linear, 0.0, 1.0)
    dark = light <= KNEE
    power = 1.055 * jnp.where(dark, 1.0, light) ** (1.0 / 2.4) - 0.055
    return jnp.where(dark, 12.92 * light, power)


def decode_srgb(code: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """sRGB code values from 0 to 1 to linear light: the inverse of `encode_srgb`, clipped likewise."""
    value = jnp.clip(code, 0.0, 1.0)
    dark = value <= 12.92 * KNEE
    power = ((jnp.where(dark, 1.0, value) + 0.055) / 1.055) ** 2.4
    return jnp.where(dark, value / 12.92, power)


def to_bytes(code: Float[Array, "*b"]) -> UInt8[Array, "*b"]:
    """Code values from 0 to 1 to the nearest of 0 … 255; NaN becomes 0."""
    return jnp.round(255.0 * jnp.clip(jnp.nan_to_num(code), 0.0, 1.0)).astype(jnp.uint8)


def from_bytes(code: UInt8[Array, "*b"]) -> Float[Array, "*b"]:
    """0 … 255 to code values from 0 to 1."""
    return code.astype(jnp.result_type(float)) / 255.0
