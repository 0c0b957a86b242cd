"""Draws from a posterior, what they say, how far they can be trusted, and how far the fit's own errors can."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from ._bounds import AbstractBounds
from ._nuts import Block
from ._result import Fit

AGREE = 1.01
"""R-hat up to which chains count as agreeing (Vehtari et al. 2021, Bayesian Anal. 16)."""

FEW = 400
"""Effective draws below which quantiles are vague (same source)."""

DISAGREE, TOO_FEW = 1.05, 100
"""R-hat above and effective draws below which draws are no judge of anything."""

LEANING = 0.02
"""Share of draws at a bound from which on the bound, not the data, shapes the distribution."""

NARROW, WIDE = 0.85, 1.15
"""Between these the fit's error counts as right; 400 effective draws know a deviation to 4 per cent."""

SHIFTED, SKEWED = 0.25, 0.5
"""A mean this many errors away from the fit, or such a skewness: no longer Gaussian around the fit."""


@dataclass(frozen=True)
class LaplaceCheck:
    """One number: the fit's Gaussian approximation beside the posterior itself.

    - `value`, `error`: of the fit; `mean`, `deviation`, `skewness`: of the draws.
    - `ratio`: deviation over error; `shift`: (mean − value)/error.
    """

    label: str
    value: float
    error: float
    mean: float
    deviation: float
    skewness: float

    @property
    def ratio(self) -> float:
        """Deviation of the draws over the error of the fit."""
        return self.deviation / self.error

    @property
    def shift(self) -> float:
        """How many errors of the fit the mean lies above its value."""
        return (self.mean - self.value) / self.error

    @property
    def faults(self) -> tuple[str, ...]:
        """In which respects the Gaussian approximation is wrong; none where it is good."""
        texts = []
        if not NARROW <= self.ratio <= WIDE:
            texts.append(f"its error is {_times(1 / self.ratio)} the deviation of the draws")
        if abs(self.shift) > SHIFTED:
            texts.append(f"the mean lies {self.shift:+.2f} errors away")
        if abs(self.skewness) > SKEWED:
            texts.append(f"the distribution is skewed ({self.skewness:+.2f})")
        return tuple(texts)


