"""The config of `gaussian_vs_monte_carlo`."""

import itertools
from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, key, wrong
from ._sea import (
    CascadeConfig,
    Choppiness,
    WindConfig,
    breaking_wavenumber_key,
    check_choppiness,
    choppiness_key,
)
from ._spectra import ElfouhailyConfig, JonswapConfig, SpectrumConfig, TmaConfig

DEFAULT_THRESHOLDS = tuple(round(-0.2 + 0.05 * step, 2) for step in range(24))


def _follows_the_wind(spectrum: SpectrumConfig) -> bool:
    given = isinstance(spectrum, JonswapConfig) and spectrum.significant_wave_height is not None
    return not (given or isinstance(spectrum, TmaConfig))


def _check_increasing(name: str, values: tuple[float, ...]) -> None:
    for before, after in itertools.pairwise(values):
        if after <= before:
            raise wrong(name, f"increase from one to the next, but {after:g} follows {before:g}")


class ComparedWindsConfig(WindConfig):
    """`wind`: the winds at 10 m whose seas are compared."""

    speed: tuple[float, ...] = key(  # pyright: ignore[reportIncompatibleVariableOverride]
        (5.0, 10.0, 15.0, 20.0),
        unit="m/s",
        meaning="U10 of each sea",
        within="increasing, 0.5 to 60, 1 to 8 of them",
        min_length=1,
        max_length=8,
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        for speed in self.speed:
            if not 0.5 <= speed <= 60:
                raise wrong("speed", f"hold speeds from 0.5 to 60 m/s, but one is {speed:g}")
        _check_increasing("speed", self.speed)
        return self


class GaussianVsMonteCarloConfig(ExperimentConfig):
    """`gaussian_vs_monte_carlo`: is the Jacobian Gaussian? Closures against counting."""

    experiment: Literal["gaussian_vs_monte_carlo"] = key(
        "gaussian_vs_monte_carlo", meaning="which experiment this config runs"
    )
    wind: ComparedWindsConfig = key(ComparedWindsConfig(), meaning="the winds")
    spectrum: SpectrumConfig = key(ElfouhailyConfig(), meaning="the wave spectrum of each wind")
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns")
    choppiness: Choppiness = choppiness_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    thresholds: tuple[float, ...] = key(
        DEFAULT_THRESHOLDS,
        unit="-",
        meaning="breaking thresholds ε at which coverage is compared",
        within="increasing, -100 to 1, 2 to 200 of them",
        min_length=2,
        max_length=200,
    )
    measure: Literal["rest", "projected"] = key(
        "rest", meaning="area: on the plane at rest, or seen from above"
    )
    draws: int = key(
        10_000_000, meaning="Monte Carlo draws of the strain for each wind", ge=10_000, le=10**10
    )
    confidence: float = key(
        0.99, unit="-", meaning="of the intervals around what was counted", ge=0.5, le=0.99999
    )
    realisations: int = key(
        64, meaning="FFT seas for each wind: their spread is their error", ge=8, le=100_000
    )
    shifts: int = key(4, meaning="arrangements of the patterns counted in each sea", ge=1, le=64)

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_choppiness(self.choppiness, len(self.cascade.sizes))
        if not any(self.choppiness if isinstance(self.choppiness, tuple) else (self.choppiness,)):
            raise wrong("choppiness", "be greater than 0: without displacement j = 1 everywhere")
        for threshold in self.thresholds:
            if not -100 <= threshold <= 1:
                raise wrong("thresholds", f"lie between -100 and 1, but one is {threshold:g}")
        _check_increasing("thresholds", self.thresholds)
        if len(self.wind.speed) > 1 and not _follows_the_wind(self.spectrum):
            raise wrong(
                "wind.speed",
                f"hold one speed: this spectrum `{self.spectrum.family}` is the same in any wind",
            )
        return self
