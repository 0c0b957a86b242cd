"""Profile likelihood: what each value of one parameter costs, when all others do their best."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PyTree

from ._bounds import AbstractBounds, Real
from ._errors import FitError
from ._fit import Free, Targets
from ._minimise import SOLVER, Minimum, minimise
from ._posed import lay_out, pose, slot_labels
from ._posterior_result import check_level
from ._priors import AbstractPrior
from ._problem import Problem
from ._result import Fit
from ._solvers import AbstractSolver
from ._target import Numbers, as_row

REACH = 4.0
"""The default grid ends so many standard errors from the fit."""

WIDEST = 1.5
"""Largest standard error on the sampler's line of a bounded parameter that the default grid believes."""

BELOW = 1e-3
"""A cost this far below that of the fit means that the fit had not found the least one."""


@dataclass(frozen=True)
class ProfileInterval:
    """Where twice the cost above the least is below a quantile of χ² with one degree of freedom.

    - `lower`, `upper`: its ends; an end that is `open` was not found: the grid stops there.
    - `pieces`: how many separate intervals the region has; the ends are the outermost.
    """

    level: float
    lower: float
    upper: float
    lower_is_open: bool
    upper_is_open: bool
    pieces: int

    def __contains__(self, value: float) -> bool:
        return (self.lower_is_open or self.lower <= value) and (self.upper_is_open or value <= self.upper)

    def words(self, name: str) -> str:
        """The interval in a sentence that hides no open end."""
        share = f"{100 * self.level:g} %"
        if self.lower_is_open and self.upper_is_open:
            text = f"{name} is not bounded on either side between {self.lower:.4g} and {self.upper:.4g}"
        elif self.lower_is_open:
            text = f"{name} < {self.upper:.4g}; no lower end down to {self.lower:.4g}"
        elif self.upper_is_open:
            text = f"{name} > {self.lower:.4g}; no upper end up to {self.upper:.4g}"
        else:
            text = f"{self.lower:.4g} < {name} < {self.upper:.4g}"
        several = f", in {self.pieces} separate pieces" if self.pieces > 1 else ""
        return f"{text} ({share}{several})"


@dataclass(frozen=True)
class Profile:
    """The least cost for each value of one parameter.

    - `label`, `unit`: of the parameter; `grid`: its values, increasing, the best one among them.
    - `excess`: twice the cost above the least, NaN where the solver did not converge.
    - `values`: (grid, number) all free numbers there, in the order of `labels`.
    - `best`: the value of least cost; `fit`: the fit from which the search began, None where there is none.
    """

    label: str
    unit: str
    labels: tuple[str, ...]
    grid: Float[np.ndarray, " n"]
    excess: Float[np.ndarray, " n"]
    values: Float[np.ndarray, "n p"]
    best: float
    fit: Fit | None
    warnings: tuple[str, ...]

    @property
    def signed_root(self) -> Float[np.ndarray, " n"]:
        """±√excess, negative below the best value: a straight line where the likelihood is Gaussian."""
        return np.sign(self.grid - self.best) * np.sqrt(np.maximum(self.excess, 0.0))

    def interval(self, level: float = 0.9) -> ProfileInterval:
        """The values that this level of confidence does not exclude.

        **Raises:** `ValueError` for a level outside (0, 1).
        """
        limit = np.sqrt(profile_limit(level))
        known = np.isfinite(self.excess)
        grid, root = self.grid[known], np.abs(self.signed_root[known])
        inside = np.flatnonzero(root <= limit)
        first, last = int(inside[0]), int(inside[-1])
        pieces = 1 + int(np.sum(np.diff(inside) > 1))
        lower_open, upper_open = first == 0, last == len(grid) - 1
        lower = grid[0] if lower_open else _cross(grid, root, first, first - 1, limit)
        upper = grid[-1] if upper_open else _cross(grid, root, last, last + 1, limit)
        return ProfileInterval(level, float(lower), float(upper), lower_open, upper_open, pieces)

    def as_dict(self, level: float = 0.9) -> dict[str, Any]:
        """Plain numbers, texts and lists."""
        interval = self.interval(level)
        return {
            "name": self.label,
            "unit": self.unit,
            "best": self.best,
            "grid": self.grid.tolist(),
            "excess": self.excess.tolist(),
            "level": level,
            "lower": None if interval.lower_is_open else interval.lower,
            "upper": None if interval.upper_is_open else interval.upper,
            "interval": interval.words(self.label),
            "warnings": list(self.warnings),
        }


