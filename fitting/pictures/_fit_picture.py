"""Find the scene whose picture agrees best with a given one."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Float, PyTree

from jaxocean._numerics import check_kind
from jaxocean.render import Raster, Rays

from .._bounds import AbstractBounds, Interval, Real
from .._errors import FitError
from .._parameters import Parameter, Slot, attach_priors, resolve, split
from .._priors import AbstractPrior
from ._picture_target import PictureTarget
from ._sandwich import TILES, sandwich

THRESHOLDS = Interval(-3.0, 1.0)
"""Where ε [-] lies if nothing else is said."""

FINISHES = 3
"""Steps with a more exact method, of which each draws one picture."""

Free = Callable | Parameter | Sequence[Callable | Parameter]


@dataclass(frozen=True)
class PictureStep:
    """One step of a fit.

    - `number`: counted from 0, the start; `cost`: half the sum of squared residuals there.
    - `values`: of the free numbers by name.
    """

    number: int
    cost: float
    values: dict[str, float | Float[np.ndarray, "..."]]


@dataclass(frozen=True)
class PictureFit:
    """A finished fit of a scene to a picture.

    - `values`, `errors`: of the free leaves by name. Errors come from how the residuals of `TILES`² parts of the image
      pull, so that neighbouring pixels may err together.
    - `labels`: a name for each free number, the order of `covariance`.
    - `cost`: half the sum of squared residuals at the solution; `steps`: all that were accepted, the start first.
    - `model`: the scene with its fitted numbers.
    """

    values: dict[str, float | Float[np.ndarray, "..."]]
    errors: dict[str, float | Float[np.ndarray, "..."]]
    labels: tuple[str, ...]
    covariance: Float[np.ndarray, "p p"]
    cost: float
    steps: tuple[PictureStep, ...]
    seconds: float
    model: Any

    @property
    def correlations(self) -> Float[np.ndarray, "p p"]:
        """Of the errors of all free numbers."""
        deviation = np.sqrt(np.diag(self.covariance))
        return self.covariance / np.outer(deviation, deviation)


def fit_picture(
    model: eqx.Module,
    free: Free,
    target: PictureTarget,
    *,
    priors: Sequence[AbstractPrior] = (),
    method: Raster | Rays | None = None,
    finish: Raster | Rays | None = None,
    tolerance: float = 1e-3,
    most_steps: int = 40,
    report: Callable[[PictureStep], None] | None = None,
) -> PictureFit:
    """Fit the numbers of a scene to a picture of the very sea whose noise the scene holds.

    $$ \\min_θ ½ \\sum_l |r_l(θ)|² + ½ \\sum_p r_p(θ)² $$

    by Levenberg–Marquardt steps of `optimistix`, with the picture's derivative taken forward, one number after the
    other. Pictures are drawn in the type of the noise, steps are taken in float64.

    **Arguments:**

    - `model`: a `SceneModel`, or another module that answers `picture(size, method)`; its leaves are the starting
      point.
    - `free`: which leaves may change, as for `fitting.fit`: `lambda m: (m.wind.speed, m.choppiness, m.exposure)`.
    - `target`: the picture; `priors`: as for `fitting.fit`.
    - `method`: how pixels find the sea; a mesh with one shaded point for 2 × 2 pixels if None.
    - `finish`: a more exact method for the end: up to `FINISHES` Gauss–Newton steps with its residuals and the other
      method's derivatives, as long as they lower the cost. What `method` gets wrong everywhere alike is then no longer
      in the numbers.
    - `tolerance`: relative change of numbers and residuals below which it is done.
    - `most_steps`: after which it gives up.
    - `report`: called with the start and with each step that lowers the cost.

    **Returns:** `PictureFit`.

    **Raises:** `ValueError` for arguments that make no sense; `FitError` if the picture is not finite at the start, or
    if the fit does not come to rest.
    """
    if not callable(getattr(model, "picture", None)):
        raise ValueError(
            "Argument `model` must answer `picture(size, method)`, as a `SceneModel` does, but is a "
            f"{type(model).__name__}."
        )
    check_kind("target", target, PictureTarget, "a `PictureTarget`")
    if not 0 < tolerance < 1:
        raise ValueError(f"Argument `tolerance` must be between 0 and 1, but is {tolerance:g}.")
    if most_steps < 1:
        raise ValueError(f"Argument `most_steps` must be at least 1, but is {most_steps}.")
    method = Raster(shading_rate=(2, 2)) if method is None else method
    began = time.perf_counter()
    slots = [
        (_bounded(slot), prior) for slot, prior in attach_priors(model, resolve(model, free, 1), list(priors))
    ]
    with jax.enable_x64(True):
        problem = _Problem(model, target, tuple(p for _, p in slots), tuple(s for s, _ in slots), method)
        free_values, steps = _descend(problem, tolerance, most_steps, report)
        rows, jacobian = _look(problem, free_values)
        if finish is not None:
            free_values, rows = _finish(problem.by(finish), free_values, jacobian)
        values = np.asarray(problem.constrain(free_values))
        covariance = _covariance(problem, rows, jacobian / problem.stretch(free_values))
    errors = np.sqrt(np.diag(covariance))
    return PictureFit(
        problem.named(values),
        problem.named(errors),
        tuple(label for slot in problem.slots for label in slot.labels(())),
        covariance,
        0.5 * float(jnp.sum(rows**2)),
        tuple(steps),
        time.perf_counter() - began,
        problem.put(values, as_given=True),
    )


def _finish(problem: "_Problem", free: Array, jacobian: Array) -> tuple[Array, Array]:
    """Gauss–Newton steps with the residuals of one method and the derivatives of another."""
    rows = _rows(problem, free)
    for _ in range(FINISHES):
        ahead = free - jnp.linalg.lstsq(jacobian, rows)[0]
        there = _rows(problem, ahead)
        if not float(jnp.sum(there**2)) < float(jnp.sum(rows**2)):
            break
        free, rows = ahead, there
    return free, rows


def _covariance(problem: "_Problem", rows: Array, jacobian: Array) -> np.ndarray:
    """Of the numbers themselves; see `sandwich`."""
    target, data = problem.target, rows.size - problem.prior_size
    weights = jax.vmap(target.of_pixels, in_axes=1, out_axes=1)(jacobian[:data])
    # The finest level comes first, and is the pixels themselves.
    pulls = rows[: weights.shape[0], None] * weights
    own, priors = (part.T @ part for part in (jacobian[:data], jacobian[data:]))
    return sandwich(*(np.asarray(each) for each in (pulls, target.places(TILES), own, priors)))


def _bounded(slot: Slot) -> Slot:
    """Above 1 the whole sea is foam and nothing tells ε: a step that is too long must not end there."""
    is_threshold = slot.name.rsplit(".", 1)[-1] == "threshold" and isinstance(slot.bounds, Real)
    return replace(slot, bounds=THRESHOLDS) if is_threshold else slot


class _Problem(eqx.Module):
    """Residuals of a flat vector of free numbers."""

    model: Any
    target: PictureTarget
    priors: tuple[AbstractPrior | None, ...]
    slots: tuple[Slot, ...] = eqx.field(static=True)
    method: Raster | Rays = eqx.field(static=True)

    def start(self) -> Float[Array, " p"]:
        leaves = jax.tree.leaves(self.model)
        values = jnp.concatenate([jnp.ravel(jnp.asarray(leaves[s.index], float)) for s in self.slots])
        return self._each(values, lambda bounds, x: bounds.unconstrain(x))

    def constrain(self, free: Float[Array, " p"]) -> Float[Array, " p"]:
        return self._each(free, lambda bounds, x: bounds.constrain(x))

    def stretch(self, free: Float[Array, " p"]) -> Float[Array, " p"]:
        """How fast values change with free numbers."""
        return jax.jvp(self.constrain, (free,), (jnp.ones_like(free),))[1]

    def rows(self, free: Float[Array, " p"]) -> Float[Array, " n"]:
        values = self.constrain(free)
        picture = self.put(values).picture(self.target.size, self.method)
        parts = [self.target.residuals(picture).astype(values.dtype)]
        for prior, part in zip(self.priors, split(self.slots, values), strict=True):
            if prior is not None:
                parts.append(prior.residual(part).ravel())
        return jnp.concatenate(parts)

    def by(self, method: Raster | Rays) -> "_Problem":
        """The same with pictures drawn in another way."""
        return _Problem(self.model, self.target, self.priors, self.slots, method)

    @property
    def prior_size(self) -> int:
        return sum(s.size for s, prior in zip(self.slots, self.priors, strict=True) if prior is not None)

    def put(self, values: Any, *, as_given: bool = False) -> Any:
        """The scene with these numbers, in doubles or in the types that they came in."""
        leaves, treedef = jax.tree.flatten(self.model)
        for slot, part in zip(self.slots, split(self.slots, values), strict=True):
            leaves[slot.index] = jnp.asarray(part, leaves[slot.index].dtype) if as_given else part
        return treedef.unflatten(leaves)

    def named(self, values: np.ndarray) -> dict[str, Any]:
        parts = split(self.slots, values)
        return {
            slot.name: float(part) if part.ndim == 0 else part
            for slot, part in zip(self.slots, parts, strict=True)
        }

    def _each(self, values: Float[Array, " p"], change: Callable[[AbstractBounds, Any], Any]) -> Array:
        parts = zip(self.slots, split(self.slots, values), strict=True)
        return jnp.concatenate([change(slot.bounds, part).ravel() for slot, part in parts])


@eqx.filter_jit
def _look(problem: _Problem, free: Float[Array, " p"]) -> tuple[Float[Array, " n"], Float[Array, "n p"]]:
    """Residuals and their derivatives, one direction after the other in a loop: one program to compile for all."""

    def along(direction):
        return jax.jvp(problem.rows, (free,), (direction,))

    rows, changes = jax.lax.map(along, jnp.eye(free.size))
    return rows[0], changes.T


@eqx.filter_jit
def _rows(problem: _Problem, free: Float[Array, " p"]) -> Float[Array, " n"]:
    return problem.rows(free)


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


def _descend(problem: _Problem, tolerance: float, most_steps: int, report: Callable | None):
    """Levenberg–Marquardt, step by step: whoever waits may watch, and one picture is drawn for each step."""
    solver = optx.LevenbergMarquardt(tolerance, tolerance, norm=optx.rms_norm)
    y = problem.start()
    known = _look(problem, y)
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
    accepted, best = [], jnp.inf
    for number in range(most_steps + 1):
        cost = 0.5 * float(jnp.sum(known[0] ** 2))
        if cost < best:
            best = cost
            accepted.append(
                PictureStep(number, cost, problem.named(np.asarray(problem.constrain(state.y_eval))))
            )
            if report is not None:
                report(accepted[-1])
        y, state = _solver_step(solver, y, state, jax.tree.map(lambda each: scale * each, known))
        if bool(state.terminate):
            return y, accepted
        known = _look(problem, state.y_eval)
        # A step too far is one that the solver shall take back.
        finite = jnp.all(jnp.isfinite(known[0]))
        known = (
            jnp.where(finite, known[0], jnp.sqrt(jnp.finfo(float).max) / known[0].size),
            jnp.where(finite, known[1], 0.0),
        )
    raise FitError(
        f"The fit did not come to rest in {most_steps} steps",
        "a picture that these numbers cannot explain, or numbers that it does not tell apart",
        "start closer, free fewer numbers, give priors, or allow more steps",
    )
