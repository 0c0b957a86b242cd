"""Find the scene whose picture agrees best with a given one."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean._numerics import check_kind
from jaxocean.render import Raster, Rays

from .._bounds import Interval, Real
from .._errors import FitError
from .._parameters import Parameter, Slot, attach_priors, resolve
from .._priors import AbstractPrior
from .._target import AbstractTarget, KnownScatter, TargetSum, flatten_targets
from ._descent import Descent, PictureStep, finish_with, shift
from ._descent import refine as refined
from ._picture_target import PictureTarget
from ._problem import PictureProblem
from ._sandwich import TILES, sandwich
from ._scout import awaken, scout

COARSE, COARSE_TOLERANCE = 3, 0.03
"""Levels that are left out at first, and how closely that is solved: crests that lie elsewhere than in the target show
no way in single pixels, but do in squares that are wider than they are off."""

THRESHOLDS = Interval(-3.0, 1.0)
"""Where ε [-] lies if nothing else is said."""

HEAT = 5
"""Steps after which only one of two ways down is gone on with."""

FOAMY = np.linspace(0.1, 0.95, 18)
"""Values of ε that are tried after the coarse squares, from which it may have gone where there is no foam."""

Free = Callable | Parameter | Sequence[Callable | Parameter]


@dataclass(frozen=True)
class PictureFit:
    """A finished fit of a scene to a picture.

    - `values`, `errors`: of the free leaves by name. Errors come from how the residuals of `TILES`² parts of the image
      pull, so that neighbouring pixels may err together, and from other methods that are in doubt.
    - `labels`: a name for each free number, the order of `covariance`.
    - `doubted`: the part of `covariance` that comes from methods in doubt.
    - `scatter` [-]: with this as the target's `scatter` the picture's residuals, taken as independent, have errors as
      large as these in the (geometric) mean.
    - `cost`: half the sum of squared residuals at the solution; `steps`: all that were accepted, the start first.
    - `model`: the scene with its fitted numbers.
    """

    values: dict[str, float | Float[np.ndarray, "..."]]
    errors: dict[str, float | Float[np.ndarray, "..."]]
    labels: tuple[str, ...]
    covariance: Float[np.ndarray, "p p"]
    doubted: Float[np.ndarray, "p p"]
    scatter: float
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
    beside: AbstractTarget | TargetSum | None = None,
    priors: Sequence[AbstractPrior] = (),
    method: Raster | Rays | None = None,
    finish: Raster | Rays | Sequence[Raster | Rays] = (),
    detail: int = 1,
    refine: int = 0,
    doubts: Sequence[Raster | Rays] = (),
    scouts: int = 0,
    tolerance: float = 2e-3,
    most_steps: int = 40,
    report: Callable[[PictureStep], None] | None = None,
) -> PictureFit:
    """Fit the numbers of a scene to a picture of the very sea whose noise the scene holds.

    $$ \\min_θ ½ \\sum_l |r_l(θ)|² + ½ \\sum_t |r_t(θ)|² + ½ \\sum_p r_p(θ)² $$

    by Levenberg–Marquardt steps of `optimistix`, first for squares of 8 and more pixels and then for all, with the
    picture's derivative taken forward, one number after the other. Pictures are drawn in the type of the noise, steps
    are taken in float64.

    **Arguments:**

    - `model`: a `SceneModel`, or another module that answers `picture(size, method)`; its leaves are the starting
      point.
    - `free`: which leaves may change, as for `fitting.fit`: `lambda m: (m.wind.speed, m.choppiness, m.exposure)`.
    - `target`: the picture.
    - `beside`: other targets that the same numbers shall meet, such as a coverage law and slopes, each with a known
      scatter: `law + slopes`. They and priors weigh as much against the picture as the target's `scatter` says.
    - `priors`: as for `fitting.fit`.
    - `method`: how pixels find the sea; a mesh with one shaded point for 2 × 2 pixels if None.
    - `finish`: a more exact method for the end: Gauss–Newton steps with its residuals and the other method's
      derivatives, as long as they lower the cost. What `method` gets wrong everywhere alike is then no longer in the
      numbers. Of several the one counts that explains the picture best.
    - `detail`: pictures of `finish` are drawn with so many times the rows and columns and averaged, as a camera's are;
      above 1 the model answers `picture(size, method, detail)`.
    - `refine`: how many rounds of such steps follow at most, with derivatives by differences of the method that
      finishes, two pictures for each free number and round: where numbers are told apart so badly that the other's
      derivatives lead along a valley instead of down to its bottom. A round that gains nothing is the last, and
      errors are those by its derivatives.
    - `doubts`: other methods, without that detail, whose pictures might be as right: how far the numbers would move
      with each of them, to first order, counts as one standard error of its own. Those of `finish` that explain the
      picture less well are in doubt in any case.
    - `scouts`: how many scenes around the start are looked at before the first step, without derivatives: for a start
      that may lie in another valley than the target. From the best of them as well as from the start it goes down
      some steps on coarse squares, and then on from the lower one.
    - `tolerance`: it is done when numbers and residuals change by less than this share, or when three steps together
      lower the cost by less.
    - `most_steps`: for coarse squares, and again for all, after which it gives up.
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
    if scouts < 0:
        raise ValueError(f"Argument `scouts` must be at least 0, but is {scouts}.")
    if refine < 0 or (refine and not finish):
        raise ValueError(
            f"Argument `refine` must be at least 0, and 0 without a method in `finish`, but is {refine}."
        )
    if detail < 1:
        raise ValueError(f"Argument `detail` must be at least 1, but is {detail}.")
    finishes = [finish] if isinstance(finish, Raster | Rays) else list(finish)
    others = () if beside is None else flatten_targets(beside)
    for other in others:
        if not isinstance(other.scatter, KnownScatter):
            raise ValueError(
                f"Argument `beside` must hold targets of known scatter, but that of {other.name} is free."
            )
    method = Raster(shading_rate=(2, 2)) if method is None else method
    began = time.perf_counter()
    slots = [
        (_bounded(slot), prior) for slot, prior in attach_priors(model, resolve(model, free, 1), list(priors))
    ]
    with jax.enable_x64(True):
        problem = PictureProblem(
            model, target, others, tuple(p for _, p in slots), tuple(s for s, _ in slots), method
        )
        free_values, steps = problem.start(), []
        coarse = min(COARSE, target.levels - 1)
        if coarse:
            stage = problem.against(target.without(coarse))
            way = _coarsely(stage, free_values, scouts, most_steps, coarse, report)
            free_values, steps = way.free, way.steps
        elif scouts:
            free_values = scout(problem, free_values, scouts)
        place = 0
        for slot in problem.slots:
            if slot.bounds is THRESHOLDS:
                free_values = awaken(problem, free_values, place, FOAMY)
            place += slot.size
        way = Descent(problem, free_values, tolerance, number=len(steps), report=report)
        if not way.go(most_steps):
            raise FitError(
                f"The fit did not come to rest in {most_steps} steps",
                "a picture that these numbers cannot explain, or numbers that it does not tell apart",
                "start closer, free fewer numbers, give priors, or allow more steps",
            )
        free_values, rows, jacobian = way.free, way.rows, way.jacobian
        steps = steps + way.steps
        ways = [problem.by(other, detail) for other in finishes]
        unsure = [problem.by(other) for other in doubts]
        if ways:
            ends = [finish_with(way, free_values, jacobian) for way in ways]
            costs = np.nan_to_num([float(jnp.sum(rows**2)) for _, rows in ends], nan=np.inf)
            if not np.any(np.isfinite(costs)):
                raise FitError(
                    "Pictures by the methods of `finish` are not finite",
                    "numbers that no scene has",
                    "start from another scene, or finish with another method",
                )
            best = int(np.argmin(costs))
            problem, (free_values, rows) = ways[best], ends[best]
            unsure += ways[:best] + ways[best + 1 :]
            free_values, rows, jacobian = refined(problem, free_values, rows, jacobian, refine)
        values = np.asarray(problem.constrain(free_values))
        stretch = problem.stretch(free_values)
        covariance, scatter = _covariance(problem, rows, jacobian / stretch)
        doubted = np.zeros_like(covariance)
        for other in unsure:
            moved = np.asarray(stretch * shift(other, free_values, rows, jacobian))
            doubted = doubted + np.outer(moved, moved)
        covariance = covariance + doubted
    errors = np.sqrt(np.diag(covariance))
    return PictureFit(
        problem.named(values),
        problem.named(errors),
        tuple(label for slot in problem.slots for label in slot.labels(())),
        covariance,
        doubted,
        scatter,
        0.5 * float(np.sum(np.square(rows))),
        tuple(steps),
        time.perf_counter() - began,
        problem.put(values, as_given=True),
    )


