"""The formula of the sky dome and the interpolation of its coefficients."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import safe_sqrt
from ..._types import Scalar
from ._angles import angle_between

LOWEST = 1e-4
"""Below this elevation [rad] a parabola replaces the cube root, whose derivative at the horizon is infinite."""


def elevation_coordinate(elevation: Scalar) -> Scalar:
    """x = (2e/π)^(1/3), the coordinate along which the control points lie; 0 below the horizon.

    Within `LOWEST` above the horizon it is the parabola that joins the cube root with the same slope, so that the
    derivative is finite everywhere.
    """
    steep = elevation < LOWEST
    root = jnp.cbrt(jnp.where(steep, LOWEST, jnp.minimum(elevation, math.pi / 2)) * (2.0 / math.pi))
    s = jnp.clip(elevation / LOWEST, 0.0, 1.0)
    return jnp.where(steep, root * s * (5.0 - 2.0 * s) / 3.0, root)


def between_turbidities(table: np.ndarray, turbidity: Scalar) -> Float[Array, "..."]:
    """Linear interpolation between the tables for turbidity 1, 2, … 10."""
    place = jnp.clip(turbidity, 1.0, 10.0) - 1.0
    index = jnp.clip(jnp.floor(place).astype(jnp.int32), 0, table.shape[0] - 2)
    fraction = place - index.astype(place.dtype)
    stack = jnp.asarray(table, turbidity.dtype)
    return (1.0 - fraction) * stack[index] + fraction * stack[index + 1]


def coefficients(
    table: np.ndarray, turbidity: Scalar, albedo: Float[Array, "c"], elevation: Scalar
) -> Float[Array, "..."]:
    """The coefficients of each channel: linear in turbidity and albedo, a quintic Bézier curve in the elevation.

    $$ \\sum_{i=0}^{5} \\binom{5}{i} x^i (1 - x)^{5 - i} c_i, \\quad x = (2 e / \\pi)^{1/3} $$

    **Arguments:** `table`: (10, 2, 6, c, …); `albedo`: of the ground, per channel; `elevation`: of the sun [rad].

    **Returns:** (c, …). **Source:** Hošek & Wilkie 2012, §5.
    """
    both = between_turbidities(table, turbidity)
    share = albedo.astype(both.dtype).reshape(-1, *([1] * (both.ndim - 3)))
    control = (1.0 - share) * both[0] + share * both[1]
    x = elevation_coordinate(elevation).astype(both.dtype)
    bernstein = jnp.stack([math.comb(5, i) * x**i * (1.0 - x) ** (5 - i) for i in range(6)])
    return jnp.tensordot(bernstein, control, 1)


def dome_radiance(
    direction: Float[Array, "*b 3"],
    sun: Float[Array, "3"],
    shape: Float[Array, "c 9"],
    factor: Float[Array, "c"],
) -> Float[Array, "*b c"]:
    """Radiance of the dome.

    $$ L = r \\left(1 + A e^{B / (\\cos\\theta + 0.01)}\\right)
    \\left(C + D e^{E \\gamma} + F \\cos^2\\gamma + G \\chi(H, \\gamma) + I \\sqrt{\\cos\\theta}\\right), \\quad
    \\chi = \\frac{1 + \\cos^2\\gamma}{(1 + H^2 - 2 H \\cos\\gamma)^{3/2}} $$

    with θ the angle from the zenith and γ that from the sun. **Source:** Hošek & Wilkie 2012, eq. 8.
    """
    sun, shape, factor = (a.astype(direction.dtype) for a in (sun, shape, factor))
    upward = jnp.abs(direction[..., 2])
    across = (direction[..., 0] - sun[0], direction[..., 1] - sun[1], upward - sun[2])
    half = 0.5 * (across[0] * across[0] + across[1] * across[1] + across[2] * across[2])
    angle, cosine = angle_between(half), 1.0 - half
    square, haze, root = cosine * cosine, 1.0 / (upward + 0.01), safe_sqrt(upward)
    channels = []
    # Each channel is one contiguous loop over directions; with the channels innermost it is several times slower.
    for k in range(factor.shape[0]):
        a, b, c, d, e, f, g, i, h = shape[k]
        lobe = (1.0 - h) * (1.0 - h) + 2.0 * h * half  # h stays below 0.91 in the whole range of the model
        chi = (1.0 + square) / (lobe * jnp.sqrt(lobe))
        scattered = c + d * jnp.exp(e * angle) + f * square + g * chi + i * root
        channels.append(factor[k] * (1.0 + a * jnp.exp(b * haze)) * scattered)
    return jnp.stack(channels, axis=-1)
