"""The front door: free leaves, targets and priors in, a `Fit` out."""

import time
from collections.abc import Callable, Sequence
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray, PyTree, UInt32

from jaxocean import Ocean
from jaxocean._numerics import check_kind

from ._failures import check_outcome, value_warnings
from ._parameters import Parameter, split
from ._priors import AbstractPrior
from ._problem import Problem, make_problem
from ._result import Fit, FittedParameter, FittedTarget
from ._solve import Outcome, lift, solve_once, solve_problem
from ._solvers import AbstractSolver, LevenbergMarquardt
from ._target import AbstractTarget, TargetSum, flatten_targets, unique_names
from ._uncertainty import estimate

Free = Callable | Parameter | Sequence[Callable | Parameter]
Targets = AbstractTarget | TargetSum | Sequence[AbstractTarget | TargetSum]


def fit(
    model: PyTree,
    free: Free,
    targets: Targets,
    *,
    priors: Sequence[AbstractPrior] = (),
    solver: AbstractSolver | None = None,
    starts: int = 1,
    key: PRNGKeyArray | UInt32[Array, "2"] | None = None,
) -> Fit:
    """Find the numbers of a model that agree best with targets and priors.

    $$ \\min_θ ½ Σ_i r_i(θ)² + Σ_t n_t \\log σ_t, \\quad r_i = (f(m_i(θ)) − f(d_i))/σ_i $$

    with priors among the residuals, and the second sum over targets whose scatter σ is fitted too. The fit
    runs in float64 whatever the model's type is; standard errors come from the Gauss–Newton covariance at
    the solution.

    **Arguments:**

    - `model`: any equinox module that answers what the targets ask, such as `SpectralModel` or
      `RealisedModel`; its leaves are the starting point.
    - `free`: which leaves may change: `lambda m: (m.threshold, m.choppiness)`, a `Parameter`, or a list of
      both.
    - `targets`: one or several; they also add.
    - `priors`: with their `where`, for instance `Normal(1.0, 0.1, where=lambda m: m.choppiness)`.
    - `solver`: `LevenbergMarquardt()` by default.
    - `starts`: how many starting points, the first being the model itself; the others are drawn from priors
      and bounds with `key` (`jax.random.key(0)` by default).

    **Returns:** `Fit`.

    **Raises:** `ValueError` for arguments that make no sense; `FitError` if the fit gives no answer (not
    finite at its start, nothing moves it, no convergence), with the likely cause and what to try.
    """
    if isinstance(model, Ocean):
        raise ValueError(
            "Argument `model` must answer for any wind, but an `Ocean` is one realised sea: "
            "use `fitting.SpectralModel(…)` or `fitting.RealisedModel(…)` with its cascade, threshold and choppiness."
        )
    if starts < 1:
        raise ValueError(f"Argument `starts` must be at least 1, but is {starts}.")
    solver = LevenbergMarquardt() if solver is None else solver
    check_kind("solver", solver, AbstractSolver, "a solver such as `LevenbergMarquardt()`")
    named = flatten_targets(targets)
    names = unique_names(named)
    with jax.enable_x64(True):
        problem, speeds = make_problem(model, free, _tabulate(named), priors, names)
        began = time.perf_counter()
        outcome = solve_problem(problem, solver, starts, _key(starts, key))
        outcome: Outcome = jax.device_get(outcome)
        seconds = time.perf_counter() - began
        check_outcome(outcome, problem, solver, names)
    fitted = _fitted_model(model, problem, np.asarray(outcome.values))
    notes = [note for target in named for note in target.notes()]
    return _report(problem, speeds, names, notes, outcome, solver, seconds, fitted)


def solve_values(
    model: PyTree,
    free: Free,
    targets: Targets,
    *,
    priors: Sequence[AbstractPrior] = (),
    solver: AbstractSolver | None = None,
) -> dict[str, Float[Array, "..."]]:
    """The fitted values as a pure function: its derivatives tell how they move with the data.

    Derivatives in every leaf of model, targets and priors that is not free come from the implicit function
    theorem, not from the solver's steps. Where parameters cannot be separated they are those of the
    solution of least norm.

    **Arguments:** those of `fit`. All numbers must be float64: call it inside `jax.enable_x64(True)`.

    **Returns:** values by name. Nothing is checked: a fit that fails gives numbers that mean nothing, so run
    `fit` on the same problem first.

    **Raises:** `ValueError` for free leaves that are not float64.
    """
    plain = flatten_targets(targets)
    problem, _ = make_problem(model, free, plain, priors, unique_names(plain))
    leaves = jax.tree.leaves(problem.tree)
    for slot in problem.slots:
        if jnp.asarray(leaves[slot.index]).dtype != jnp.float64:
            raise ValueError(
                f"`{slot.name}` must be float64 to be fitted, but is "
                f"{jnp.asarray(leaves[slot.index]).dtype}: "
                "make the model inside `jax.enable_x64(True)`."
            )
    values = solve_once(problem, LevenbergMarquardt() if solver is None else solver)
    parts = split(problem.slots, values)
    return {slot.name: part for slot, part in zip(problem.slots, parts, strict=True)}


