"""The least cost of a fit while some of its numbers are held: what profiles and repeated fits are made of."""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Bool, Float

from ._problem import Problem
from ._solvers import AbstractSolver, LevenbergMarquardt

GAIN = 1e-6
"""Where another step would lower the cost by less, a minimum is reached whatever the solver says."""

SINGULAR = 1e-10
"""Added to a scaled curvature, so that numbers that cannot be separated make no equation singular."""


SOLVER = LevenbergMarquardt(rtol=1e-6, atol=1e-6, steps=64)
"""Many minima are sought at once, all as slow as the slowest; from nearby starts few steps are enough."""


class Minimum(NamedTuple):
    """Where the cost is least, the residuals' Jacobian in the numbers themselves, and whether it is a minimum."""

    values: Float[Array, " p"]
    cost: Float[Array, ""]
    jacobian: Float[Array, "r p"]
    converged: Bool[Array, ""]


def minimise(
    problem: Problem, states: Any, start: Float[Array, " p"], held: Bool[Array, " p"], solver: AbstractSolver
) -> Minimum:
    """Minimise half the sum of squared residuals over the numbers that are not held.

    **Arguments:** `problem` in float64 with its prepared `states`; `start`: where to begin, and the values of
    those that are held; `held`: which; it may differ from one element of a batch to the next.
    """
    arrays, rest = eqx.partition((problem, states), eqx.is_array)
    origin = problem.unconstrain(start)

    def values(problem, free, start, held):
        return jnp.where(held, start, problem.constrain(free))

    def residuals(free, args):
        arrays, origin, start, held = args
        problem, states = eqx.combine(arrays, rest)
        inside = values(problem, free, start, held)
        rows = problem.residuals(inside, problem.predictions(inside, states))
        # A residual of its own pins each held number: the solver's equations stay regular without it.
        return jnp.concatenate([rows, jnp.where(held, free - origin, 0.0)])

    args = (arrays, origin, start, held)
    solution = optx.least_squares(
        residuals, solver.build(), origin, args=args, max_steps=solver.steps, throw=False
    )
    inside = values(problem, solution.value, start, held)

    def look(inside):
        rows = problem.residuals(inside, problem.predictions(inside, states))
        return rows, rows

    jacobian, rows = jax.jacfwd(look, has_aux=True)(inside)
    cost = 0.5 * jnp.sum(rows**2)
    _, slope = jax.jvp(problem.constrain, (solution.value,), (jnp.ones_like(origin),))
    settled = solution.result == optx.RESULTS.successful
    gain = _still_to_gain(jnp.where(held, 0.0, jacobian * slope), rows)
    return Minimum(inside, cost, jacobian, jnp.isfinite(cost) & (settled | (gain < GAIN)))


def _still_to_gain(jacobian: Float[Array, "r p"], rows: Float[Array, " r"]) -> Float[Array, ""]:
    """By how much one more Gauss–Newton step would lower the cost.

    A solver that begins at the minimum itself finds no better point and calls that a failure: this does not.
    """
    own = jnp.sqrt(jnp.sum(jacobian**2, axis=0))
    scaled = jacobian / jnp.where(own > 0, own, 1.0)
    slope = scaled.T @ rows
    curvature = scaled.T @ scaled + SINGULAR * jnp.eye(slope.size, dtype=rows.dtype)
    return 0.5 * slope @ jnp.linalg.solve(curvature, slope)
