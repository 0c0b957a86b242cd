"""From a solver's outcome to one plain sentence."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from ._errors import FitError
from ._problem import Problem

if TYPE_CHECKING:
    from ._solve import Outcome
    from ._solvers import AbstractSolver


def check_start(outcome: "Outcome", problem: Problem, names: list[str]) -> None:
    """Refuse a fit that is not finite at its start, or whose parameters change nothing there.

    **Raises:** `FitError`.
    """
    for t, (name, target) in enumerate(zip(names, problem.tree[1], strict=True)):
        for kind, numbers in (
            ("model", outcome.start_predictions.predicted[t]),
            ("target", outcome.start_predictions.observed[t]),
        ):
            bad = ~np.isfinite(numbers)
            if np.any(bad):
                at = ", ".join(f"{speed:g}" for speed in np.asarray(target.winds.speed)[bad])
                raise FitError(
                    f'The {kind} gives no finite number for "{name}" at {at} m/s, before any step',
                    "no whitecaps at all there (the logarithm of zero), or a starting value without sense",
                    "other starting values (a higher threshold, a larger choppiness), or fewer winds",
                )
    jacobian = np.asarray(outcome.start_jacobian)[: problem.data_size]
    if not np.all(np.isfinite(jacobian)):
        raise FitError(
            "The derivatives of the model are not finite at its start",
            "a starting value at a singular point of the model",
            "slightly different starting values",
        )
    still = np.all(jacobian == 0, axis=0)
    has_prior = np.concatenate(
        [
            np.full(slot.size, prior is not None)
            for slot, prior in zip(problem.slots, problem.priors, strict=True)
        ]
    )
    stuck = still & ~has_prior & (np.asarray(outcome.jacobian)[: problem.data_size] == 0).all(axis=0)
    owners = [slot.name for slot in problem.slots for _ in range(slot.size)]
    stuck_names = sorted({owner for owner, flag in zip(owners, stuck, strict=True) if flag})
    if stuck_names:
        raise FitError(
            f"{' and '.join(f'`{name}`' for name in stuck_names)} did not move: the targets do not change "
            "with it",
            "a hard threshold, whose derivative is zero everywhere, or a leaf that the targets do not see",
            "a smooth indicator (`SmoothBreaking`) or a closure, another target, or leave this leaf fixed",
        )


def check_outcome(outcome: "Outcome", problem: Problem, solver: "AbstractSolver") -> None:
    """Refuse a fit that did not converge.

    **Raises:** `FitError`.
    """
    if bool(outcome.converged):
        return
    values = np.asarray(outcome.values)
    names = ", ".join(slot.name for slot in problem.slots)
    if not np.all(np.isfinite(values)) or not np.isfinite(outcome.cost):
        raise FitError(
            f"The {solver} solver left the range where the model is finite ({names})",
            "steps too long for an undamped solver, or parameters without bounds",
            "`LevenbergMarquardt()`, bounds (`Interval`), or a starting point nearer to the solution",
        )
    if bool(outcome.exhausted):
        raise FitError(
            f"The {solver} solver did not converge in {solver.steps} steps ({names})",
            "parameters that the data cannot separate, so that the cost falls ever more slowly along a ridge",
            "fix one of them or give it a prior, bounds (`Interval`), more steps (`steps=`), or several "
            "`starts`",
        )
    raise FitError(
        f"The {solver} solver stopped without a solution ({names})",
        "its linear equations are singular, or its steps diverge",
        "`LevenbergMarquardt()`, other starting values, or several `starts`",
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
