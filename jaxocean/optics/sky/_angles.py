"""Angles by polynomials: the library's own arccosine and arctangent cost more than all the rest of a look-up."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import safe_sqrt

ARCCOSINE = (
    1.5707963050,
    -0.2145988016,
    0.0889789874,
    -0.0501743046,
    0.0308918810,
    -0.0170881256,
    0.0066700901,
    -0.0012624911,
)
"""arccos x = √(1 − x) Σ a_i x^i on [0, 1] within 2e-8 rad (Abramowitz & Stegun 1964, 4.4.46)."""

ARCTANGENT = (
    -0.3333314528,
    0.1999355085,
    -0.1420889944,
    0.1065626393,
    -0.0752896400,
    0.0429096138,
    -0.0161657367,
    0.0028662257,
)
"""arctan t = t (1 + Σ a_i t^(2i + 2)) on [−1, 1] within 2e-8 rad (Abramowitz & Stegun 1964, 4.4.49)."""


def angle_between(half_square: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """Angle [rad] between unit vectors a and b from h = |a − b|²/2 = 1 − cos; its derivative is finite everywhere."""
    cosine = 1.0 - half_square
    behind = cosine < 0.0
    x = jnp.abs(cosine)
    polynomial = jnp.full_like(x, ARCCOSINE[-1])
    for coefficient in reversed(ARCCOSINE[:-1]):
        polynomial = polynomial * x + coefficient
    angle = safe_sqrt(jnp.where(behind, 2.0 - half_square, half_square)) * polynomial
    return jnp.where(behind, math.pi - angle, angle)


def azimuth_of(x: Float[Array, "*b"], y: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """Direction [rad] of (x, y), from −π to π; at the origin it is 0 with a finite derivative."""
    steep = jnp.abs(y) > jnp.abs(x)
    # Signed, not absolute, values: so the derivative is right on the axes and on the diagonals too.
    denominator = jnp.where(steep, y, x)
    t = jnp.where(steep, x, y) / jnp.where(denominator != 0.0, denominator, 1.0)
    square = t * t
    polynomial = jnp.full_like(t, ARCTANGENT[-1])
    for coefficient in reversed(ARCTANGENT[:-1]):
        polynomial = polynomial * square + coefficient
    angle = t * (1.0 + square * polynomial)
    side = jnp.where(y < 0.0, -1.0, 1.0)
    return jnp.where(steep, side * (math.pi / 2) - angle, angle + jnp.where(x < 0.0, side * math.pi, 0.0))
