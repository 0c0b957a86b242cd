"""The shapes of Pierson–Moskowitz and JONSWAP, and what they integrate to."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._constants import GRAVITY
from .._numerics import safe_sqrt
from .._types import Scalar

LONGEST = 4.5  # f_p/f beyond which exp(−1.25 (f_p/f)⁴) < 1e-222 counts as 0
DEVIATIONS = 8.0  # of the peak's Gaussian: beyond it the enhancement is 1 to rounding

# Gauss–Legendre nodes on one side of the peak, in standard deviations from it.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)
PEAK_NODES, PEAK_WEIGHTS = 0.5 * DEVIATIONS * (_NODES + 1), 0.5 * DEVIATIONS * _WEIGHTS


def pierson_moskowitz_shape(ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """r⁻⁵ exp(−1.25 r⁻⁴) of r = f/f_p > 0; its integral over r is 1/5."""
    far = ratio * LONGEST <= 1
    inverse = 1 / jnp.where(far, 1.0, ratio)
    return jnp.where(far, 0.0, inverse**5 * jnp.exp(-1.25 * inverse**4))


def log_enhancement(
    ratio: Float[Array, "*k"], enhancement: Scalar, width_below: Scalar, width_above: Scalar
) -> Float[Array, "*k"]:
    """ln γ · exp(−(r − 1)²/(2σ²)), σ = `width_below` for r ≤ 1 and `width_above` beyond."""
    width = jnp.where(ratio <= 1, width_below, width_above)
    return jnp.log(enhancement) * jnp.exp(-0.5 * ((ratio - 1) / width) ** 2)


def jonswap_integral(enhancement: Scalar, width_below: Scalar, width_above: Scalar) -> Scalar:
    """∫ r⁻⁵ exp(−1.25 r⁻⁴) γ^Γ dr: 1/5 and what the enhancement adds, by quadrature on both sides."""
    t = jnp.asarray(PEAK_NODES, width_below.dtype)
    growth = jnp.expm1(jnp.log(enhancement) * jnp.exp(-0.5 * t**2))
    # No width keeps the node from crossing r = 0: the shape is 0 there.
    below = pierson_moskowitz_shape(jnp.maximum(1 - width_below * t, 1e-6))
    above = pierson_moskowitz_shape(1 + width_above * t)
    weights = jnp.asarray(PEAK_WEIGHTS, t.dtype)
    return 0.2 + jnp.sum(weights * growth * (width_below * below + width_above * above))


def height_from_alpha(alpha: Scalar, peak_period: Scalar, integral: Scalar | float) -> Scalar:
    """Hs [m] of E(f) = α g² (2π)⁻⁴ f_p⁻⁵ S(f/f_p), where S integrates to `integral`."""
    return 4 * safe_sqrt(alpha * integral) * GRAVITY * (peak_period / (2 * jnp.pi)) ** 2


def alpha_from_height(
    significant_wave_height: Scalar, peak_period: Scalar, integral: Scalar | float
) -> Scalar:
    """The Phillips constant α [-] that goes with Hs [m]: the inverse of `height_from_alpha`."""
    return (significant_wave_height / (4 * GRAVITY * (peak_period / (2 * jnp.pi)) ** 2)) ** 2 / integral
