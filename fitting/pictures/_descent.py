"""The way down to the scene whose picture agrees best, step by step."""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Float, PyTree

from .._errors import FitError
from ._problem import PictureProblem, look, rows_of

PATIENCE = 3
"""Steps that must together lower the cost by more than the tolerance."""

FINISHES = 12
"""Steps with a more exact method at most, of which each draws one picture."""

FINISHED = 1e-4
"""Share of the cost below which another one gains nothing: with derivatives of another method they only come closer by
a factor each."""


@dataclass(frozen=True)
class PictureStep:
    """One step of a fit.

    - `number`: counted from 0, the start.
    - `finest`: the side of the smallest squares of pixels that are compared so far.
    - `cost`: half the sum of squared residuals there; `values`: of the free numbers by name.
    """

    number: int
    finest: int
    cost: float
    values: dict[str, float | Float[np.ndarray, "..."]]


@jax.custom_jvp
def _known(free: Float[Array, " p"], rows: Float[Array, " n"], jacobian: Float[Array, "n p"]):
    """Residuals that are known at this one point, with their derivative: what a solver asks for."""
    return rows


@_known.defjvp
def _known_jvp(primals, tangents):
    return primals[1], primals[2] @ tangents[0]


@eqx.filter_jit
def _solver_step(solver: optx.LevenbergMarquardt, y: Array, state: PyTree, known: tuple[Array, Array]):
    def residuals(y, known):
        return _known(y, *known), None

    return solver.step(residuals, y, known, {}, state, frozenset())[:2]


def descend(
    problem: PictureProblem,
    y: Array,
    tolerance: float,
    most_steps: int,
    finest: int,
    steps: list[PictureStep],
    report: Callable | None,
) -> tuple[Array, tuple[Array, Array]]:
    """Levenberg–Marquardt, step by step, so that whoever waits may watch.

    **Returns:** where it ends, and the residuals and their derivatives there.
    """
    solver = optx.LevenbergMarquardt(tolerance, 1e-4 * tolerance, norm=optx.rms_norm)
    # Steps grow as soon as the cost falls half as foreseen: each costs a picture for every free number.
    solver = eqx.tree_at(
        lambda s: s.search, solver, optx.ClassicalTrustRegion(high_cutoff=0.5, low_cutoff=0.05)
    )
    known = look(problem, y)
    # The solver's first step is damped as suits residuals of order 1.
    scale = 1 / jnp.sqrt(jnp.sum(known[0] ** 2) + jnp.finfo(float).tiny)
    if not all(bool(jnp.all(jnp.isfinite(each))) for each in known):
        raise FitError(
            "The picture of the starting scene, or its derivative, is not finite",
            "a number that no scene has",
            "start from another scene",
        )
    struct = jax.eval_shape(lambda: known[0])
    state = solver.init(lambda y, known: (_known(y, *known), None), y, known, {}, struct, None, frozenset())
    best, costs = (y, known), []
    for _ in range(most_steps + 1):
        cost = 0.5 * float(jnp.sum(known[0] ** 2))
        if not costs or cost < costs[-1]:
            best = state.y_eval, known
            costs.append(cost)
            values = problem.named(np.asarray(problem.constrain(state.y_eval)))
            steps.append(PictureStep(len(steps), 2**finest, cost, values))
            if report is not None:
                report(steps[-1])
            # The derivative of a picture is rough: near the end many steps gain hardly anything.
            if len(costs) > PATIENCE and costs[-1 - PATIENCE] - cost < tolerance * cost:
                return best
        y, state = _solver_step(solver, y, state, jax.tree.map(lambda each: scale * each, known))
        if bool(state.terminate):
            # It ends with a step that is taken: what is known is known there.
            return y, known
        known = look(problem, state.y_eval)
        # A step too far is one that the solver shall take back.
        finite = jnp.all(jnp.isfinite(known[0]))
        known = (
            jnp.where(finite, known[0], jnp.sqrt(jnp.finfo(float).max) / known[0].size),
            jnp.where(finite, known[1], 0.0),
        )
    if finest:
        return best
    raise FitError(
        f"The fit did not come to rest in {most_steps} steps",
        "a picture that these numbers cannot explain, or numbers that it does not tell apart",
        "start closer, free fewer numbers, give priors, or allow more steps",
    )


def finish_with(problem: PictureProblem, free: Array, jacobian: Array) -> tuple[Array, Array]:
    """Gauss–Newton steps with the residuals of one method and the derivatives of another."""
    rows = rows_of(problem, free)
    for _ in range(FINISHES):
        ahead = free - jnp.linalg.lstsq(jacobian, rows)[0]
        there = rows_of(problem, ahead)
        gain = 1 - float(jnp.sum(there**2) / jnp.sum(rows**2))
        if not gain > 0:
            break
        free, rows = ahead, there
        if gain < FINISHED:
            break
    return free, rows


def shift(problem: PictureProblem, free: Array, rows: Array, jacobian: Array) -> Array:
    """How far free numbers would move, to first order, if the pictures were those of this problem and not those that
    gave `rows`."""
    return -jnp.linalg.lstsq(jacobian, rows_of(problem, free) - rows)[0]