def profile_limit(level: float) -> float:
    """The quantile of χ² with one degree of freedom: twice the cost above the least that a level allows.

    **Raises:** `ValueError` for a level outside (0, 1).
    """
    check_level(level)
    return NormalDist().inv_cdf(0.5 * (1 + level)) ** 2


def profile(
    model: PyTree,
    free: Free,
    targets: Targets,
    *,
    parameter: str,
    grid: Numbers | None = None,
    points: int = 41,
    priors: Sequence[AbstractPrior] = (),
    solver: AbstractSolver | None = None,
) -> Profile:
    """The least cost of a fit for each value of one of its numbers, the others minimised anew.

    $$ Δ(v) = 2 \\left(\\min_{θ: θ_k = v} C(θ) − \\min_θ C(θ)\\right) $$

    with the cost C that `fit` minimises, priors included. Values with Δ below the quantile of χ² with one degree of
    freedom make the interval. From the fit's value the search walks up the grid and then down, each minimum starting
    from its neighbour's. All parameters of one problem share a compiled program.

    **Arguments:** `model`, `free`, `targets`, `priors`, `solver`: as for `fit`, which runs first;

    - `parameter`: its name, as in the fit's `labels`.
    - `grid`: values to try, in any order, inside its bounds; by default `points` within about four
      standard errors.

    **Returns:** `Profile`.

    **Raises:** what `fit` raises, but with a grid a fit that does not converge is no error: the ridge that it ran
    along is what a profile shows; `FitError` if nothing settles anywhere on the grid; `ValueError` for a parameter
    that is not free, a grid with fewer than two values or outside the bounds, or fewer than 5 points.

    **Source:** Venzon & Moolgavkar 1988, Appl. Stat. 37, 87-94.
    """
    if points < 5:
        raise ValueError(f"Argument `points` must be at least 5, but is {points}.")
    problem, states, found, values, stopped = _begin(model, free, targets, priors, solver, grid)
    labels = slot_labels(problem)
    if parameter not in labels:
        known = ", ".join(f"`{label}`" for label in labels)
        raise ValueError(f"Argument `parameter` must be one of {known}, but is {parameter!r}.")
    index = labels.index(parameter)
    bounds = [slot.bounds for slot in problem.slots for _ in range(slot.size)][index]
    error = np.nan if found is None else float(np.sqrt(found.covariance[index, index]))
    chosen = _grid(grid, points, float(values[index]), error, bounds, parameter)
    with jax.enable_x64(True):
        order, turn = _walk(chosen, float(values[index]))
        walked = jax.device_get(
            _follow(
                problem,
                states,
                jnp.asarray(values),
                jnp.asarray(index),
                jnp.asarray(order),
                jnp.asarray(turn),
                SOLVER if solver is None else solver,
            )
        )
    unit = [slot.unit for slot in problem.slots for _ in range(slot.size)][index]
    return _report(parameter, unit, labels, found, values, index, order, walked, stopped)


def _begin(
    model: PyTree, free: Free, targets: Targets, priors: Sequence[AbstractPrior], solver: Any, grid: Any
) -> tuple[Problem, Any, Fit | None, Float[np.ndarray, " p"], tuple[str, ...]]:
    """The problem and where its profile begins: at its fit, or, with a grid, where the model stands."""
    try:
        posed = pose(model, free, targets, priors, solver)
    except FitError as error:
        if grid is None:
            raise
        problem, states = lay_out(model, free, targets, priors)
        with jax.enable_x64(True):
            start = np.asarray(problem.start())
        words = (
            f"There is no fit to compare with, the profile began at the model's own numbers: {error.what}."
        )
        return problem, states, None, start, (words,)
    return posed.problem, posed.states, posed.fit, np.asarray(posed.values), ()


