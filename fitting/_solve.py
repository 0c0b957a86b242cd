"""The numerical heart of a fit: one compiled function from a problem to its solution."""

from collections.abc import Callable
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
    look = _Look(problem)

    def one(start):
        solution = _solve(look, start, solver)
        exhausted = solution.result == optx.RESULTS.nonlinear_max_steps_reached
        converged = solution.result == optx.RESULTS.successful
        return problem.constrain(solution.value), converged, exhausted, solution.stats["num_steps"]

    # A batch of one would still run the loop in its slower, batched form, and be traced once more.
    batched = jax.vmap if starts > 1 else _batch_of_one
    values, converged, exhausted, steps = batched(one)(points)
    costs, predictions, jacobians = batched(look)(values)
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
    _, predictions, jacobian = _Look(problem)(problem.start())
    return predictions, jacobian


@eqx.filter_jit
def solve_once(problem: Problem, solver: AbstractSolver) -> Float[Array, " p"]:
    """The solution from the problem's own start; differentiable in every leaf that is not free."""
    solution = _solve(_Look(problem), jax.lax.stop_gradient(problem.start()), solver)
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


def _batch_of_one(function: Callable) -> Callable:
    return lambda batch: jax.tree.map(lambda x: jnp.asarray(x)[None], function(batch[0]))


class _Look:
    """Residuals and predictions of a problem whose costly part is done.

    `rows` is compiled as a part of its own only to be traced once: the solver asks for its shapes and derivatives
    again and again, and tracing is most of the time of a fit whose program is in the cache.
    """

    def __init__(self, problem: Problem) -> None:
        self.arrays, rest = eqx.partition((problem, problem.prepare()), eqx.is_array)

        @jax.jit
        def rows(values: Float[Array, " p"], arrays: PyTree) -> tuple[Float[Array, " r"], Predictions]:
            problem, states = eqx.combine(arrays, rest)
            predictions = problem.predictions(values, states)
            return problem.residuals(values, predictions), predictions

        self.rows = rows
        self.problem_of = lambda arrays: eqx.combine(arrays, rest)[0]

    def __call__(
        self, values: Float[Array, " p"]
    ) -> tuple[Float[Array, ""], Predictions, Float[Array, "r p"]]:
        """Cost, predictions and the Jacobian of the residuals in the parameters themselves."""

        def residuals(values):
            rows, predictions = self.rows(values, self.arrays)
            return rows, (rows, predictions)

        jacobian, (rows, predictions) = jax.jacfwd(residuals, has_aux=True)(values)
        return 0.5 * jnp.sum(rows**2), predictions, jacobian


def _solve(look: _Look, start: Float[Array, " p"], solver: AbstractSolver) -> optx.Solution:
    def residuals(free: Float[Array, " p"], arrays: PyTree) -> Float[Array, " r"]:
        return look.rows(look.problem_of(arrays).constrain(free), arrays)[0]

    return optx.least_squares(
        residuals,
        solver.build(),
        look.problem_of(look.arrays).unconstrain(start),
        args=look.arrays,
        max_steps=solver.steps,
        throw=False,
        # Parameters that cannot be separated make the system of the implicit function theorem singular.
        adjoint=optx.ImplicitAdjoint(linear_solver=lx.AutoLinearSolver(well_posed=False)),
    )
