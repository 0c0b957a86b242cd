"""The numerical heart of a fit: one compiled function from a problem to its solution."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import lineax as lx
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int

from ._problem import Predictions, Problem
from ._solvers import AbstractSolver


class Outcome(NamedTuple):
    """What came out of the starts, the best one in full."""

    values: Float[Array, " p"]
    converged: Bool[Array, ""]
    exhausted: Bool[Array, ""]
    steps: Int[Array, ""]
    cost: Float[Array, ""]
    costs: Float[Array, " start"]
    predictions: Predictions
    start_predictions: Predictions
    jacobian: Float[Array, "r p"]
    start_jacobian: Float[Array, "r p"]


@eqx.filter_jit
def solve_problem(problem: Problem, starts: Float[Array, "start p"], solver: AbstractSolver) -> Outcome:
    """Solve from every start (each inside the bounds) and keep the one of least cost that converged."""
    states = problem.prepare()

    def one(start):
        solution = _solve(problem, states, start, solver)
        exhausted = solution.result == optx.RESULTS.nonlinear_max_steps_reached
        converged = solution.result == optx.RESULTS.successful
        return problem.constrain(solution.value), converged, exhausted, solution.stats["num_steps"]

    def look(values):
        def residuals(values):
            predictions = problem.predictions(values, states)
            return problem.residuals(values, predictions), predictions

        rows, predictions = residuals(values)
        return 0.5 * jnp.sum(rows**2), predictions, jax.jacfwd(lambda v: residuals(v)[0])(values)

    if starts.shape[0] > 1:
        values, converged, exhausted, steps = jax.vmap(one)(starts)
    else:
        # A batch of one would still run the loop in its slower, batched form.
        values, converged, exhausted, steps = jax.tree.map(lambda x: x[None], one(starts[0]))
    # The first start is looked at too: one batch, since every further copy of the model costs compile time.
    costs, predictions, jacobians = jax.vmap(look)(jnp.concatenate([values, starts[:1]]))
    start_predictions = jax.tree.map(lambda x: x[-1], predictions)
    start_jacobian, costs = jacobians[-1], costs[:-1]
    converged &= jnp.isfinite(costs)
    rank = jnp.where(jnp.isfinite(costs), costs, jnp.inf)
    best = jnp.argmin(jnp.where(converged, rank, jnp.inf))
    best = jnp.where(jnp.any(converged), best, jnp.argmin(rank))
    return Outcome(
        values=values[best],
        converged=converged[best],
        exhausted=exhausted[best],
        steps=steps[best],
        cost=costs[best],
        costs=jnp.where(converged, costs, jnp.nan),
        predictions=jax.tree.map(lambda x: x[best], predictions),
        start_predictions=start_predictions,
        jacobian=jacobians[best],
        start_jacobian=start_jacobian,
    )


@eqx.filter_jit
def solve_once(problem: Problem, solver: AbstractSolver) -> Float[Array, " p"]:
    """The solution from the problem's own start; differentiable in every leaf that is not free."""
    solution = _solve(problem, problem.prepare(), jax.lax.stop_gradient(problem.start()), solver)
    return problem.constrain(solution.value)


def _solve(problem: Problem, states, start: Float[Array, " p"], solver: AbstractSolver) -> optx.Solution:
    arrays, rest = eqx.partition((problem, states), eqx.is_array)

    def residuals(free, arrays):
        problem, states = eqx.combine(arrays, rest)
        values = problem.constrain(free)
        return problem.residuals(values, problem.predictions(values, states))

    return optx.least_squares(
        residuals,
        solver.build(),
        problem.unconstrain(start),
        args=arrays,
        max_steps=solver.steps,
        throw=False,
        # Parameters that cannot be separated make the system of the implicit function theorem singular.
        adjoint=optx.ImplicitAdjoint(linear_solver=lx.AutoLinearSolver(well_posed=False)),
    )
