"""The least cost of a fit while some of its numbers are held: what profiles and repeated fits are made of."""

from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Bool, Float

from ._problem import Problem
from ._solvers import AbstractSolver


class Minimum(NamedTuple):
    """Where the cost is least, and whether the solver says so."""

    values: Float[Array, " p"]
    cost: Float[Array, ""]
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
    rows = residuals(solution.value, args)
    cost = 0.5 * jnp.sum(rows**2)
    converged = (solution.result == optx.RESULTS.successful) & jnp.isfinite(cost)
    return Minimum(values(problem, solution.value, start, held), cost, converged)
