"""Integrals over the dome and means over a lobe, by a few well-placed directions."""

import math
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import safe_divide, safe_sqrt
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


def lobe_mean(
    radiance: Callable[[Float[Array, "*b 3"]], Float[Array, "*b c"]],
    direction: Float[Array, "*b 3"],
    variance: Float[Array, "*b"],
) -> Float[Array, "*b c"]:
    """Mean over a round Gaussian lobe by the rule of degree five: half at the axis, a twelfth at six directions 2σ off.

    **Source:** Radon's seven points for a Gaussian weight in the plane, as in Stroud (1971), E₂^{r²}.
    """
    x, y, z = direction[..., 0], direction[..., 1], direction[..., 2]
    flat = safe_sqrt(x * x + y * y)
    overhead = flat < 1e-6
    east = jnp.where(overhead, 1.0, safe_divide(x, flat))
    north = jnp.where(overhead, 0.0, safe_divide(y, flat))
    sideways = jnp.stack([-north, east, jnp.zeros_like(z)], axis=-1)
    up = jnp.stack([-z * east, -z * north, flat], axis=-1)
    turn = 2.0 * safe_sqrt(variance.astype(direction.dtype))[..., None]
    around = [
        jnp.cos(turn) * direction
        + jnp.sin(turn) * (math.cos(k * math.pi / 3) * sideways + math.sin(k * math.pi / 3) * up)
        for k in range(6)
    ]
    weights = jnp.asarray([1 / 2] + [1 / 12] * 6, direction.dtype)
    return jnp.tensordot(weights, radiance(jnp.stack([direction, *around])), 1)
