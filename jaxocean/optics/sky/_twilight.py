"""How the dome darkens after sunset."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

DEPTHS = np.radians([0.0, 6.0, 12.0, 18.0])
"""Depth of the sun below the horizon [rad]: sunset, end of civil, nautical and astronomical twilight."""

ILLUMINANCE = np.array([2.88, 0.533, -2.094, -3.190])
"""log10 of the illuminance of the ground [lux] at those depths (Seidelmann 1992, table 9.2)."""

SLOPES = np.degrees([-0.2473, -0.4934, -0.2880, 0.0])
"""Its derivative [1/rad] there, by the same polynomials; 0 where only the night sky is left."""


def twilight(elevation: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """The dome's brightness relative to that at sunset: 1 above the horizon, about 1/220 at −6°, 1e-6 below −18°.

    log10 of it is the cubic Hermite interpolation between the four depths.

    **Source:** P. K. Seidelmann (ed.), Explanatory Supplement to the Astronomical Almanac, 1992, §9.3.
    """
    depth = jnp.clip(-elevation, 0.0, float(DEPTHS[-1]))
    width = float(DEPTHS[1])
    place = depth / width
    index = jnp.clip(jnp.floor(place).astype(jnp.int32), 0, 2)
    s = place - index.astype(place.dtype)
    level = jnp.asarray(ILLUMINANCE - ILLUMINANCE[0], elevation.dtype)
    slope = jnp.asarray(SLOPES * width, elevation.dtype)
    start, end = level[index], level[index + 1]
    rise = slope[index] * (1.0 - s) - slope[index + 1] * s
    step = start + (end - start) * s * s * (3.0 - 2.0 * s)
    return jnp.exp(math.log(10.0) * (step + s * (1.0 - s) * rise))
