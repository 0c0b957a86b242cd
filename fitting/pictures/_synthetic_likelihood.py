"""Combinations of statistics as data: their chance from seas of a state, and steps down to what explains them.

A synthetic likelihood (Wood 2010): their mean and covariance are those of pictures that are drawn.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float, Key

from .._errors import FitError
from . import _sought
from ._descent import PictureStep
from ._photograph import Photograph
from ._problem import PictureProblem, look
from ._statistics_target import Seas, Vary, drawn_statistics
from ._summaries import Summaries

DRAWN = 32
"""Pictures of a state from which the chance of its statistics is known."""

GAIN = 0.5
"""Least gain in half a χ² that is worth a step: that of one number which moves by one standard error. What a regression
says is a mean over what is possible; steps that gain less only add the roughness of derivatives to it."""

LONGEST = 0.7
"""Longest step of a free number, on the real line of its bounds."""


@dataclass(frozen=True)
class End:
    """Where the way down ends: the state, the statistics of its pictures, residuals (`count` of them of data), and
    derivatives; `steps`: those that led there, the start first."""

    cost: float
    free: Array
    drawn: np.ndarray
    rows: np.ndarray
    jacobian: np.ndarray
    count: int
    steps: tuple[PictureStep, ...]

    def covariance(self) -> np.ndarray:
        """Of the free numbers."""
        own, beside = self.jacobian[: self.count], self.jacobian[self.count :]
        # What data say is as uncertain as they contradict each other; priors stay what they are.
        left = float(np.sum(self.rows**2)) / max(len(self.rows) - self.free.size, 1)
        spread = max(left, 1.0) * (1 + 1 / DRAWN)
        return np.linalg.pinv(own.T @ own / spread + beside.T @ beside, hermitian=True)


def descend(
    problem: PictureProblem,
    rough: PictureProblem,
    kept: np.ndarray,
    summaries: Summaries,
    aim: Array,
    free: Array,
    scattered: tuple[np.ndarray, np.ndarray],
    most_steps: int,
    seed: int,
    report: Callable[[PictureStep], None] | None,
) -> End:
    """Gauss–Newton steps, with means over many seas and derivatives over a few of them."""
    count = int(kept.sum())
    middle, spread = _sought.expected(problem, free, *scattered)
    best, weight, step, vain = None, None, np.zeros(free.size), 0
    for _ in range(most_steps + 1):
        drawn = drawn_at(problem, np.broadcast_to(free, (DRAWN, free.size)), seed)
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
            before = () if best is None else best.steps
            values = problem.named(np.asarray(problem.constrain(free)))
            taken = PictureStep(len(before), 1, cost, values)
            best, vain = End(cost, free, drawn, rows, jacobian, count, (*before, taken)), 0
            if report is not None:
                report(taken)
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


def seas_of(photograph: Photograph, count: int, seed: int, vary: Vary | None) -> Seas:
    """So many seas of a state, the same for the same seed."""
    return Seas(photograph, *_chance(photograph, count, seed), vary)


def _chance(
    photograph: Photograph, count: int, seed: int
) -> tuple[Complex[Array, "sea pattern y x"], Key[Array, " sea"]]:
    """Random numbers of the waves of so many seas, and keys for what else is drawn."""
    return photograph.noises(count, seed), jax.random.split(jax.random.key(seed + 1), count)


def drawn_at(
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
    # However many seas derivatives are of: the same program.
    problem = replace(problem, model=problem.model.some(1))
    # So many at a time that all pictures are drawn by one program.
    for part in range(DRAWN * len(found), len(points), DRAWN):
        some = points[part : part + DRAWN]
        whole = np.concatenate([some, np.broadcast_to(some[-1], (DRAWN - len(some), some.shape[1]))])
        chance = _chance(problem.model.photograph, DRAWN, seed + part)
        rows = drawn_statistics(problem, jnp.asarray(whole), *chance)
        found.append(np.asarray(rows, float)[: len(some)])
        if found_some is not None:
            found_some(found[-1])
    return np.concatenate(found)


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
