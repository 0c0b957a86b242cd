"""What a fit found, how well it is known, and what to beware of."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class FittedParameter:
    """One fitted leaf; value, error and start are arrays where it is one or has a value per wind."""

    name: str
    unit: str
    value: float | Float[np.ndarray, "..."]
    error: float | Float[np.ndarray, "..."]
    start: float | Float[np.ndarray, "..."]
    bounds: str
    prior: str | None
    per_wind: bool


@dataclass(frozen=True)
class FittedTarget:
    """One target at the solution, in its transformed `unit` (log10 of coverage, ln of slope variance).

    `error` is the standard error of `predicted` that the fit's covariance implies.
    """

    name: str
    unit: str
    speeds: Float[np.ndarray, " n"]
    observed: Float[np.ndarray, " n"]
    predicted: Float[np.ndarray, " n"]
    scatter: Float[np.ndarray, " n"]
    error: Float[np.ndarray, " n"]

    @property
    def residuals(self) -> Float[np.ndarray, " n"]:
        """Predicted minus observed."""
        return self.predicted - self.observed

    @property
    def rms(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residuals**2)))


@dataclass(frozen=True)
class Fit:
    """A finished fit.

    - `parameters`, `targets`: everything about each of them.
    - `labels`: a name for each fitted number, the order of `covariance` and `correlations`.
    - `condition_number`: of the scaled Jacobian; 1 where the parameters are independent.
    - `identifiability`: in words, what the data can and cannot tell apart.
    - `warnings`: sentences that a reader of the values must know.
    - `cost`: half the sum of squared residuals in standard deviations, priors included.
    - `start_costs`: the same from each start, NaN where one did not converge.
    - `winds`: speeds [m/s] that per-wind parameters refer to.
    - `steps`, `seconds`: of the solver; the first fit of its kind also compiles.
    - `model`: the model with its fitted numbers, each leaf of the type that it came with; a leaf with one
      value per wind holds their mean.
    """

    parameters: tuple[FittedParameter, ...]
    targets: tuple[FittedTarget, ...]
    labels: tuple[str, ...]
    covariance: Float[np.ndarray, "p p"]
    correlations: Float[np.ndarray, "p p"]
    condition_number: float
    identifiability: str
    warnings: tuple[str, ...]
    cost: float
    start_costs: Float[np.ndarray, " start"]
    winds: Float[np.ndarray, " wind"]
    steps: int
    seconds: float
    solver: str
    model: Any

    @property
    def values(self) -> dict[str, float | Float[np.ndarray, "..."]]:
        """Fitted values by name."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def errors(self) -> dict[str, float | Float[np.ndarray, "..."]]:
        """Standard errors by name."""
        return {parameter.name: parameter.error for parameter in self.parameters}

    @property
    def residuals(self) -> dict[str, Float[np.ndarray, " n"]]:
        """Predicted minus observed by target, in its transformed unit."""
        return {target.name: target.residuals for target in self.targets}

    @property
    def rms(self) -> dict[str, float]:
        """Root mean square of the residuals by target."""
        return {target.name: target.rms for target in self.targets}

    def as_dict(self) -> dict[str, Any]:
        """All but the model as plain numbers, texts and lists."""
        return {
            "parameters": [
                {
                    "name": p.name,
                    "unit": p.unit,
                    "value": _plain(p.value),
                    "error": _plain(p.error),
                    "start": _plain(p.start),
                    "bounds": p.bounds,
                    "prior": p.prior,
                    "per_wind": p.per_wind,
                }
                for p in self.parameters
            ],
            "targets": [
                {
                    "name": t.name,
                    "unit": t.unit,
                    "wind": _plain(t.speeds),
                    "observed": _plain(t.observed),
                    "predicted": _plain(t.predicted),
                    "scatter": _plain(t.scatter),
                    "rms": t.rms,
                }
                for t in self.targets
            ],
            "labels": list(self.labels),
            "covariance": _plain(self.covariance),
            "correlations": _plain(self.correlations),
            "condition_number": self.condition_number,
            "identifiability": self.identifiability,
            "warnings": list(self.warnings),
            "cost": self.cost,
            "winds": _plain(self.winds),
            "steps": self.steps,
            "seconds": self.seconds,
            "solver": self.solver,
        }

    def summary(self) -> str:
        """The fit as a text of a few lines."""
        lines = [f"{self.solver}: {self.steps} steps, {_duration(self.seconds)}, cost {self.cost:.4g}"]
        width = max(len(label) for label in self.labels)
        flat = [
            (value, error, parameter)
            for parameter in self.parameters
            for value, error in zip(np.ravel(parameter.value), np.ravel(parameter.error), strict=True)
        ]
        for label, (value, error, parameter) in zip(self.labels, flat, strict=True):
            unit = "" if parameter.unit in ("", "-") else f" {parameter.unit}"
            prior = f"   prior {parameter.prior}" if parameter.prior else ""
            lines.append(f"  {label:<{width}}  {_with_error(value, error)}{unit}{prior}")
        for target in self.targets:
            lines.append(f"  {target.name}: {target.speeds.size} data, rms {target.rms:.3g} in {target.unit}")
        lines.append(self.identifiability)
        lines += [f"Warning: {text}" for text in self.warnings if text not in self.identifiability]
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.summary()


def _with_error(value: float, error: float) -> str:
    """A number with as many digits as its error allows, two of them uncertain."""
    if not np.isfinite(error) or error <= 0:
        return f"{value:.6g}"
    digits = int(np.clip(1 - np.floor(np.log10(error)), 2, 9))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else float(value)


def _duration(seconds: float) -> str:
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"
