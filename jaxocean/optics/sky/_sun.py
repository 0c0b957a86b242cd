"""Where the sun stands and how much of its disc is above the horizon."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import safe_sqrt
from ..._types import Scalar

SUN_RADIUS = math.radians(0.5358 / 2.0)
"""Angular radius of the sun [rad] (Hošek & Wilkie 2013)."""


def direction_of(elevation: Scalar, azimuth: Scalar) -> Float[Array, "3"]:
    """Unit vector towards `elevation` above the horizon and `azimuth` [rad] counter-clockwise from +x (east)."""
    azimuth = azimuth.astype(elevation.dtype)
    flat = jnp.cos(elevation)
    return jnp.stack([flat * jnp.cos(azimuth), flat * jnp.sin(azimuth), jnp.sin(elevation)])


def visible_fraction(elevation: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """The share of the sun's disc that is above a flat horizon.

    $$ f = \\frac{1}{\\pi} \\left( \\tfrac{\\pi}{2} + \\arcsin s + s \\sqrt{1 - s^2} \\right), \\quad
    s = e / r_{\\mathrm{sun}} \\in [-1, 1] $$

    Value and derivative are continuous where the disc touches the horizon. Refraction is left out.
    """
    s = elevation / SUN_RADIUS
    inside = jnp.abs(s) < 1.0
    crossing = jnp.where(inside, s, 0.0)
    segment = 0.5 + (jnp.arcsin(crossing) + crossing * safe_sqrt(1.0 - crossing * crossing)) / math.pi
    return jnp.where(inside, segment, jnp.where(s > 0.0, 1.0, 0.0))


def even_disc(
    irradiance: Float[Array, "3"], sun: Float[Array, "*#b 3"], direction: Float[Array, "*b 3"]
) -> Float[Array, "*b 3"]:
    """Radiance of a disc without limb darkening whose whole gives `irradiance`; 0 off it and below the horizon."""
    across = direction - sun.astype(direction.dtype)
    half = 0.5 * jnp.sum(across * across, axis=-1)
    hit = (half <= 2.0 * math.sin(SUN_RADIUS / 2) ** 2) & (direction[..., 2] > 0.0)
    level = irradiance.astype(direction.dtype) / (math.pi * SUN_RADIUS**2)
    return jnp.where(hit[..., None], level, 0.0)
