"""Find the state of a sea from a photograph whose waves are unknown."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean._numerics import check_kind
from jaxocean.render import Raster, Rays

from .._bounds import Interval
from .._errors import FitError
from .._parameters import Parameter, Slot, attach_priors, resolve
from .._priors import AbstractPrior
from . import _sought
from ._descent import PictureStep
from ._image_statistics import ImageStatistics
from ._photograph import Photograph
from ._picture_target import Image, Mask
from ._problem import PictureProblem, look
from ._statistics_target import Seas, StatisticsTarget, Vary, drawn_statistics
from ._summaries import Lesson, Summaries, learn

DRAWN = 32
"""Pictures of a state from which the chance of its statistics is known."""

MOST_FREE = 12
"""Numbers that are sought at once: the chance of what tells them must be known from few seas."""

METHOD = Rays((8, 1))
"""Draws pictures: of a pixel's long footprint on distant water many parts, each of its own light."""

ROUGH = Raster(2.0), 2
"""Draws derivatives, with so many times the rows and columns."""

SCOUTS = 100_000
"""Between the seeds of scouts and of what is compared."""

GAIN = 0.5
"""Least gain in half a χ² that is worth a step: that of one number which moves by one standard error. What a regression
says is a mean over what is possible; steps that gain less only add the roughness of derivatives to it."""

LONGEST = 0.7
"""Longest step of a free number, on the real line of its bounds."""

Free = Callable | Parameter | Sequence[Callable | Parameter]


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
    scouts_before: Sequence[np.ndarray] = (),
    report: Callable[[PictureStep], None] | None = None,
    scouted: Callable[[np.ndarray], None] | None = None,
    taught: Callable[[Lesson], None] | None = None,
) -> PhotographFit:
    """Fit the state of a sea to a photograph of other waves than the model's: by what `ImageStatistics` say of it.

    $$ \\min_θ ½\\, (\\bar η(θ) - η)^T Σ^{-1} (\\bar η(θ) - η) + ½ \\sum_p r_p(θ)² $$

    Scouts, states from the priors with one picture each, teach a regression which combinations η of the statistics tell
    the free numbers. The photograph's η then are data: they are compared with their mean over some seas of the state θ,
    whose random numbers stay the same, and weighed by their covariance Σ over seas and over what `vary` draws (a
    synthetic likelihood, Wood 2010). From what the regression says it goes down by Gauss–Newton steps with the
    derivatives of the pictures.

    **Arguments:**

    - `photograph`: where to begin; its camera is that of the image.
    - `free`: which single numbers may change, as for `fitting.fit`. Scouts are drawn from their priors; angles without
      a prior from the whole circle, others from within their bounds.
    - `image`: linear light in any unit; `mask`: 0 where it shows something else.
    - `priors`: as for `fitting.fit`.
    - `vary(photograph, key)`: the same with those numbers drawn that are neither known nor sought, such as the haze.
    - `method`: how pixels find the sea, `Rays((8, 1))` if None: a mesh, and fewer rays, hold too few of the waves below
      the horizon and show too much texture nearby, and winds come out wrong by a third.
    - `derivatives`: the same for derivatives, which may be rougher; `Raster(2.0)` with twice the rows and columns if
      None.
    - `detail`: pictures are drawn with so many times the rows and columns and averaged.
    - `scouts`: how many; `seas`: how many are drawn for a derivative, at most 32; means are over 32.
    - `lesson`: that of another fit with the same camera, size, mask and free numbers: it needs no scouts.
    - `begin`: values of the free numbers by name, from where to go down; what the regression says if None.
    - `most_steps`: of the way down.
    - `seed`: of all random numbers.
    - `scouts_before`: what `scouted` was given by an interrupted call with the same arguments: these are not drawn
      again.
    - `report`: called with each step that lowers the cost; `scouted`: with the statistics of each 32 scouts; `taught`:
      with what they taught.

    **Returns:** `PhotographFit`.

    **Raises:** `ValueError` for arguments that make no sense; `FitError` if pictures or derivatives are not finite.
    """
    check_kind("photograph", photograph, Photograph, "a `Photograph`")
    for name, least, number in (
        ("detail", 1, detail),
        ("seas", 1, seas),
        ("scouts", 20, scouts),
        ("most_steps", 1, most_steps),
    ):
        if number < least:
            raise ValueError(f"Argument `{name}` must be at least {least}, but is {number}.")
    batches = [min(DRAWN, scouts - part) for part in range(0, scouts, DRAWN)]
    if [len(each) for each in scouts_before] != batches[: len(scouts_before)]:
        raise ValueError(
            f"Argument `scouts_before` must hold {DRAWN} scouts each, as `scouted` was given them, and no more than "
            f"`scouts` = {scouts}."
        )
    if seas > DRAWN:
        raise ValueError(f"Argument `seas` must be at most {DRAWN}, but is {seas}.")
    began = time.perf_counter()
    size = int(image.shape[0]), int(image.shape[1])
    statistics = ImageStatistics(photograph.scene.camera, size, mask)
    observed = np.asarray(
        eqx.filter_jit(statistics)(jnp.asarray(image, photograph.scene.noise.real.dtype)), float
    )
    slots = attach_priors(photograph, resolve(photograph, free, 1), list(priors))
    for slot, _ in slots:
        if slot.shape:
            raise ValueError(
                f"Argument `free` must pick single numbers, but `{slot.name}` has shape {slot.shape}."
            )
    if len(slots) > MOST_FREE:
        raise ValueError(
            f"Argument `free` must pick at most {MOST_FREE} numbers, but picks {len(slots)}: one picture tells no more."
        )
    with jax.enable_x64(True):
        problem = PictureProblem(
            _seas(photograph, DRAWN, seed, vary).some(seas),
            StatisticsTarget(statistics, _nothing(statistics), jnp.zeros(1), jnp.eye(1)),
            (),
            tuple(prior for _, prior in slots),
            tuple(slot for slot, _ in slots),
            METHOD if method is None else method,
            detail,
        )
        if lesson is None:
            lesson = _taught(problem, scouts, seed, scouts_before, scouted)
            if taught is not None:
                taught(lesson)
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
        free_values = guess if begin is None else _sought.from_names(problem, begin)
        steps: list[PictureStep] = []
        scattered = _sought.scattered(problem, seed)
        rough = problem.by(*ROUGH) if derivatives is None else problem.by(derivatives, detail)
        end = _descend(
            problem, rough, kept, summaries, aim, free_values, scattered, most_steps, seed, steps, report
        )
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
        tuple(steps),
        time.perf_counter() - began,
        problem.put(values, as_given=True).photograph,
        lesson,
        size,
        problem.slots,
    )


