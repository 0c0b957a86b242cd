"""How often a point of the sea starts to break."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from ..._numerics import as_leaf, safe_divide, safe_sqrt
from ..._types import Scalar, ScalarLike
from ._motion import StrainMotion
from ._rays import Rays, cast_rays, to_sdc

LATITUDES, LONGITUDES = 96, 128


def breaking_rate(motion: StrainMotion, threshold: ScalarLike) -> Scalar:
    """The mean rate at which j falls below ε at one point of the rest plane.

    $$ ν = E[\\max(−\\dot j, 0)\\, δ(j − ε)] = E[\\sqrt{g^T \\dot C g/2π}\\; δ(j − ε)], \\quad
       g = ∇j = (1 + b, 1 + a, −2c) $$

    since, given the strain, dj/dt is Gaussian of mean 0 and variance gᵀĊg with the `rate_covariance` Ċ. The mean over
    the surface j = ε is taken along rays from the state of rest, by quadrature over their directions.

    **Arguments:** `motion`; `threshold` ε [-] below 1 (the rate is 0 from there on).

    **Returns:** ν [1/s]. A point breaks for W_rest/ν on the average.

    **Source:** Rice 1945, Bell Syst. Tech. J. 24, for the rate of crossings; the Jacobian in place of a Gaussian
    process.
    """
    return _breaking_rate(motion.statistics.covariance, motion.rate_covariance, as_leaf(threshold))


@jax.jit
def _breaking_rate(
    covariance: Float[Array, "3 3"], rate_covariance: Float[Array, "3 3"], threshold: Scalar
) -> Scalar:
    rays = cast_rays(covariance, threshold, LATITUDES, LONGITUDES)
    changes = to_sdc(rate_covariance)
    first = _flux(rays, changes, rays.enter, rays.breaks)
    second = _flux(rays, changes, rays.leave, rays.folds)
    return jnp.sum(rays.solid_angle * (first + second))


def _flux(
    rays: Rays, changes: Float[Array, "3 3"], distance: Float[Array, " ray"], there: Bool[Array, " ray"]
) -> Float[Array, " ray"]:
    """ρ² φ₃(ρ) E[max(−dj/dt, 0)]/|dj/dρ| where a ray passes the threshold, 0 for one that does not."""
    rho = jnp.where(there, distance, 1.0)
    strain = rays.along * rho[:, None] + jnp.asarray([1.0, 0.0, 0.0], rho.dtype)
    gradient = 2 * strain * jnp.asarray([1.0, -1.0, -1.0], rho.dtype)
    speed = safe_sqrt(jnp.einsum("ri,ij,rj->r", gradient, changes, gradient) * (0.5 / np.pi))
    density = rho**2 * jnp.exp(-0.5 * rho**2) * (2 * np.pi) ** -1.5
    return jnp.where(there, density * safe_divide(speed, rays.slope), 0.0)
