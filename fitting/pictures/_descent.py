"""The way down to the scene whose picture agrees best, step by step."""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Float, PyTree

from jaxocean.render import Rays

from .._errors import FitError
from ._problem import PictureProblem, look, look_once, rows_of

LARGE = 60_000
"""Places on the water from which not all is kept for a derivative: that takes some 30 kB each."""

PATIENCE = 3
"""Steps that must together lower the cost by more than the tolerance."""

FINISHES = 12
"""Steps with a more exact method at most, of which each draws one picture."""

FINISHED = 1e-4
"""Share of the cost below which another one gains nothing: with derivatives of another method they only come closer by
a factor each."""

DIFFERENCE = 2e-2
"""Of a free number, over which pictures are held against each other: so wide that crests move across pixels, and that
what samples of pixels do by chance says little. Over a tenth of it steps are a quarter as long as they should be."""


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


class Descent:
    """A way down by Levenberg–Marquardt steps, so many at a time, so that whoever waits may watch, and turn back.

    - `free`, `rows`, `jacobian`: the lowest point so far, with its residuals and their derivatives; `cost`: half the
      sum of squared residuals there.
    - `steps`: all that lowered the cost, the start first; `report`: called with each of them from now on.
    """

    def __init__(
        self,
        problem: PictureProblem,
        start: Array,
        tolerance: float,
        *,
        finest: int = 0,
        number: int = 0,
        report: Callable | None = None,
    ) -> None:
        """Look at the start.

        **Arguments:** `tolerance`: as for `fit_picture`; `finest`: levels that are left out; `number`: of the first
        step; `report`: called with each.
        """
        self._problem, self._tolerance = problem, tolerance
        self._finest, self._number, self.report = finest, number, report
        self._derive = look if _places(problem) > LARGE else look_once
        self._seen = self._derive(problem, start)
        if not all(bool(jnp.all(jnp.isfinite(each))) for each in self._seen):
            raise FitError(
                "The picture of the starting scene, or its derivative, is not finite",
                "a number that no scene has",
                "start from another scene",
            )
        solver = optx.LevenbergMarquardt(tolerance, 1e-4 * tolerance, norm=optx.rms_norm)
        # Steps grow as soon as the cost falls half as foreseen: each costs a picture for every free number.
        self._solver = eqx.tree_at(
            lambda s: s.search, solver, optx.ClassicalTrustRegion(high_cutoff=0.5, low_cutoff=0.05)
        )
        # The solver's first step is damped as suits residuals of order 1.
        self._scale = 1 / jnp.sqrt(jnp.sum(self._seen[0] ** 2) + jnp.finfo(float).tiny)
        struct = jax.eval_shape(lambda: self._seen[0])
        self._y = start
        self._state = self._solver.init(
            lambda y, known: (_known(y, *known), None), start, self._seen, {}, struct, None, frozenset()
        )
        self.steps: list[PictureStep] = []
        self._costs: list[float] = []
        self._keep(start)
        self._choose()

    def go(self, most_steps: int) -> bool:
        """Take steps, those that are taken back among them; True if no more are worth it."""
        for _ in range(most_steps):
            if self._at_rest:
                break
            rows, jacobian = self._derive(self._problem, self._state.y_eval)
            # A step too far is one that the solver shall take back.
            finite = jnp.all(jnp.isfinite(rows))
            self._seen = (
                jnp.where(finite, rows, jnp.sqrt(jnp.finfo(float).max) / rows.size),
                jnp.where(finite, jacobian, 0.0),
            )
            self._keep(self._state.y_eval)
            self._choose()
        return self._at_rest

    def _keep(self, free: Array) -> None:
        """What was seen there, if it is lower than before."""
        rows, jacobian = self._seen
        cost = 0.5 * float(jnp.sum(rows**2))
        if self._costs and cost >= self._costs[-1]:
            return
        self.free, self.rows, self.jacobian, self.cost = free, rows, jacobian, cost
        self._costs.append(cost)
        values = self._problem.named(np.asarray(self._problem.constrain(free)))
        self.steps.append(PictureStep(self._number + len(self.steps), 2**self._finest, cost, values))
        if self.report is not None:
            self.report(self.steps[-1])

    def _choose(self) -> None:
        """Where to look next, if anywhere."""
        known = jax.tree.map(lambda each: self._scale * each, self._seen)
        self._y, self._state = _solver_step(self._solver, self._y, self._state, known)
        # The derivative of a picture is rough: near the end many steps gain hardly anything.
        before = self._costs[-1 - PATIENCE] if len(self._costs) > PATIENCE else np.inf
        self._at_rest = bool(self._state.terminate) or before - self.cost < self._tolerance * self.cost


def _places(problem: PictureProblem) -> float:
    """How many places on the water a picture looks at."""
    rows, columns = problem.target.size
    pixels, method = rows * columns * problem.detail**2, problem.method
    if isinstance(method, Rays):
        return float(pixels * np.prod(method.sides))
    return float(pixels / np.prod(method.shading_rate) + pixels / method.spacing**2)


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


def refine(
    problem: PictureProblem, free: Array, rows: Array, jacobian: Array, rounds: int
) -> tuple[Array, Array, Array]:
    """Gauss–Newton steps with derivatives by differences of the method's own pictures, which each round takes anew, as
    long as a round gains something; where they end, with the last of these derivatives, or those given if there is no
    round."""
    for _ in range(rounds):
        before = float(jnp.sum(rows**2))
        free, rows, jacobian = _refined(problem, free, rows)
        if not before - float(jnp.sum(rows**2)) > FINISHED * before:
            break
    return free, rows, jacobian


def _refined(problem: PictureProblem, free: Array, rows: Array) -> tuple[Array, Array, Array]:
    steps = DIFFERENCE * jnp.eye(free.size)
    sides = [[rows_of(problem, free + side * step) for side in (1, -1)] for step in steps]
    jacobian = jnp.stack([(ahead - behind) / (2 * DIFFERENCE) for ahead, behind in sides], axis=1)
    for _ in range(FINISHES):
        step = -jnp.linalg.lstsq(jacobian, rows)[0]
        gain = 0.0
        for share in (1.0, 0.5, 0.25):
            there = rows_of(problem, free + share * step)
            gain = 1 - float(jnp.sum(there**2) / jnp.sum(rows**2))
            if gain > 0:
                free, rows = free + share * step, there
                break
        if not gain > FINISHED:
            break
    return free, rows, jacobian


def shift(problem: PictureProblem, free: Array, rows: Array, jacobian: Array) -> Array:
    """How far free numbers would move, to first order, if the pictures were those of this problem and not those that
    gave `rows`."""
    return -jnp.linalg.lstsq(jacobian, rows_of(problem, free) - rows)[0]
