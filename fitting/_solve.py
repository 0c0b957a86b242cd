"""The numerical heart of a fit: one compiled function from a problem to its solution."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import lineax as lx
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int, PyTree

from ._parameters import split
from ._problem import Predictions, Problem
from ._solvers import AbstractSolver


class Outcome(NamedTuple):
    """What came out of the starts, the best one in full."""

    start: Float[Array, " p"]
    values: Float[Array, " p"]
    converged: Bool[Array, ""]
    exhausted: Bool[Array, ""]
    steps: Int[Array, ""]
    cost: Float[Array, ""]
    costs: Float[Array, " start"]
    predictions: Predictions
    jacobian: Float[Array, "r p"]


@eqx.filter_jit
def solve_problem(problem: Problem, solver: AbstractSolver, starts: int, key) -> Outcome:
    """Solve in float64 from every start and keep the one of least cost that converged."""
    problem = lift(problem)
    points = starting_points(problem, starts, key)
    states = problem.prepare()

    def one(start):
        solution = _solve(problem, states, start, solver)
        exhausted = solution.result == optx.RESULTS.nonlinear_max_steps_reached
        converged = solution.result == optx.RESULTS.successful
        return problem.constrain(solution.value), converged, exhausted, solution.stats["num_steps"]

    if starts > 1:
        values, converged, exhausted, steps = jax.vmap(one)(points)
    else:
        # A batch of one would still run the loop in its slower, batched form.
        values, converged, exhausted, steps = jax.tree.map(lambda x: x[None], one(points[0]))
    costs, predictions, jacobians = jax.vmap(lambda v: _look(problem, states, v))(values)
    converged &= jnp.isfinite(costs)
    rank = jnp.where(jnp.isfinite(costs), costs, jnp.inf)
    best = jnp.argmin(jnp.where(converged, rank, jnp.inf))
    best = jnp.where(jnp.any(converged), best, jnp.argmin(rank))
    return Outcome(
        start=points[0],
        values=values[best],
        converged=converged[best],
        exhausted=exhausted[best],
        steps=steps[best],
        cost=costs[best],
        costs=jnp.where(converged, costs, jnp.nan),
        predictions=jax.tree.map(lambda x: x[best], predictions),
        jacobian=jacobians[best],
    )


@eqx.filter_jit
def look_at_start(problem: Problem) -> tuple[Predictions, Float[Array, "r p"]]:
    """Predictions and Jacobian before any step, which explain a fit that failed."""
    problem = lift(problem)
    _, predictions, jacobian = _look(problem, problem.prepare(), problem.start())
    return predictions, jacobian


@eqx.filter_jit
def solve_once(problem: Problem, solver: AbstractSolver) -> Float[Array, " p"]:
    """The solution from the problem's own start; differentiable in every leaf that is not free."""
    solution = _solve(problem, problem.prepare(), jax.lax.stop_gradient(problem.start()), solver)
    return problem.constrain(solution.value)


def lift(tree: PyTree) -> PyTree:
    """All numbers in double precision."""

    def one(leaf):
        if not eqx.is_inexact_array(leaf):
            return leaf
        return leaf.astype(jnp.complex128 if jnp.iscomplexobj(leaf) else jnp.float64)

    return jax.tree.map(one, tree)


def starting_points(problem: Problem, starts: int, key) -> Float[Array, "start p"]:
    """The model's own numbers, and others drawn from priors and bounds."""
    first = problem.start()
    if starts == 1:
        return first[None]
    normal = jax.random.normal(key, (starts - 1, first.size), first.dtype)

    def draw(row):
        parts = zip(
            problem.slots,
            problem.priors,
            split(problem.slots, row),
            split(problem.slots, first),
            strict=True,
        )
        drawn = []
        for slot, prior, noise, start in parts:
            value = slot.bounds.draw(noise, start) if prior is None else prior.draw(noise)
            inside = slot.bounds.constrain(slot.bounds.unconstrain(value))
            drawn.append(jnp.where(jnp.isfinite(inside), inside, start).ravel())
        return jnp.concatenate(drawn)

    return jnp.concatenate([first[None], jax.vmap(draw)(normal)])


def _look(problem: Problem, states, values: Float[Array, " p"]):
    """Cost, predictions and the Jacobian of the residuals in the parameters themselves."""

    def residuals(values):
        predictions = problem.predictions(values, states)
        rows = problem.residuals(values, predictions)
        return rows, (rows, predictions)

    jacobian, (rows, predictions) = jax.jacfwd(residuals, has_aux=True)(values)
    return 0.5 * jnp.sum(rows**2), predictions, jacobian


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