@dataclass(frozen=True)
class Posterior:
    """Draws from the posterior distribution of a fit's free numbers.

    - `draws`: (chain, draw, number), in the order of `labels`; `log_density`: of each, on the sampler's line.
    - `r_hat`, `effective_size`: for each number; `divergences`: draws at which the sampler lost its way.
    - `acceptance`: mean; `gradients`: how many were computed for the draws; `seconds`: of sampling.
    - `fit`: the fit around which the chains started.
    - `warnings`: sentences that a reader of the draws must know.
    """

    names: tuple[str, ...]
    shapes: tuple[tuple[int, ...], ...]
    units: tuple[str, ...]
    labels: tuple[str, ...]
    draws: Float[np.ndarray, "chain draw p"]
    log_density: Float[np.ndarray, "chain draw"]
    r_hat: Float[np.ndarray, " p"]
    effective_size: Float[np.ndarray, " p"]
    divergences: int
    acceptance: float
    gradients: int
    seconds: float
    fit: Fit
    warnings: tuple[str, ...]

    @property
    def values(self) -> dict[str, Float[np.ndarray, "chain draw ..."]]:
        """The draws by name; a parameter with a value per wind has one more axis."""
        ends = np.cumsum([0, *(int(np.prod(shape)) for shape in self.shapes)])
        lead = self.draws.shape[:2]
        return {
            name: self.draws[..., a:b].reshape(*lead, *shape)
            for name, shape, a, b in zip(self.names, self.shapes, ends[:-1], ends[1:], strict=True)
        }

    @property
    def flat(self) -> Float[np.ndarray, "sample p"]:
        """All chains one behind the other."""
        return self.draws.reshape(-1, self.draws.shape[-1])

    @property
    def mean(self) -> dict[str, float]:
        """Mean of each number."""
        return self._each(self.flat.mean(axis=0))

    @property
    def deviation(self) -> dict[str, float]:
        """Standard deviation of each number."""
        return self._each(self.flat.std(axis=0, ddof=1))

    @property
    def correlations(self) -> Float[np.ndarray, "p p"]:
        """Correlations of the draws."""
        return np.atleast_2d(np.corrcoef(self.flat.T))

    def interval(self, level: float = 0.9) -> dict[str, tuple[float, float]]:
        """The central interval of each number that holds this share of the draws.

        **Raises:** `ValueError` for a level outside (0, 1).
        """
        check_level(level)
        lower, upper = np.quantile(self.flat, [0.5 * (1 - level), 0.5 * (1 + level)], axis=0)
        return {label: (float(a), float(b)) for label, a, b in zip(self.labels, lower, upper, strict=True)}

    def laplace(self) -> tuple[LaplaceCheck, ...]:
        """The fit's values and errors beside the draws."""
        values = np.concatenate([np.ravel(p.value) for p in self.fit.parameters])
        errors = np.concatenate([np.ravel(p.error) for p in self.fit.parameters])
        mean, deviation = self.flat.mean(axis=0), self.flat.std(axis=0, ddof=1)
        skewness = (((self.flat - mean) / deviation) ** 3).mean(axis=0)
        rows = zip(self.labels, values, errors, mean, deviation, skewness, strict=True)
        return tuple(LaplaceCheck(label, *map(float, numbers)) for label, *numbers in rows)

    def verdict(self) -> str:
        """Whether the fit's own errors describe this posterior, in words; nothing where the draws are too poor."""
        if not (np.all(self.r_hat < DISAGREE) and np.all(self.effective_size > TOO_FEW)):
            return "These draws cannot judge the fit's errors: the chains do not agree, or hardly moved."
        faults = {check.label: check.faults for check in self.laplace() if check.faults}
        if not faults:
            return "The fit's errors describe the posterior: it is Gaussian around the fit, as they assume."
        parts = "; ".join(f"{label}: {', '.join(texts)}" for label, texts in faults.items())
        return f"The fit's errors do not describe the posterior: {parts}. Quote its intervals instead."

    def as_dict(self, level: float = 0.9) -> dict[str, Any]:
        """All but the draws as plain numbers, texts and lists."""
        intervals = self.interval(level)
        checks = {check.label: check for check in self.laplace()}
        return {
            "parameters": [
                {
                    "name": label,
                    "unit": unit,
                    "mean": checks[label].mean,
                    "deviation": checks[label].deviation,
                    "skewness": checks[label].skewness,
                    "interval": list(intervals[label]),
                    "r_hat": float(r_hat),
                    "effective_size": float(size),
                    "laplace_value": checks[label].value,
                    "laplace_error": checks[label].error,
                    "deviation_over_laplace_error": checks[label].ratio,
                }
                for label, unit, r_hat, size in zip(
                    self.labels, self.units, self.r_hat, self.effective_size, strict=True
                )
            ],
            "level": level,
            "correlations": self.correlations.tolist(),
            "laplace_correlations": np.asarray(self.fit.correlations).tolist(),
            "chains": self.draws.shape[0],
            "draws": self.draws.shape[1],
            "divergences": self.divergences,
            "acceptance": self.acceptance,
            "gradients": self.gradients,
            "seconds": self.seconds,
            "verdict": self.verdict(),
            "warnings": list(self.warnings),
        }

    def summary(self) -> str:
        """The posterior as a text of a few lines."""
        chains, draws = self.draws.shape[:2]
        lines = [f"{chains} chains of {draws} draws, {self.divergences} divergences, {self.seconds:.3g} s"]
        width = max(len(label) for label in self.labels)
        intervals = self.interval(0.9)
        rows = zip(self.laplace(), self.units, self.r_hat, self.effective_size, strict=True)
        for check, unit, r_hat, size in rows:
            a, b = intervals[check.label]
            shown = "" if unit in ("", "-") else f" {unit}"
            lines.append(
                f"  {check.label:<{width}}  {check.mean:.4g} ± {check.deviation:.2g}{shown}, 90 %: {a:.4g} to "
                f"{b:.4g}   R-hat {r_hat:.3f}, {size:.0f} effective draws"
            )
        return "\n".join([*lines, self.verdict(), *(f"Warning: {text}" for text in self.warnings)])

    def __str__(self) -> str:
        return self.summary()

    def _each(self, numbers: Float[np.ndarray, " p"]) -> dict[str, float]:
        return {label: float(number) for label, number in zip(self.labels, numbers, strict=True)}


def posterior_warnings(
    labels: Sequence[str],
    bounds: Sequence[AbstractBounds],
    block: Block,
    r_hat: Float[np.ndarray, " p"],
    size: Float[np.ndarray, " p"],
) -> tuple[str, ...]:
    """What a reader of these draws must beware of."""
    texts = []
    count = block.divergent.size
    restless = [f"{label} ({r:.3f})" for label, r in zip(labels, r_hat, strict=True) if not r <= AGREE]
    if restless:
        texts.append(
            f"The chains do not agree on {', '.join(restless)}, R-hat above {AGREE:g}: take more warm-up and "
            "draws, or tell the sampler more by a prior."
        )
    few = [f"{label} ({n:.0f})" for label, n in zip(labels, size, strict=True) if not n >= FEW]
    if few:
        texts.append(f"Fewer than {FEW} effective draws of {', '.join(few)}: its quantiles are vague.")
    lost = int(block.divergent.sum())
    if lost:
        texts.append(
            f"{lost} of {count} draws diverged: the posterior has a place too narrow for the sampler's step, "
            "which it may have left out. Raise `acceptance`, or give a prior that excludes it."
        )
    long = int(block.saturated.sum())
    if long > 0.01 * count:
        texts.append(
            f"{long} of {count} trajectories were cut off: the posterior is a long thread, drawn slowly. Fix a "
            "parameter, or give a prior."
        )
    flat = block.values.reshape(-1, block.values.shape[-1])
    for label, bound, column in zip(labels, bounds, flat.T, strict=True):
        at = [edge for edge in (bound.touched(float(v)) for v in column) if edge is not None]
        if len(at) > LEANING * len(column):
            texts.append(f"{label} leans on its bound {at[0]:g}, which shapes its distribution.")
    return tuple(texts)


def check_level(level: float) -> None:
    """Raise unless a level lies between 0 and 1."""
    if not 0 < level < 1:
        raise ValueError(f"Argument `level` must lie between 0 and 1, but is {level:g}.")


def _times(factor: float) -> str:
    return f"{factor:.2f} times"