def _coarsely(
    stage: PictureProblem,
    start: Array,
    scouts: int,
    most_steps: int,
    finest: int,
    report: Callable | None,
) -> Descent:
    """The way down on coarse squares from the start, or from the best of some scouts if that is soon lower."""
    if not scouts:
        way = Descent(stage, start, COARSE_TOLERANCE, finest=finest, report=report)
        way.go(most_steps)
        return way
    begins, heat = (start, scout(stage, start, scouts)), min(HEAT, most_steps)
    ways = [Descent(stage, each, COARSE_TOLERANCE, finest=finest) for each in begins]
    for each in ways:
        each.go(heat)
    best = min(ways, key=lambda each: each.cost)
    # What is told are the steps of the fit, not those of a way that leads nowhere.
    if report is not None:
        for step in best.steps:
            report(step)
    best.report = report
    best.go(most_steps - heat)
    return best


def _covariance(problem: PictureProblem, rows: Array, jacobian: Array) -> tuple[np.ndarray, float]:
    """Of the numbers themselves, see `sandwich`; and the scatter of independent residuals that tell as much."""
    target, data = problem.target, rows.size - problem.size_beside
    weights = jax.vmap(target.of_pixels, in_axes=1, out_axes=1)(jacobian[:data])
    # The finest level comes first, and is the pixels themselves, but for the scatter.
    pulls = target.scatter.astype(rows.dtype) * rows[: weights.shape[0], None] * weights
    own, others = (part.T @ part for part in (jacobian[:data], jacobian[data:]))
    found = sandwich(*(np.asarray(each) for each in (pulls, target.places(TILES), own, others)))
    naive = np.linalg.pinv(np.asarray(own + others), hermitian=True)
    ratio = np.maximum(np.diag(found) / np.diag(naive), np.finfo(float).tiny)
    return found, float(target.scatter) * float(np.exp(0.5 * np.mean(np.log(ratio))))


def _bounded(slot: Slot) -> Slot:
    """Above 1 the whole sea is foam and nothing tells ε: a step that is too long must not end there."""
    is_threshold = slot.name.rsplit(".", 1)[-1] == "threshold" and isinstance(slot.bounds, Real)
    return replace(slot, bounds=THRESHOLDS) if is_threshold else slot