def _grid(
    grid: Numbers | None, points: int, best: float, error: float, bounds: AbstractBounds, name: str
) -> Float[np.ndarray, " n"]:
    if grid is None:
        # Even steps on the sampler's line, where no value is out of bounds.
        with jax.enable_x64(True):
            line = bounds.stretch(jnp.asarray(best))
            step = error / np.exp(float(bounds.shrink(line)[1]))
            step = step if isinstance(bounds, Real) else min(step, WIDEST)
            offsets = np.linspace(-REACH, REACH, points)
            offsets = offsets[np.abs(offsets) > 1e-6 * REACH]  # the best value itself is known
            values = np.unique(bounds.shrink(line + step * jnp.asarray(offsets))[0])
        return values[[bounds.contains(np.asarray(value)) for value in values]]
    values = np.unique(np.asarray(as_row(grid), float).ravel())
    if values.size < 2:
        raise ValueError(f"Argument `grid` must hold at least two different values, but holds {values.size}.")
    if not bounds.contains(values):
        raise ValueError(f"Argument `grid` must hold values of `{name}` that are {bounds}, but one is not.")
    return values


def _walk(grid: Float[np.ndarray, " n"], best: float) -> tuple[np.ndarray, np.ndarray]:
    """The grid upwards from the best value, then downwards; and where to return to the fit first."""
    above, below = grid[grid > best], grid[grid < best][::-1]
    turn = np.zeros(above.size + below.size, bool)
    turn[above.size : above.size + 1] = True
    return np.concatenate([above, below]), turn


@eqx.filter_jit
def _follow(
    problem: Problem,
    states: Any,
    best: Float[Array, " p"],
    index: Int[Array, ""],
    order: Float[Array, " n"],
    turn: Bool[Array, " n"],
    solver: AbstractSolver,
) -> Minimum:
    """Minima along a walk, each from the last one that converged."""
    held = jnp.arange(best.size) == index

    def step(last, at):
        value, turns = at
        start = jnp.where(turns, best, last)
        found = minimise(problem, states, start.at[index].set(value), held, solver)
        return jnp.where(found.converged, found.values, start), found

    return jax.lax.scan(step, best, (order, turn))[1]


def _report(
    label: str,
    unit: str,
    labels: tuple[str, ...],
    fit: Fit | None,
    values: Float[np.ndarray, " p"],
    index: int,
    order: Float[np.ndarray, " n"],
    walked: Minimum,
    warnings: tuple[str, ...],
) -> Profile:
    grid, everything = order, walked.values
    cost = np.where(walked.converged, walked.cost, np.nan)
    if fit is not None:
        grid, cost = np.append(grid, values[index]), np.append(cost, fit.cost)
        everything = np.concatenate([everything, values[None]])
    place = np.argsort(grid)
    grid, cost, everything = grid[place], cost[place], np.asarray(everything)[place]
    if not np.any(np.isfinite(cost)):
        raise FitError(
            f"At no value of {label} did the other numbers settle",
            "values far from where the model makes sense, or other numbers that the data cannot separate",
            "a grid nearer to the fit, bounds, or a prior",
        )
    least, best = float(np.nanmin(cost)), float(grid[int(np.nanargmin(cost))])
    texts = list(warnings)
    if fit is not None and 2 * (fit.cost - least) > BELOW:
        texts.append(
            f"The cost is lower at {label} = {best:.4g} than where the fit stopped: there is more than one valley. "
            "Fit with several `starts`."
        )
    lost = int(np.sum(~np.isfinite(cost)))
    if lost:
        texts.append(
            f"At {lost} of {grid.size} values of {label} the other numbers did not settle: they are left out."
        )
    return Profile(label, unit, labels, grid, 2 * (cost - least), everything, best, fit, tuple(texts))


def _cross(grid, root, inside: int, outside: int, limit: float) -> float:
    """Where √excess, nearly straight between two values of the grid, reaches the limit."""
    part = (limit - root[inside]) / (root[outside] - root[inside])
    return grid[inside] + part * (grid[outside] - grid[inside])
