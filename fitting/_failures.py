"""From a solver's outcome to one plain sentence."""

import jax
import numpy as np
from jaxtyping import Float

from ._errors import FitError
from ._problem import Problem
from ._solve import Outcome, look_at_start
from ._solvers import AbstractSolver


def check_outcome(outcome: Outcome, problem: Problem, solver: AbstractSolver, names: list[str]) -> None:
    """Refuse a fit that did not converge, or that the data did not move.

    **Raises:** `FitError`.
    """
    _check_motion(np.asarray(outcome.jacobian), problem)
    if bool(outcome.converged):
        return
    _check_start(problem, names)
    values = np.asarray(outcome.values)
    which = ", ".join(slot.name for slot in problem.slots)
    if not np.all(np.isfinite(values)) or not np.isfinite(outcome.cost):
        raise FitError(
            f"The {solver} solver left the range where the model is finite ({which})",
            "steps too long for an undamped solver, or parameters without bounds",
            "`LevenbergMarquardt()`, bounds (`Interval`), or a starting point nearer to the solution",
        )
    if bool(outcome.exhausted):
        raise FitError(
            f"The {solver} solver did not converge in {solver.steps} steps ({which})",
            "parameters that the data cannot separate, so that the cost falls ever more slowly along a ridge",
            "fix one of them or give it a prior, bounds (`Interval`), more steps (`steps=`), or several "
            "`starts`",
        )
    raise FitError(
        f"The {solver} solver stopped without a solution ({which})",
        "its linear equations are singular, or its steps diverge",
        "`LevenbergMarquardt()`, other starting values, or several `starts`",
    )


def _check_motion(jacobian: Float[np.ndarray, "r p"], problem: Problem) -> None:
    """A parameter that changes no residual at all stays where it was, and solvers call that success."""
    rows = slice(problem.data_size + problem.prior_size)
    stuck = np.all(jacobian[rows] == 0, axis=0)
    if np.any(stuck):
        # A solver may also have run off to where the model is flat.
        stuck &= np.all(np.asarray(look_at_start(problem)[1])[rows] == 0, axis=0)
    free = [slot for slot in problem.slots for _ in range(slot.size)]
    names = sorted(
        {slot.name for slot, flag in zip(free, stuck, strict=True) if flag and not slot.is_scatter}
    )
    if names:
        raise FitError(
            f"{' and '.join(f'`{name}`' for name in names)} did not move: the targets do not change with it",
            "a hard threshold, whose derivative is zero everywhere, or a leaf that the targets do not see",
            "a smooth indicator (`SmoothBreaking`) or a closure, another target, or leave this leaf fixed",
        )


def _check_start(problem: Problem, names: list[str]) -> None:
    """Whether a fit failed because it could not even begin."""
    predictions, jacobian = jax.device_get(look_at_start(problem))
    for t, (name, target) in enumerate(zip(names, problem.tree[1], strict=True)):
        for kind, numbers in (("model", predictions.predicted[t]), ("target", predictions.observed[t])):
            bad = ~np.isfinite(numbers)
            if np.any(bad):
                at = ", ".join(f"{speed:g}" for speed in np.asarray(target.winds.speed)[bad])
                raise FitError(
                    f'The {kind} gives no finite number for "{name}" at {at} m/s, before any step',
                    "no whitecaps at all there (the logarithm of zero), or a starting value without sense",
                    "other starting values (a higher threshold, a larger choppiness), or fewer winds",
                )
    if not np.all(np.isfinite(jacobian)):
        raise FitError(
            "The derivatives of the model are not finite at its start",
            "a starting value at a singular point of the model",
            "slightly different starting values",
        )


def value_warnings(problem: Problem, labels: list[str], values: Float[np.ndarray, " p"]) -> list[str]:
    """Sentences on fitted values: at a bound, or more of them than data."""
    texts = []
    bounds = [slot.bounds for slot in problem.slots for _ in range(slot.size)]
    for label, bound, value in zip(labels, bounds, values, strict=True):
        edge = bound.touched(float(value))
        if edge is not None:
            texts.append(
                f"{label} is at its bound {edge:g} (allowed: {bound}): the data pull it further, its ± "
                "means little. "
                "Widen the bounds, fix it, or give it a prior."
            )
    data, known = problem.data_size, problem.prior_size
    if values.size > data + known:
        texts.append(
            f"There are {values.size} free numbers for {data} data and {known} priors: many values fit "
            "equally well. "
            "Fix some, add priors or targets."
        )
    return texts
