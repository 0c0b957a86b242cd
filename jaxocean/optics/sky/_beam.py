"""The sun's direct beam at the surface."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import safe_sqrt
from ..._types import Scalar
from ._dome import between_turbidities
from ._sun import SUN_RADIUS
from ._tables import SEGMENTS, tables

CHORDS = np.array([math.sqrt(math.pi) * math.gamma(j / 2 + 1) / math.gamma((j + 3) / 2) for j in range(6)])
"""∫_{−1}^{1} (1 − u²)^{j/2} du: the limb darkening's powers averaged along a horizontal chord of the disc."""

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
    turbidity: Scalar, sun: Float[Array, "3"], direction: Float[Array, "*b 3"]
) -> Float[Array, "*b 11"]:
    """Radiance [W m⁻² sr⁻¹ nm⁻¹] of the sun's disc with limb darkening; 0 off the disc and below the horizon.

    $$ L = L_0(e) \\sum_{j=0}^{5} d_j \\cos^j\\psi, \\quad
    \\cos\\psi = \\sqrt{1 - \\sin^2\\gamma / \\sin^2 r} $$
    """
    sun, turbidity = sun.astype(direction.dtype), turbidity.astype(direction.dtype)
    across = direction - sun
    half = 0.5 * jnp.sum(across * across, axis=-1)
    square = half * (2.0 - half) / math.sin(SUN_RADIUS) ** 2
    upward = direction[..., 2]
    hit = (half <= 2.0 * math.sin(SUN_RADIUS / 2) ** 2) & (upward > 0.0)
    cosine = safe_sqrt(1.0 - square)[..., None]
    darkening = jnp.asarray(tables()["limb_darkening"], direction.dtype)
    limb = jnp.broadcast_to(darkening[:, 5], (*cosine.shape[:-1], darkening.shape[0]))
    for j in range(4, -1, -1):
        limb = limb * cosine + darkening[:, j]
    elevation = jnp.arctan2(upward, safe_sqrt(1.0 - upward * upward))
    return jnp.where(hit[..., None], centre_radiance(turbidity, elevation) * limb, 0.0)