@dataclass(frozen=True)
class _End:
    """Where the way down ends: the state, the statistics of its pictures, residuals (`count` of them of data), and
    derivatives."""

    cost: float
    free: Array
    drawn: np.ndarray
    rows: np.ndarray
    jacobian: np.ndarray
    count: int

    def covariance(self) -> np.ndarray:
        """Of the free numbers."""
        own, beside = self.jacobian[: self.count], self.jacobian[self.count :]
        # What data say is as uncertain as they contradict each other; priors stay what they are.
        left = float(np.sum(self.rows**2)) / max(len(self.rows) - self.free.size, 1)
        spread = max(left, 1.0) * (1 + 1 / DRAWN)
        return np.linalg.pinv(own.T @ own / spread + beside.T @ beside, hermitian=True)


def _descend(
    problem: PictureProblem,
    rough: PictureProblem,
    kept: np.ndarray,
    summaries: Summaries,
    aim: Array,
    free: Array,
    scattered: tuple[np.ndarray, np.ndarray],
    most_steps: int,
    seed: int,
    steps: list[PictureStep],
    report: Callable[[PictureStep], None] | None,
) -> _End:
    """Gauss–Newton steps, with means over many seas and derivatives over a few of them."""
    count = int(kept.sum())
    middle, spread = _sought.expected(problem, free, *scattered)
    best, weight, step, vain = None, None, np.zeros(free.size), 0
    for _ in range(most_steps + 1):
        drawn = _at(problem, np.broadcast_to(free, (DRAWN, free.size)), seed)
        seen = np.asarray(summaries(jnp.asarray(drawn)))
        # Chance is that of the beginning, so that costs can be compared.
        weight = _whitening(seen, kept) if weight is None else weight
        target = replace(problem.target, summaries=summaries, observed=aim, whitening=weight)
        rows, jacobian = (np.asarray(each) for each in look(rough.against(target), free))
        own = np.asarray(weight) @ (seen.mean(axis=0) - np.asarray(aim))
        expected = (np.asarray(free) - middle) / spread
        rows = np.concatenate([own, rows[count:], expected[np.isfinite(spread)]])
        jacobian = np.concatenate([jacobian, np.diag(1 / spread)[np.isfinite(spread)]])
        if not (np.all(np.isfinite(rows)) and np.all(np.isfinite(jacobian))):
            raise FitError(
                "Pictures of a state, or their derivatives, are not finite",
                "numbers that no scene has",
                "give priors or bounds that hold only seas",
            )
        cost = 0.5 * float(np.sum(rows**2))
        gained = np.inf if best is None else best.cost - cost
        if gained >= GAIN:
            best, vain = _End(cost, free, drawn, rows, jacobian, count), 0
            values = problem.named(np.asarray(problem.constrain(free)))
            steps.append(PictureStep(len(steps), 1, cost, values))
            if report is not None:
                report(steps[-1])
            step = np.clip(-np.linalg.lstsq(jacobian, rows)[0], -LONGEST, LONGEST)
            if cost - 0.5 * float(np.sum((rows + jacobian @ step) ** 2)) < GAIN:
                break
        else:
            vain += 1
            step = 0.3 * step
            if vain == 2:
                break
        assert best is not None
        free = best.free + jnp.asarray(step)
    assert best is not None
    return best


