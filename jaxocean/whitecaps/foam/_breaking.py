"""The life of one point of the sea: how much, how often and how regularly it breaks."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.special import ndtr
from jaxtyping import Array, Float

from ..._numerics import as_leaf, safe_sqrt
from ..._types import Scalar, ScalarLike
from .._closures import ExactClosure
from ._motion import StrainMotion
from ._rate import breaking_rate
from ._rays import cast_rays, factor, to_sdc

LATITUDES, LONGITUDES, DEPTHS = 24, 48, 6
MOST = 1024
"""Directions, Gauss–Laguerre nodes along each, and how many nodes are kept, those of the largest weight first."""

INNER = 8
"""Gauss–Hermite nodes for each of d and c."""

SHORT, LONG = 32, 64
"""Lags up to `TURN` mean durations of breaking, and beyond."""

TURN = 3.0


class PointBreaking(eqx.Module):
    """Statistics of breaking at one point of the rest plane, made by `point_breaking`.

    **Arguments:**

    - `rest`, `projected`: active coverage W [-] in both measures (`ExactClosure`).
    - `rate`: ν [1/s], how often the point starts to break (`breaking_rate`).
    - `lags` [s], `weights` [s]: a quadrature over time.
    - `recurrence`: κ(t) = P(breaks at t | breaks at 0) [-] at the lags; None where it is not asked for.
    """

    rest: Float[Array, "*b"]
    projected: Float[Array, "*b"]
    rate: Float[Array, "*b"]
    lags: Float[Array, "*b lag"] | None = None
    weights: Float[Array, "*b lag"] | None = None
    recurrence: Float[Array, "*b lag"] | None = None

    @property
    def duration(self) -> Float[Array, "*b"]:
        """How long a point breaks on the average, W_rest/ν [s]: short against the life of a breaker, which moves on."""
        return self.rest / self.rate

    @property
    def interval(self) -> Float[Array, "*b"]:
        """How long a point waits on the average from one breaker's end to the next one's start [s]."""
        return (1 - self.rest) / self.rate


def point_breaking(
    motion: StrainMotion, threshold: ScalarLike, *, horizon: float | int | None = None
) -> PointBreaking:
    """How much and how often a point breaks and, with a `horizon`, how soon it breaks again. No FFT, no sampling.

    $$ κ(t) = P(j(t) < ε | j(0) < ε) $$

    is the mean, over the strains x that break now, of P(j(t) < ε | x), where the strain at t given x is Gaussian of
    mean C(t)C⁻¹x and covariance C − C(t)C⁻¹C(t).

    **Arguments:** `motion`; `threshold` ε [-]; `horizon` [s]: the longest lag of κ, several times the foam's decay
    time; None for no recurrence (`PoissonFoam` needs none).

    **Returns:** `PointBreaking`, differentiable in the motion and ε.

    **Raises:** `ValueError` for a horizon that is not positive.
    """
    if horizon is not None and not horizon > 0:
        raise ValueError(f"Argument `horizon` must be greater than 0 s, but is {horizon:g}.")
    stats = motion.statistics
    level = as_leaf(threshold).astype(motion.weights.dtype)
    rest, projected = ExactClosure("rest")(stats, level), ExactClosure("projected")(stats, level)
    rate = breaking_rate(motion, level)
    if horizon is None:
        return PointBreaking(rest, projected, rate)
    lags, weights = _lags(jax.lax.stop_gradient(rest / rate), float(horizon))
    return PointBreaking(rest, projected, rate, lags, weights, _recurrence(motion, level, lags))


def _lags(duration: Scalar, horizon: float) -> tuple[Float[Array, " lag"], Float[Array, " lag"]]:
    """Nodes and weights [s] on (0, horizon): dense while the first breaker lasts, then as the logarithm of time."""
    turn = jnp.clip(TURN * duration, 1e-4 * horizon, 0.5 * horizon)
    x, w = (jnp.asarray(0.5 * each, duration.dtype) for each in np.polynomial.legendre.leggauss(SHORT))
    early, early_weights = turn * (x + 0.5), turn * w
    x, w = (jnp.asarray(0.5 * each, duration.dtype) for each in np.polynomial.legendre.leggauss(LONG))
    stretch = jnp.log(horizon / turn)
    late = turn * jnp.exp(stretch * (x + 0.5))
    return jnp.concatenate([early, late]), jnp.concatenate([early_weights, stretch * late * w])


@jax.jit
def _recurrence(motion: StrainMotion, threshold: Scalar, lags: Float[Array, " lag"]) -> Float[Array, " lag"]:
    """κ at the lags."""
    covariance = to_sdc(motion.statistics.covariance)
    now, weights = _breaking_strains(motion, threshold)
    lower = factor(covariance)

    @jax.checkpoint
    def again(lag: Scalar) -> Scalar:
        lagged = to_sdc(motion.lagged_covariance(lag))
        forward = jax.scipy.linalg.cho_solve((lower, True), lagged).T  # C(t) C⁻¹
        mean = now @ forward.T + jnp.asarray([1.0, 0.0, 0.0], now.dtype)
        return jnp.sum(weights * _breaking_probability(mean, covariance - forward @ lagged, threshold))

    return jax.lax.map(again, lags) / jnp.sum(weights)


def _breaking_strains(
    motion: StrainMotion, threshold: Scalar
) -> tuple[Float[Array, "node 3"], Float[Array, " node"]]:
    """Strains (s − 1, d, c) that break, with their weights in the distribution of the strain."""
    rays = cast_rays(motion.statistics.covariance, threshold, LATITUDES, LONGITUDES)
    # ∫ρ² e^{−ρ²/2} dρ from ρ₁ on, with ρ² = ρ₁² + 2u, is e^{−ρ₁²/2} ∫ρ e^{−u} du.
    depth, share = (jnp.asarray(x, threshold.dtype) for x in np.polynomial.laguerre.laggauss(DEPTHS))
    enter, leave = (
        jnp.where(there, d, 1.0) for there, d in ((rays.breaks, rays.enter), (rays.folds, rays.leave))
    )
    distance = jnp.sqrt(enter[:, None] ** 2 + 2 * depth)
    inside = rays.breaks[:, None] & ~(rays.folds[:, None] & (distance > leave[:, None]))
    size = rays.solid_angle[:, None] * jnp.exp(-0.5 * enter[:, None] ** 2) * distance * share
    weights = jnp.where(inside, size, 0.0).ravel()
    strains = (rays.along[:, None, :] * distance[..., None]).reshape(-1, 3)
    _, kept = jax.lax.top_k(jax.lax.stop_gradient(weights), MOST)
    return strains[kept], weights[kept]


def _breaking_probability(
    mean: Float[Array, "node 3"], covariance: Float[Array, "3 3"], threshold: Scalar
) -> Float[Array, " node"]:
    """P(s² − d² − c² < ε) for Gaussian (s, d, c): exact in s given (d, c), Gauss–Hermite in these.

    The weak side is harmless here: what is left over of (d, c) after the strain is known is small at first.
    """
    x, w = np.polynomial.hermite_e.hermegauss(INNER)
    weights = jnp.asarray(np.outer(w, w).ravel() / np.sum(w) ** 2, mean.dtype)
    nodes = jnp.asarray(np.stack([each.ravel() for each in np.meshgrid(x, x)], axis=-1), mean.dtype)
    spread = factor(covariance[1:, 1:])
    lean = jax.scipy.linalg.cho_solve((spread, True), covariance[1:, 0])
    remains = covariance[0, 0] - lean @ covariance[1:, 0]
    floor = 8 * jnp.finfo(mean.dtype).eps
    deviation = safe_sqrt(jnp.maximum(remains, floor * covariance[0, 0]) + jnp.finfo(mean.dtype).tiny ** 0.5)
    offset = nodes @ spread.T
    dc = mean[:, None, 1:] + offset
    centre = mean[:, None, 0] + offset @ lean
    radius = safe_sqrt(threshold + jnp.sum(dc**2, axis=-1))
    between = ndtr((radius - centre) / deviation) - ndtr((-radius - centre) / deviation)
    return between @ weights
