"""What is sought in a photograph: free numbers on the real line of their bounds, and the goals of a regression.

The goals of an angle are its cosine and its sine.
"""

from collections.abc import Iterator, Mapping

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._bounds import Real
from .._parameters import Slot
from ._problem import PictureProblem
from ._summaries import Lesson

TURN = 1.8
"""Standard deviation [rad] of an angle of which nothing is known."""

TELLING = 0.1
"""Least share of a goal's variance that its summary must tell to count."""

TRIED = 300
"""Draws from the priors from which their mean and deviation are known."""


def is_angle(slot: Slot) -> bool:
    """Whether a number is an angle on the whole circle."""
    return slot.unit == "rad" and isinstance(slot.bounds, Real)


def places(problem: PictureProblem) -> Iterator[tuple[Slot, slice]]:
    """Each free number, and where its goals stand."""
    place = 0
    for slot in problem.slots:
        width = 2 if is_angle(slot) else 1
        yield slot, slice(place, place + width)
        place += width


def from_priors(problem: PictureProblem, random: np.random.Generator) -> Float[np.ndarray, " p"]:
    """One state, on the real line of the bounds."""
    values = []
    for slot, prior, start in zip(problem.slots, problem.priors, np.asarray(problem.start()), strict=True):
        normal = jnp.asarray(random.normal())
        if prior is not None:
            value = slot.bounds.unconstrain(prior.draw(normal))
        elif is_angle(slot):
            value = random.uniform(-np.pi, np.pi)
        else:
            value = slot.bounds.unconstrain(
                slot.bounds.draw(normal, slot.bounds.constrain(jnp.asarray(start)))
            )
        values.append(float(value))
    return np.asarray(values)


def kept(problem: PictureProblem, lesson: Lesson) -> np.ndarray:
    """Which summaries count: those that tell something, of angles both or none."""
    told = lesson.told > TELLING
    for _, own in places(problem):
        told[own] = told[own].any()
    return told


def expected(
    problem: PictureProblem, guess: Array, mean: np.ndarray, deviation: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and deviation of what scouts were drawn from, for numbers without a prior; of others an endless one.

    Of an angle the mean is where the way begins: it holds one that no picture tells.
    """
    turns = np.array([is_angle(slot) for slot in problem.slots])
    known = np.array([prior is not None for prior in problem.priors])
    middle = np.where(turns, np.asarray(guess), mean)
    spread = np.where(turns, TURN, deviation)
    return middle, np.where(known, np.inf, spread)


def no_smaller(
    problem: PictureProblem, lesson: Lesson, covariance: np.ndarray, spread: np.ndarray
) -> np.ndarray:
    """A covariance whose errors are at least those that the summaries have for scouts that they have not seen.

    The derivative of a mean over a few seas is rough: where it happens to be steep it promises too much.
    """
    factors = np.ones(len(spread))
    for number, (slot, own) in enumerate(places(problem)):
        if not is_angle(slot):
            least = np.sqrt(1 - lesson.told[own][0]) * spread[number]
            factors[number] = max(least / np.sqrt(covariance[number, number]), 1.0)
    return covariance * np.outer(factors, factors)


def scattered(problem: PictureProblem, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean and deviation of what scouts are drawn from, on the real line of the bounds."""
    random = np.random.default_rng(seed)
    points = np.stack([from_priors(problem, random) for _ in range(TRIED)])
    return points.mean(axis=0), points.std(axis=0)


def from_names(problem: PictureProblem, values: Mapping[str, float]) -> Array:
    """The state with these numbers."""
    names = [slot.name for slot in problem.slots]
    if sorted(values) != sorted(names):
        raise ValueError(f"Argument `begin` must name {', '.join(names)}, but names {', '.join(values)}.")
    found = problem.unconstrain(jnp.asarray([float(values[name]) for name in names]))
    for name, place in zip(names, np.asarray(found), strict=True):
        if not np.isfinite(place):
            raise ValueError(
                f"Argument `begin` must hold numbers within their bounds, but `{name}` is {values[name]:g}."
            )
    return found


def check_lesson(problem: PictureProblem, lesson: Lesson) -> None:
    """Refuse a lesson of other statistics or of other free numbers.

    **Raises:** `ValueError` with what it is of.
    """
    count, goals = (
        len(problem.target.statistics.names),
        sum(own.stop - own.start for _, own in places(problem)),
    )
    if lesson.summaries.middle.size != count or lesson.told.size != goals:
        raise ValueError(
            f"Argument `lesson` must be of the {count} statistics of this camera and of the {goals} goals of the free "
            f"numbers, but is of {lesson.summaries.middle.size} and {lesson.told.size}: teach it anew."
        )


def goals(problem: PictureProblem, points: Float[np.ndarray, "scout p"]) -> Float[np.ndarray, "scout q"]:
    """What summaries shall tell of each state: its numbers, and of angles sine and cosine."""
    columns = []
    for slot, own in zip(problem.slots, points.T, strict=True):
        columns += [np.cos(own), np.sin(own)] if is_angle(slot) else [own]
    return np.stack(columns, axis=1)


def from_goals(problem: PictureProblem, goals: Float[np.ndarray, " q"]) -> Float[np.ndarray, " p"]:
    """The state of which summaries tell."""
    values = []
    for slot, own in places(problem):
        values.append(np.arctan2(*goals[own][::-1]) if is_angle(slot) else goals[own][0])
    return np.asarray(values)