def _taught(
    problem: PictureProblem,
    scouts: int,
    seed: int,
    before: Sequence[np.ndarray],
    scouted: Callable[[np.ndarray], None] | None,
) -> Lesson:
    random = np.random.default_rng(seed)
    points = np.stack([_sought.from_priors(problem, random) for _ in range(scouts)])
    # Other seas than those that later make means and chances: these must not be what was learned from.
    drawn = _at(problem, points, seed + SCOUTS, before, scouted)
    sound = np.all(np.isfinite(drawn), axis=1)
    if np.mean(sound) < 0.5:
        raise FitError(
            "Most pictures of states from the priors are not finite",
            "numbers that no scene has",
            "give priors or bounds that hold only seas",
        )
    return learn(drawn[sound], _sought.goals(problem, points[sound]), problem.target.statistics.steady)


def _seas(photograph: Photograph, count: int, seed: int, vary: Vary | None) -> Seas:
    keys = jax.random.split(jax.random.key(seed + 1), count)
    return Seas(photograph, photograph.noises(count, seed), keys, vary)


def _at(
    problem: PictureProblem,
    points: np.ndarray,
    seed: int,
    before: Sequence[np.ndarray] = (),
    found_some: Callable[[np.ndarray], None] | None = None,
) -> np.ndarray:
    """Statistics of a picture at each point, each of a sea of its own: the same at the same place in a series.

    **Arguments:** `before`: what `found_some` was called with for the first of these points.
    """
    found = [np.asarray(each, float) for each in before]
    # So many at a time that all pictures are drawn by one program.
    for part in range(DRAWN * len(found), len(points), DRAWN):
        some = points[part : part + DRAWN]
        whole = np.concatenate([some, np.broadcast_to(some[-1], (DRAWN - len(some), some.shape[1]))])
        drawn = _seas(problem.model.photograph, DRAWN, seed + part, None)
        rows = drawn_statistics(problem, jnp.asarray(whole), drawn.noises, drawn.keys)
        found.append(np.asarray(rows, float)[: len(some)])
        if found_some is not None:
            found_some(found[-1])
    return np.concatenate(found)


def _nothing(statistics: ImageStatistics) -> Summaries:
    """In the place of what is not yet learned."""
    count = len(statistics.names)
    none = jnp.zeros((count, 1))
    return Summaries(
        jnp.zeros(count), jnp.ones(count), jnp.zeros((1, count)), jnp.ones(()), none[:1], none, none[0]
    )


def _whitening(drawn: Float[np.ndarray, "sea q"], kept: np.ndarray) -> Array:
    """W with WᵀW = Σ⁻¹ for the summaries that are kept."""
    covariance = np.atleast_2d(np.cov(drawn[:, kept].T))
    # The inverse of a covariance from few draws is too large by this (Hartlap, Simon & Schneider 2007).
    covariance = covariance * (len(drawn) - 1) / (len(drawn) - len(covariance) - 2)
    found = np.linalg.inv(
        np.linalg.cholesky(covariance + 1e-9 * np.trace(covariance) * np.eye(len(covariance)))
    )
    whole = np.zeros((len(found), drawn.shape[1]))
    whole[:, kept] = found
    return jnp.asarray(whole)
