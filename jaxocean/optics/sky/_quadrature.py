"""The integral over the dome, by a few well-placed directions."""

import math
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._types import Scalar

HEIGHTS, HEIGHT_WEIGHTS = np.polynomial.legendre.leggauss(32)
AZIMUTHS = 64


def dome_irradiance(
    radiance: Callable[[Float[Array, "*b 3"]], Float[Array, "*b c"]], azimuth: Scalar
) -> Float[Array, "c"]:
    """∫ L cosθ dΩ over the upper half of the directions.

    Gauss–Legendre with 32 nodes in √cosθ, which is what the model's horizon asks for, times 64 azimuths around the
    sun's.

    **Arguments:** `radiance`: of directions (*b, 3); `azimuth`: of the sun [rad].
    """
    q = jnp.asarray(0.5 * (HEIGHTS + 1.0), azimuth.dtype)[:, None]
    weight = (
        jnp.asarray(0.5 * HEIGHT_WEIGHTS, azimuth.dtype)[:, None] * 2.0 * q**3 * (2.0 * math.pi / AZIMUTHS)
    )
    around = azimuth + jnp.asarray(np.arange(AZIMUTHS) * (2.0 * math.pi / AZIMUTHS), azimuth.dtype)
    upward = jnp.broadcast_to(q * q, (q.shape[0], AZIMUTHS))
    flat = jnp.sqrt(1.0 - q**4)
    nodes = jnp.stack([flat * jnp.cos(around), flat * jnp.sin(around), upward], axis=-1)
    return jnp.sum(weight[..., None] * radiance(nodes), axis=(0, 1))
