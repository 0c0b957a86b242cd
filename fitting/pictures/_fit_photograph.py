"""Find the state of a sea from a photograph whose waves are unknown."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from jaxocean.render import Raster, Rays

from .._bounds import Interval
from .._errors import FitError
from .._parameters import Slot
from .._priors import AbstractPrior
from . import _sought
from ._descent import PictureStep
from ._photograph import Photograph
from ._picture_target import Image, Mask, check_light
from ._statistics_target import Vary
from ._summaries import Lesson
from ._synthetic_likelihood import DRAWN, descend
from ._teach import Free, pose, teach

ROUGH = Raster(2.0), 2
"""Draws derivatives, with so many times the rows and columns."""


@dataclass(frozen=True)
class PhotographFit:
    """A state of the sea and its light that explains the statistics of a photograph.

    - `values`, `errors`: of the free leaves by name; `covariance` of all free numbers (`labels`) on the real line of
      their bounds, where they are nearly normal; see `interval`.
    - `guess`: the values that a regression alone gives, where the way down began.
    - `names`, `observed`, `predicted`, `chance`: the statistics of the photograph, their mean over pictures of the
      state found, and their standard deviation from one picture to the next.
    - `misfit`: mean square of (observed − predicted)/chance over the statistics that count, 1 if the model explains the
      photograph. What the fit is made of are few combinations of them; where these disagree by more than chance, the
      errors are larger by as much.
    - `steps`: of the way down; `model`: the state found, with the noise that it came with; `lesson`: for photographs of
      the same camera.
    """

    values: dict[str, float]
    errors: dict[str, float]
    guess: dict[str, float]
    labels: tuple[str, ...]
    covariance: Float[np.ndarray, "p p"]
    names: tuple[str, ...]
    observed: Float[np.ndarray, " m"]
    predicted: Float[np.ndarray, " m"]
    chance: Float[np.ndarray, " m"]
    misfit: float
    steps: tuple[PictureStep, ...]
    seconds: float
    model: Photograph
    lesson: Lesson
    size: tuple[int, int]
    slots: tuple[Slot, ...]

    def at(self, values: Mapping[str, Any]) -> Photograph:
        """The state with other values of the free numbers, such as those of a step."""
        leaves, structure = jax.tree.flatten(self.model)
        for slot in self.slots:
            leaves[slot.index] = jnp.asarray(values[slot.name], leaves[slot.index].dtype)
        return structure.unflatten(leaves)

    def interval(self, name: str, level: float = 0.9) -> tuple[float, float]:
        """Between which two values a number lies with that probability.

        **Raises:** `ValueError` for a number that was not free, or a level that is not between 0 and 1.
        """
        if name not in self.labels:
            raise ValueError(f"Argument `name` must be one of {', '.join(self.labels)}, but is {name!r}.")
        if not 0 < level < 1:
            raise ValueError(f"Argument `level` must be between 0 and 1, but is {level:g}.")
        place = self.labels.index(name)
        bounds = self.slots[place].bounds
        middle = bounds.unconstrain(jnp.asarray(self.values[name]))
        half = NormalDist().inv_cdf(0.5 + 0.5 * level) * np.sqrt(self.covariance[place, place])
        ends = np.array([middle - half, middle + half])
        if isinstance(bounds, Interval):
            # Beyond its ends the line is folded back.
            ends = np.clip(ends, -0.5 * np.pi, 0.5 * np.pi)
        elif _sought.is_angle(self.slots[place]):
            ends = np.array([middle - min(half, np.pi), middle + min(half, np.pi)])
        low, high = (float(bounds.constrain(jnp.asarray(end))) for end in ends)
        return low, high


def fit_photograph(
    photograph: Photograph,
    free: Free,
    image: Image,
    *,
    mask: Mask | None = None,
    priors: Sequence[AbstractPrior] = (),
    vary: Vary | None = None,
    method: Raster | Rays | None = None,
    derivatives: Raster | Rays | None = None,
    detail: int = 1,
    scouts: int = 640,
    seas: int = 16,
    lesson: Lesson | None = None,
    begin: Mapping[str, float] | None = None,
    most_steps: int = 2,
    seed: int = 0,
    report: Callable[[PictureStep], None] | None = None,
) -> PhotographFit:
    """Fit the state of a sea to a photograph of other waves than the model's: by what `ImageStatistics` say of it.

    $$ \\min_θ ½\\, (\\bar η(θ) - η)^T Σ^{-1} (\\bar η(θ) - η) + ½ \\sum_p r_p(θ)² $$

    A lesson (see `teach`) says which combinations η of the statistics tell the free numbers. The photograph's η then
    are data: they are compared with their mean over some seas of the state θ, whose random numbers stay the same, and
    weighed by their covariance Σ over seas and over what `vary` draws (a synthetic likelihood, Wood 2010). From what
    the regression says it goes down by Gauss–Newton steps with the derivatives of the pictures.

    **Arguments:**

    - `photograph`: where to begin; its camera is that of the image.
    - `free`: which single numbers may change, as for `fitting.fit`. Scouts are drawn from their priors; angles without
      a prior from the whole circle, others from within their bounds.
    - `image`: linear light in any unit; `mask`: 0 where it shows something else.
    - `priors`: as for `fitting.fit`.
    - `vary(photograph, key)`: the same with those numbers drawn that are neither known nor sought, such as the haze.
    - `method`: how pixels find the sea, `Rays((4, 2))` if None: a mesh, and fewer rays, hold too few of the waves below
      the horizon and show too much texture nearby, and winds come out wrong by a third.
    - `derivatives`: the same for derivatives, which may be rougher; `Raster(2.0)` with twice the rows and columns if
      None.
    - `detail`: pictures are drawn with so many times the rows and columns and averaged.
    - `lesson`: what `teach` learned of the camera, with images of the same size, the same mask, free numbers and
      `vary`; if None, `scouts` pictures are drawn to learn it.
    - `seas`: how many are drawn for a derivative, at most 32; means are over 32.
    - `begin`: values of the free numbers by name, from where to go down; what the regression says if None.
    - `most_steps`: of the way down.
    - `seed`: of all random numbers.
    - `report`: called with each step that lowers the cost.

    **Returns:** `PhotographFit`.

    **Raises:** `ValueError` for arguments that make no sense; `FitError` if pictures or derivatives are not finite.
    """
    for name, number in (("seas", seas), ("most_steps", most_steps)):
        if number < 1:
            raise ValueError(f"Argument `{name}` must be at least 1, but is {number}.")
    if seas > DRAWN:
        raise ValueError(f"Argument `seas` must be at most {DRAWN}, but is {seas}.")
    check_light(image, mask)
    began = time.perf_counter()
    size = int(image.shape[0]), int(image.shape[1])
    with jax.enable_x64(True):
        problem = pose(photograph, free, size, mask, priors, vary, method, detail, seas, seed)
        before = None if begin is None else _sought.from_names(problem, begin)
    if lesson is None:
        lesson = teach(
            photograph,
            free,
            size,
            mask=mask,
            priors=priors,
            vary=vary,
            method=method,
            detail=detail,
            scouts=scouts,
            seed=seed,
        )
    statistics = problem.target.statistics
    _sought.check_lesson(problem, lesson)
    observed = np.asarray(
        eqx.filter_jit(statistics)(jnp.asarray(image, photograph.scene.noise.real.dtype)), float
    )
    with jax.enable_x64(True):
        kept = _sought.kept(problem, lesson)
        if not np.any(kept):
            raise FitError(
                "The statistics of the image tell nothing of the free numbers",
                "a view of too little sea, or a mask that hides it",
                "show more of the sea, or free other numbers",
            )
        # All programs take the same doubles, whether a lesson is new or comes from a file.
        summaries = jax.tree.map(jnp.asarray, lesson.summaries)
        aim = summaries(jnp.asarray(observed))
        guess = jnp.asarray(_sought.from_goals(problem, np.asarray(aim)))
        start = guess if before is None else before
        scattered = _sought.scattered(problem, seed)
        rough = problem.by(*ROUGH) if derivatives is None else problem.by(derivatives, detail)
        end = descend(problem, rough, kept, summaries, aim, start, scattered, most_steps, seed, report)
        predicted, chance = end.drawn.mean(axis=0), end.drawn.std(axis=0, ddof=1)
        used = np.asarray(statistics.steady) & (chance > 1e-9)
        misfit = float(np.mean(((observed - predicted)[used] / chance[used]) ** 2))
        covariance = _sought.no_smaller(problem, lesson, end.covariance(), scattered[1])
        values = np.asarray(problem.constrain(end.free))
        stretch = np.abs(np.asarray(problem.stretch(end.free)))
        guessed = problem.named(np.asarray(problem.constrain(guess)))
    return PhotographFit(
        problem.named(values),
        problem.named(np.sqrt(np.diag(covariance)) * stretch),
        guessed,
        tuple(slot.name for slot in problem.slots),
        covariance,
        statistics.names,
        observed,
        predicted,
        chance,
        misfit,
        end.steps,
        time.perf_counter() - began,
        problem.put(values, as_given=True).photograph,
        lesson,
        size,
        problem.slots,
    )
