"""Where to begin: scenes around a start whose pictures are only looked at, without derivatives."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._problem import PictureProblem

ROUNDS = 3
"""How often scenes are drawn, each time around the best of those before."""

BEST = 6
"""How many of them are kept."""

SPREAD = 0.35
"""Of free numbers at first: a share of those that are positive, and radians, stops or units of others."""

NARROWEST = 0.05
"""Of free numbers in later rounds."""


def scout(problem: PictureProblem, start: Float[Array, " p"], count: int) -> Float[Array, " p"]:
    """The best of `count` scenes around the start, or the start itself.

    Scenes are drawn in three rounds, from a normal distribution that is moved to the best six of each: the
    cross-entropy method of Rubinstein & Kroese 2004.
    """
    random = np.random.default_rng(0)
    middle, spread = np.asarray(start), np.full(start.shape, SPREAD)
    points, costs = (
        np.asarray(start)[None],
        np.asarray(costs_of(problem, jnp.broadcast_to(start, (1, start.size)))),
    )
    each = -(-count // ROUNDS)
    for _ in range(ROUNDS):
        drawn = middle + spread * random.normal(size=(each, start.size))
        points = np.concatenate([points, drawn])
        costs = np.concatenate([costs, np.asarray(costs_of(problem, jnp.asarray(drawn)))])
        best = points[np.argsort(np.where(np.isfinite(costs), costs, np.inf), stable=True)[:BEST]]
        middle, spread = best.mean(axis=0), np.maximum(best.std(axis=0), NARROWEST)
    return jnp.asarray(points[np.nanargmin(costs)])


def awaken(
    problem: PictureProblem, free: Float[Array, " p"], index: int, values: np.ndarray
) -> Float[Array, " p"]:
    """The same scene with the one of these values for a number, or its own, with which the picture agrees best.

    For a number that may have been led where no picture tells it, and no derivative leads back.
    """
    inside = np.repeat(np.asarray(problem.constrain(free))[None], len(values), axis=0)
    inside[:, index] = values
    points = jnp.concatenate([free[None], jax.vmap(problem.unconstrain)(jnp.asarray(inside))])
    return points[int(np.nanargmin(np.asarray(costs_of(problem, points))))]


@eqx.filter_jit
def costs_of(problem: PictureProblem, points: Float[Array, "n p"]) -> Float[Array, " n"]:
    """Half the sums of squared residuals, one point after the other."""
    return jax.lax.map(lambda point: 0.5 * jnp.sum(problem.rows(point) ** 2), points)
