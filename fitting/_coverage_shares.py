"""Shares of intervals that contain the truth, by kind of interval and level."""

from dataclasses import dataclass
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from ._posterior_result import check_level

CONFIDENCE = 0.95
"""Of the interval around a share of hits."""


class Share(NamedTuple):
    """How many of how many intervals contain the truth, and the binomial interval of that share."""

    hits: int
    total: int
    lower: float
    upper: float

    @property
    def value(self) -> float:
        """hits/total."""
        return self.hits / self.total if self.total else float("nan")


@dataclass(frozen=True)
class CoverageProbability:
    """Fits of many synthetic data sets, held against their truths.

    - `labels`: the free numbers; `truths`, `values`, `errors`: (set, number).
    - `roots`: (set, number) ±√Δ of the profile likelihood at the truth, negative where the truth is below.
    - `ranks`: (sampled set, number) share of the posterior's draws below the truth.
    - `numbers`: of each target (set, datum), what was observed, in its transformed unit.
    - `converged`: which data sets count.
    """

    labels: tuple[str, ...]
    truths: Float[np.ndarray, "set p"]
    values: Float[np.ndarray, "set p"]
    errors: Float[np.ndarray, "set p"]
    roots: Float[np.ndarray, "set p"]
    ranks: Float[np.ndarray, "sampled p"]
    numbers: tuple[Float[np.ndarray, "set n"], ...]
    converged: Bool[np.ndarray, " set"]
    warnings: tuple[str, ...]

    @property
    def methods(self) -> tuple[str, ...]:
        """The kinds of interval that were tried."""
        return ("laplace", "profile", *(("posterior",) if len(self.ranks) else ()))

    def probability(self, method: str) -> Float[np.ndarray, "set p"]:
        """The level from which on the interval of each data set contains its truth.

        **Arguments:** `method`: "laplace", "profile" or "posterior".

        **Raises:** `ValueError` for another one, or "posterior" without samples.
        """
        if method not in self.methods:
            known = ", ".join(f'"{one}"' for one in self.methods)
            raise ValueError(f"Argument `method` must be one of {known}, but is {method!r}.")
        if method == "posterior":
            return np.abs(2 * self.ranks - 1)
        pulls = (self.truths - self.values) / self.errors if method == "laplace" else self.roots
        normal = NormalDist()
        levels = [2 * normal.cdf(abs(float(pull))) - 1 for pull in pulls[self.converged].ravel()]
        return np.reshape(levels, (-1, len(self.labels)))

    def share(self, method: str, label: str, level: float = 0.9, first: int | None = None) -> Share:
        """How many intervals of this level contain the truth of one number, of all data sets or the `first` ones.

        **Raises:** `ValueError` for an unknown method or label, and a level outside (0, 1).
        """
        check_level(level)
        if label not in self.labels:
            known = ", ".join(f"`{one}`" for one in self.labels)
            raise ValueError(f"Argument `label` must be one of {known}, but is {label!r}.")
        reached = self.probability(method)[:first, self.labels.index(label)]
        return binomial_share(int(np.sum(reached <= level)), reached.size)


def binomial_share(hits: int, total: int) -> Share:
    """A share of hits with its 95 per cent binomial interval.

    **Source:** Wilson 1927, J. Am. Stat. Assoc. 22, 209-212.
    """
    if total == 0:
        return Share(0, 0, 0.0, 1.0)
    z = NormalDist().inv_cdf(0.5 * (1 + CONFIDENCE))
    p = hits / total
    centre = (p + z * z / (2 * total)) / (1 + z * z / total)
    half = z / (1 + z * z / total) * np.sqrt(p * (1 - p) / total + z * z / (4 * total**2))
    return Share(hits, total, float(max(centre - half, 0.0)), float(min(centre + half, 1.0)))
