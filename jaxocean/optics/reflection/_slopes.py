"""The slopes of the facets in one footprint: a Gaussian with a mean and a covariance."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._elementary import exponential, inverse_root


def slope_density(
    slope: Float[Array, "*b 2"], mean: Float[Array, "*b 2"], covariance: Float[Array, "*b 2 2"]
) -> Float[Array, "*b"]:
    """Probability density of a slope, with a different variance along each azimuth.

    $$ p(ζ) = \\frac{1}{2π \\sqrt{\\det C}} \\exp\\left( -\\tfrac12 (ζ - m)^T C^{-1} (ζ - m) \\right) $$

    **Arguments:** `slope` ζ and `mean` m [-], (*b, 2); `covariance` C [-], (*b, 2, 2), symmetric.

    **Returns:** the density per unit of (∂z/∂x, ∂z/∂y), (*b). Where C has no area the density is a spike: 0 with
    derivative 0 is returned there.

    **Source:** Cox & Munk 1954, J. Opt. Soc. Am. 44, without their skewness; Ross, Dion & Potvin 2005, eq. 4.
    """
    x, y = slope[..., 0] - mean[..., 0], slope[..., 1] - mean[..., 1]
    return bivariate_normal(x, y, covariance[..., 0, 0], covariance[..., 1, 1], covariance[..., 0, 1])


def bivariate_normal(
    x: Float[Array, "*b"],
    y: Float[Array, "*b"],
    xx: Float[Array, "*b"],
    yy: Float[Array, "*b"],
    xy: Float[Array, "*b"],
) -> Float[Array, "*b"]:
    """The Gaussian of `slope_density` at deviations (x, y) from its mean, by components."""
    determinant = xx * yy - xy * xy
    proper = determinant > 0.0
    root = inverse_root(jnp.where(proper, determinant, 1.0))
    inverse = root * root
    exponent = -0.5 * inverse * (yy * x * x - 2.0 * xy * x * y + xx * y * y)
    density = root * exponential(jnp.where(proper, exponent, 0.0)) * (0.5 / math.pi)
    return jnp.where(proper, density, 0.0)


def directional_variance(
    covariance: Float[Array, "*b 2 2"], direction: Float[Array, "*b 2"]
) -> Float[Array, "*b"]:
    """Variance of the slope along a horizontal direction.

    $$ σ²(d) = d^T C d $$

    **Arguments:** `covariance` C [-], (*b, 2, 2); `direction` d, unit vectors (*b, 2).

    **Returns:** σ² [-], (*b); for d shorter than 1 the variance times |d|².
    """
    x, y = direction[..., 0], direction[..., 1]
    xy = covariance[..., 0, 1] + covariance[..., 1, 0]
    return covariance[..., 0, 0] * x * x + xy * x * y + covariance[..., 1, 1] * y * y
