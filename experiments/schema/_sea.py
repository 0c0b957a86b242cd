"""Sections that describe a sea: wind, cascade, choppiness and breaking."""

import itertools
import math
from typing import Literal, Self

from pydantic import model_validator

from ._base import TURN, Section, key, wrong

DEFAULT_BREAKING_WAVENUMBER = math.pi * 256 / 11
"""k_b [rad/m]: what the default cascade resolves."""


class WindConfig(Section):
    """`wind`: the wind at 10 m."""

    speed: float = key(10.0, unit="m/s", meaning="U10", ge=0, le=100)
    direction: float = key(
        0.0,
        unit="rad",
        meaning="blows towards, counter-clockwise from +x (east)",
        within="-2π to 2π",
        ge=-TURN,
        le=TURN,
    )
    fetch: float | None = key(
        None, unit="m", meaning="distance it has blown; null: fully developed", gt=0, le=1e8
    )
    sea_air_temperature_difference: float = key(
        0.0, unit="K", meaning="sea minus air; positive is unstable", ge=-50, le=50
    )
    drag: Literal["elfouhaily", "wu"] = key("elfouhaily", meaning="drag law for the friction velocity")


class CascadeConfig(Section):
    """`cascade`: the periodic patterns whose sum is the sea."""

    sizes: tuple[float, ...] = key(
        (893.0, 101.0, 21.0, 11.0),
        unit="m",
        meaning="side of each pattern",
        within="each > 0 and ≤ 1e7, 1 to 16 of them",
        min_length=1,
        max_length=16,
    )
    resolution: int = key(
        256, meaning="grid points per side of every pattern", within="even, 8 to 4096", ge=8, le=4096
    )
    bands: tuple[tuple[float, float], ...] | None = key(
        None,
        unit="rad/m",
        meaning="[lower, upper] of |k| per pattern; null: chosen from the sizes",
        within="one per size, no gap, no overlap",
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        for size in self.sizes:
            if not 0 < size <= 1e7:
                raise wrong("sizes", f"hold lengths greater than 0 m and at most 1e7 m, but one is {size:g}")
        if self.resolution % 2:
            raise wrong("resolution", f"be even, but is {self.resolution}")
        if self.bands is None:
            return self
        if len(self.bands) != len(self.sizes):
            raise wrong(
                "bands", f"hold one band per pattern ({len(self.sizes)}), but holds {len(self.bands)}"
            )
        for lower, upper in self.bands:
            if not 0 < lower < upper:
                raise wrong(
                    "bands", f"hold [lower, upper] with 0 < lower < upper, but one is [{lower:g}, {upper:g}]"
                )
        for (_, upper), (lower, _) in itertools.pairwise(sorted(self.bands)):
            if not math.isclose(upper, lower, rel_tol=1e-9):
                what = "overlap" if lower < upper else "leave a gap"
                raise wrong(
                    "bands", f"follow each other exactly, but {what} between {upper:g} and {lower:g} rad/m"
                )
        return self


Choppiness = float | tuple[float, ...]


def choppiness_key(default: Choppiness = 1.0):
    """The key `choppiness`: λ of all patterns, or one λ each."""
    return key(
        default,
        unit="-",
        meaning="horizontal displacement λ: one number, or one per pattern",
        within="≥ 0 and ≤ 20",
    )


def threshold_key(default: float = 0.5):
    """The key `threshold`: the breaking threshold ε."""
    return key(default, unit="-", meaning="breaking threshold ε: it breaks where j < ε", ge=-100, le=1)


def breaking_wavenumber_key(default: float | None = DEFAULT_BREAKING_WAVENUMBER):
    """The key `breaking_wavenumber`: k_b."""
    return key(
        default,
        unit="rad/m",
        meaning="k_b: foam sees no shorter waves; null: no low-pass",
        gt=0,
        le=1e5,
    )


def check_choppiness(choppiness: Choppiness, patterns: int) -> None:
    """For validators: λ must lie in [0, 20], and there must be one, or one per pattern."""
    values = choppiness if isinstance(choppiness, tuple) else (choppiness,)
    for value in values:
        if not 0 <= value <= 20:
            raise wrong("choppiness", f"lie between 0 and 20, but is {value:g}")
    if isinstance(choppiness, tuple) and len(values) != patterns:
        raise wrong(
            "choppiness",
            f"be one number or one per pattern ({patterns}, as in `cascade.sizes`), but holds {len(values)}",
        )
