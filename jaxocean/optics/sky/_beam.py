"""The sun's direct beam at the surface."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import safe_sqrt
from ..._types import Scalar
from ._dome import between_turbidities
from ._sun import SUN_RADIUS, direction_of
from ._tables import SEGMENTS, tables

CHORDS = np.array([math.sqrt(math.pi) * math.gamma(j / 2 + 1) / math.gamma((j + 3) / 2) for j in range(6)])
"""∫_{−1}^{1} (1 − u²)^{j/2} du: the limb darkening's powers averaged along a horizontal chord of the disc."""

CHEBYSHEV = np.cos(math.pi * (np.arange(6) + 0.5) / 6)
"""Nodes on [−1, 1] for the sun's radiance along the height of its disc."""

TO_POWERS = np.linalg.inv(np.vander(CHEBYSHEV, increasing=True))
"""Values at those nodes to the coefficients of 1, t, t², …"""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(32)


def centre_radiance(turbidity: Scalar, elevation: Float[Array, "*b"]) -> Float[Array, "*b 11"]:
    """Radiance [W m⁻² sr⁻¹ nm⁻¹] that the sun's disc would have at `elevation` [rad] without limb darkening.

    A cubic in each of 45 segments of the elevation, linear in turbidity; the extinction by the air is in it.

    **Source:** Hošek & Wilkie 2013.
    """
    cubics = between_turbidities(tables()["sun_radiance"], turbidity)
    height = jnp.clip(elevation, 0.0, math.pi / 2)
    place = jnp.cbrt(jnp.where(height > 0.0, height, 1.0) * (2.0 / math.pi)) * SEGMENTS
    index = jnp.where(height > 0.0, jnp.clip(jnp.floor(place).astype(jnp.int32), 0, SEGMENTS - 1), 0)
    edges = jnp.asarray((math.pi / 2) * (np.arange(SEGMENTS + 1) / SEGMENTS) ** 3, elevation.dtype)
    s = ((height - edges[index]) / (edges[index + 1] - edges[index]))[..., None]
    c0, c1, c2, c3 = (cubics[index, k] for k in range(4))
    return c0 + s * (c1 + s * (c2 + s * c3))


def beam_irradiance(turbidity: Scalar, elevation: Scalar) -> Float[Array, "11"]:
    """Irradiance [W m⁻² nm⁻¹] across the beam of the part of the disc that is above the horizon.

    $$ E = r^2 \\int_{-1}^{1} L_0(e + r s)\\, [e + r s > 0] \\sum_{j=0}^{5} d_j B_j (1 - s^2)^{(j+1)/2}\\, ds, \\quad
    B_j = \\int_{-1}^{1} (1 - u^2)^{j/2} du $$

    with e the elevation of the disc's centre, r its radius, d_j the limb darkening. The disc is taken as flat.

    **Returns:** one number for each of the eleven wavelengths.
    """
    radius = SUN_RADIUS
    lowest = jnp.clip(-elevation / radius, -1.0, 1.0)
    half = 0.5 * (1.0 - lowest)
    s = lowest + half * (jnp.asarray(NODES, elevation.dtype) + 1.0)
    cosine = safe_sqrt(1.0 - s * s)
    profile = jnp.asarray(tables()["limb_darkening"] * CHORDS, elevation.dtype)
    powers = jnp.stack([cosine ** (j + 1) for j in range(6)], axis=-1)
    radiance = centre_radiance(turbidity.astype(elevation.dtype), elevation + radius * s)
    weights = half * jnp.asarray(WEIGHTS, elevation.dtype)
    return radius * radius * jnp.sum(weights[:, None] * radiance * (powers @ profile.T), axis=0)


def disc_radiance(
    turbidity: Scalar,
    elevation: Scalar,
    azimuth: Scalar,
    direction: Float[Array, "*b 3"],
    colours: Float[Array, "11 c"],
) -> Float[Array, "*b c"]:
    """Radiance [W m⁻² sr⁻¹ nm⁻¹] of the sun's disc with limb darkening; 0 off the disc and below the horizon.

    $$ L = L_0(e + r s) \\sum_{j=0}^{5} d_j \\cos^j\\psi, \\quad
    \\cos\\psi = \\sqrt{1 - \\sin^2\\gamma / \\sin^2 r} $$

    L₀ is interpolated by a polynomial over the part of the disc that is above the horizon, so that a pixel costs no
    look-up.

    **Arguments:** `elevation`, `azimuth`: of the sun's centre [rad]; `colours`: turns the eleven wavelengths into c
    channels.
    """
    dtype = direction.dtype
    turbidity, elevation, azimuth = (a.astype(dtype) for a in (turbidity, elevation, azimuth))
    sun, radius = direction_of(elevation, azimuth), SUN_RADIUS
    rise = jnp.stack([-sun[2] * jnp.cos(azimuth), -sun[2] * jnp.sin(azimuth), jnp.cos(elevation)])
    across = [direction[..., i] - sun[i] for i in range(3)]
    half = 0.5 * (across[0] * across[0] + across[1] * across[1] + across[2] * across[2])
    hit = (half <= 2.0 * math.sin(radius / 2) ** 2) & (direction[..., 2] > 0.0)
    cosine = safe_sqrt(1.0 - half * (2.0 - half) / math.sin(radius) ** 2)
    # The visible part of the disc runs from s = lowest to 1, the polynomials from t = −1 to 1.
    lowest = jnp.clip(-elevation / radius, -1.0, 0.999)
    s = (across[0] * rise[0] + across[1] * rise[1] + across[2] * rise[2]) / radius
    t = jnp.clip(2.0 * (s - lowest) / (1.0 - lowest) - 1.0, -1.0, 1.0)
    nodes = lowest + 0.5 * (1.0 - lowest) * (jnp.asarray(CHEBYSHEV, dtype) + 1.0)
    powers = jnp.asarray(TO_POWERS, dtype) @ centre_radiance(turbidity, elevation + radius * nodes)
    darkening = jnp.asarray(tables()["limb_darkening"], dtype)
    polynomial = jnp.einsum("kw,wj,wc->kjc", powers, darkening, colours.astype(dtype))
    channels = []
    for c in range(colours.shape[1]):
        value = jnp.zeros_like(t)
        for j in range(darkening.shape[1] - 1, -1, -1):
            along = polynomial[-1, j, c] * jnp.ones_like(t)
            for k in range(len(CHEBYSHEV) - 2, -1, -1):
                along = along * t + polynomial[k, j, c]
            value = value * cosine + along
        channels.append(jnp.where(hit, value, 0.0))
    return jnp.stack(channels, axis=-1)
