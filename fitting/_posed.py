"""A fit that is done, with everything that is asked of its neighbourhood afterwards."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PyTree

from ._density import prepare
from ._fit import Free, Targets, fit
from ._priors import AbstractPrior
from ._problem import Problem, make_problem
from ._result import Fit
from ._solvers import AbstractSolver
from ._synthetic import replay, tabulate
from ._target import flatten_targets, unique_names


class Posed(NamedTuple):
    """A problem in float64, its prepared states, and its solution."""

    problem: Problem
    states: Any
    fit: Fit
    values: Float[Array, " p"]


def pose(
    model: PyTree,
    free: Free,
    targets: Targets,
    priors: Sequence[AbstractPrior],
    solver: AbstractSolver | None,
) -> Posed:
    """Fit, and hand over the very problem that was solved, with the costly part of the model computed once.

    **Raises:** what `fit` raises.
    """
    found = fit(model, free, targets, priors=priors, solver=solver)
    problem, states = lay_out(model, free, targets, priors)
    with jax.enable_x64(True):
        values = jnp.asarray(np.concatenate([np.ravel(p.value) for p in found.parameters]), jnp.float64)
    return Posed(problem, states, found, values)


def lay_out(
    model: PyTree, free: Free, targets: Targets, priors: Sequence[AbstractPrior]
) -> tuple[Problem, Any]:
    """The problem in float64 with its prepared states, without a fit.

    Its targets hold their observed numbers apart, so that other data take their place in the same program.
    """
    named = flatten_targets(targets)
    with jax.enable_x64(True):
        problem, _ = make_problem(model, free, replay(tabulate(named)), priors, unique_names(named))
        return prepare(problem)


def slot_labels(problem: Problem) -> tuple[str, ...]:
    """A name for each free number, as in a fit's `labels`."""
    speeds = sorted({float(u) for target in problem.tree[1] for u in np.asarray(target.winds.speed)})
    return tuple(label for slot in problem.slots for label in slot.labels(speeds))