@eqx.filter_jit
def _tabulate(targets: tuple[AbstractTarget, ...]) -> tuple[AbstractTarget, ...]:
    return tuple(target.tabulated() for target in lift(targets))


def _key(starts: int, key):
    """No key where none is needed: the program is then the same for all."""
    if starts == 1:
        return None
    return jax.random.key(0) if key is None else key


def _fitted_model(model: PyTree, problem: Problem, values: Float[np.ndarray, " p"]) -> PyTree:
    """The model with its numbers put in, each leaf of the type that it came with."""
    leaves, treedef = jax.tree.flatten(model)
    for slot, part in zip(problem.slots, split(problem.slots, values), strict=True):
        if not slot.is_scatter:
            value = part.mean(axis=0) if slot.per_wind else part
            old = leaves[slot.index]
            leaves[slot.index] = float(value) if isinstance(old, float) else jnp.asarray(value, old.dtype)
    return treedef.unflatten(leaves)


def _report(
    problem: Problem,
    speeds: tuple[float, ...],
    names: list[str],
    notes: list[str],
    outcome: Outcome,
    solver: AbstractSolver,
    seconds: float,
    fitted: Any,
) -> Fit:
    labels = [label for slot in problem.slots for label in slot.labels(speeds)]
    groups = [slot.name for slot in problem.slots for _ in range(slot.size)]
    values, jacobian = np.asarray(outcome.values), np.asarray(outcome.jacobian)
    information = [
        2 * problem.scatter_size(slot) / value**2 if slot.is_scatter else 0.0
        for slot, part in zip(problem.slots, split(problem.slots, values), strict=True)
        for value in part.ravel()
    ]
    known = estimate(
        jacobian[: problem.data_size],
        jacobian[problem.data_size : problem.data_size + problem.prior_size],
        np.asarray(information),
        labels,
        groups,
    )
    errors = np.sqrt(np.diag(known.covariance))
    rows = zip(
        problem.slots,
        problem.priors,
        *(split(problem.slots, one) for one in (values, errors, outcome.start)),
        strict=True,
    )
    parameters = tuple(
        FittedParameter(
            slot.name,
            slot.unit,
            _number(value),
            _number(error),
            _number(begin),
            str(slot.bounds),
            None if prior is None else str(prior),
            slot.per_wind,
        )
        for slot, prior, value, error, begin in rows
    )
    ends = np.cumsum([target.size for target in problem.tree[1]])[:-1]
    relative = np.split(_prediction_errors(problem, jacobian, known.covariance), ends)
    targets = tuple(
        FittedTarget(
            name,
            target.unit,
            np.asarray(target.winds.speed, float),
            np.asarray(observed),
            np.asarray(predicted),
            np.broadcast_to(scatter, np.shape(observed)),
            scatter * error,
        )
        for name, target, error, predicted, observed, scatter in zip(
            names, problem.tree[1], relative, *outcome.predictions, strict=True
        )
    )
    return Fit(
        parameters=parameters,
        targets=targets,
        labels=tuple(labels),
        covariance=known.covariance,
        correlations=known.correlations,
        condition_number=known.condition_number,
        identifiability=known.words,
        warnings=(*known.warnings, *value_warnings(problem, labels, values), *notes),
        cost=float(outcome.cost),
        start_costs=np.asarray(outcome.costs),
        winds=np.asarray(speeds),
        steps=int(outcome.steps),
        seconds=seconds,
        solver=str(solver),
        model=fitted,
    )


def _prediction_errors(problem: Problem, jacobian: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard errors of all predictions in units of their scatter; what the scatter is moves no prediction."""
    moves = np.concatenate([np.full(slot.size, not slot.is_scatter) for slot in problem.slots])
    rows = jacobian[: problem.data_size] * moves
    return np.sqrt(np.maximum(np.einsum("ri,ij,rj->r", rows, covariance, rows), 0.0))


def _number(value: np.ndarray) -> float | np.ndarray:
    return float(value) if value.ndim == 0 else value
