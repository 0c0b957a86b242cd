"""Whitecap coverage as a target: laws and measured points, compared in log10."""

import math
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean import Wind
from jaxocean._numerics import check_kind, is_concrete
from jaxocean._types import Scalar
from jaxocean.whitecaps.laws import AbstractLaw, RangeWarning

from ._target import (
    AbstractScatter,
    AbstractTarget,
    Numbers,
    Scatter,
    Winds,
    as_row,
    as_scatter,
    as_winds,
)

SCATTER = 0.5
"""Default scatter in log10 W: observed coverage varies by about a factor of ten at one wind speed."""


def log10_coverage(model: Any, wind: Wind) -> Scalar:
    """log10 W of a model that has `log_coverage(wind)` or `coverage(wind)`."""
    if hasattr(model, "log_coverage"):
        return model.log_coverage(wind) / math.log(10.0)
    if not hasattr(model, "coverage"):
        raise ValueError(
            "Argument `model` must have a method `log_coverage(wind)` or `coverage(wind)` for a coverage "
            "target, "
            f"but a {type(model).__name__} has neither."
        )
    return jnp.log10(model.coverage(wind))


class CoverageLaw(AbstractTarget):
    """The model shall follow a whitecap law over a range of winds.

    $$ r = (\\log_{10} W_{model}(U) − \\log_{10} W_{law}(U))/σ $$

    **Arguments:**

    - `law`: one of `jaxocean.whitecaps.laws`; its constants can be differentiated through a fit.
    - `winds`: speeds [m/s], or winds.
    - `scatter`: σ in log10 (each wind counts as one observation with this scatter), or `FreeScatter(start)`.

    **Raises:** `ValueError` where the law gives no whitecaps at all; warns (`RangeWarning`) outside its
    range.
    """

    law: AbstractLaw
    winds: Wind
    scatter: AbstractScatter

    def __init__(self, law: AbstractLaw, winds: Winds, scatter: Scatter = SCATTER) -> None:
        check_kind("law", law, AbstractLaw, "a whitecap law such as `Monahan1980()`")
        self.law = law
        self.winds = as_winds(winds)
        self.scatter = as_scatter(scatter)

    def __check_init__(self) -> None:
        speed = self.winds.speed
        if not is_concrete(speed):
            return
        value = jax.vmap(self.law.coverage)(self.winds)
        if is_concrete(value) and not np.all(np.asarray(value) > 0):
            dry = np.asarray(speed)[~(np.asarray(value) > 0)]
            raise ValueError(
                f"Argument `winds` must be where the law gives whitecaps, but {self.law.name} gives none at "
                f"{_list(dry)} m/s."
            )
        for note in self.notes():
            warnings.warn(note, RangeWarning, stacklevel=4)

    @property
    def name(self) -> str:
        return self.law.name

    @property
    def unit(self) -> str:
        return "log10"

    def observed(self) -> Float[Array, " n"]:
        return jnp.log10(jax.vmap(self.law.coverage)(self.winds))

    def tabulated(self) -> "CoveragePoints":
        return CoveragePoints(self.winds, jax.vmap(self.law.coverage)(self.winds), self.scatter)

    def predict(self, model: Any, wind: Wind) -> Scalar:
        return log10_coverage(model, wind)

    def notes(self) -> tuple[str, ...]:
        if not is_concrete(self.winds.speed):
            return ()
        speed = np.asarray(self.winds.speed)
        lower, upper = self.law.range
        outside = speed[(speed < lower - 1e-6 * upper) | (speed > upper * (1 + 1e-6))]
        if outside.size == 0:
            return ()
        return (
            f"{self.law.name} has data from {lower:g} to {upper:g} m/s, but is a target at "
            f"{_list(outside)} m/s: "
            "there it is an extrapolation.",
        )


class CoveragePoints(AbstractTarget):
    """The model shall pass through measured coverage.

    $$ r_i = (\\log_{10} W_{model}(U_i) − \\log_{10} W_i)/σ_i $$

    **Arguments:**

    - `winds`: speeds [m/s], or winds.
    - `coverage`: W_i, fractions greater than 0 and at most 1.
    - `scatter`: σ in log10, one number or one for each point, or `FreeScatter(start)`.
    - `label`: what reports call these data.

    **Raises:** `ValueError` for lengths that differ, and for coverage that is not a fraction.
    """

    winds: Wind
    coverage: Float[Array, " n"]
    scatter: AbstractScatter
    label: str = eqx.field(static=True)

    def __init__(
        self, winds: Winds, coverage: Numbers, scatter: Scatter = SCATTER, label: str = "measured coverage"
    ) -> None:
        self.winds = as_winds(winds)
        self.coverage = as_row(coverage)
        self.scatter = as_scatter(scatter)
        self.label = label

    def __check_init__(self) -> None:
        n = self.winds.speed.shape[0]
        if self.coverage.shape != (n,):
            raise ValueError(
                f"Argument `coverage` must have one number for each of the {n} winds, but has shape "
                f"{self.coverage.shape}."
            )
        if self.scatter.value.shape not in ((), (n,)):
            raise ValueError(
                f"Argument `scatter` must be one number or one for each of the {n} winds, but has shape "
                f"{self.scatter.value.shape}."
            )
        if not is_concrete(self.coverage):
            return
        values = np.asarray(self.coverage)
        bad = values[~((values > 0) & (values <= 1))]
        if bad.size:
            raise ValueError(
                "Argument `coverage` must hold fractions greater than 0 and at most 1 (its logarithm is "
                "compared), "
                f"but holds {bad[0]:g}: drop points without whitecaps, and divide percentages by 100."
            )

    @classmethod
    def from_columns(
        cls,
        columns: Mapping[str, Sequence[float] | np.ndarray],
        *,
        wind: str = "wind",
        coverage: str = "coverage",
        scatter: str | float | AbstractScatter = SCATTER,
        percent: bool = False,
        label: str = "measured coverage",
    ) -> "CoveragePoints":
        """Points from named columns, such as those of a CSV file.

        **Arguments:** `columns`: numbers by column name; `wind` (U10 in m/s), `coverage`, and `scatter`
        where it is a text: the names to look for; `percent`: the coverage column is in percent.

        **Raises:** `ValueError` for a missing column, with those that are there.
        """
        wanted = [wind, coverage, *([scatter] if isinstance(scatter, str) else [])]
        for name in wanted:
            if name not in columns:
                present = ", ".join(f"`{one}`" for one in columns) or "none"
                raise ValueError(f"The column `{name}` must be present, but the columns are {present}.")
        values = np.asarray(columns[coverage], float) / (100.0 if percent else 1.0)
        spread = np.asarray(columns[scatter], float) if isinstance(scatter, str) else scatter
        return cls(np.asarray(columns[wind], float), values, spread, label=label)

    @property
    def name(self) -> str:
        return self.label

    @property
    def unit(self) -> str:
        return "log10"

    def observed(self) -> Float[Array, " n"]:
        return jnp.log10(self.coverage)

    def tabulated(self) -> "CoveragePoints":
        # The label is part of the program's identity, the numbers are not.
        return CoveragePoints(self.winds, self.coverage, self.scatter)

    def predict(self, model: Any, wind: Wind) -> Scalar:
        return log10_coverage(model, wind)

    def notes(self) -> tuple[str, ...]:
        return ()


def _list(speeds: np.ndarray) -> str:
    return ", ".join(f"{speed:g}" for speed in speeds)
