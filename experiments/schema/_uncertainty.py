"""The configs of `calibration_uncertainty` and `law_ensemble`: a sea that is calibrated, and how sure one can be."""

import itertools
from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, key, wrong
from ._calibration import LawName, ParameterPrior, WindsConfig
from ._sea import CascadeConfig, breaking_wavenumber_key, threshold_key
from ._spectra import ElfouhailyConfig, JonswapConfig, PiersonMoskowitzConfig, SpectrumConfig


class CalibratedSeaConfig(ExperimentConfig):
    """The keys of a sea whose ε and λ are fitted to whitecap laws."""

    wind: WindsConfig = key(WindsConfig(), meaning="the winds")
    spectrum: SpectrumConfig = key(
        ElfouhailyConfig(),
        meaning="the wave spectrum of each wind",
        within="elfouhaily, pierson_moskowitz, or jonswap with wind.fetch",
    )
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns that make the sea")
    band: tuple[float, float] | None = key(
        None, unit="rad/m", meaning="[lower, upper] of |k| instead of the cascade's; null: the cascade"
    )
    measure: Literal["projected", "rest"] = key(
        "projected", meaning="area: seen from above, or on the plane at rest"
    )
    threshold: float = threshold_key()
    choppiness_prior: ParameterPrior = key(
        ParameterPrior(), meaning="prior on λ, and where λ starts: ε and λ are nearly inseparable"
    )
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    scatter: float = key(0.5, unit="-", meaning="σ of log10 W around a law", gt=0, le=5)
    level: float = key(0.9, unit="-", meaning="of confidence of all intervals", ge=0.5, le=0.999)

    @model_validator(mode="after")
    def _check_sea(self) -> Self:
        speeds = self.wind.speed
        if any(not 0.5 <= speed <= 60 for speed in speeds):
            raise wrong("wind.speed", "hold speeds from 0.5 to 60 m/s")
        if any(b <= a for a, b in itertools.pairwise(speeds)):
            raise wrong("wind.speed", "increase from one speed to the next")
        if not isinstance(self.spectrum, ElfouhailyConfig | PiersonMoskowitzConfig | JonswapConfig):
            raise wrong("spectrum.family", "follow the wind: elfouhaily, pierson_moskowitz or jonswap")
        if isinstance(self.spectrum, JonswapConfig) and self.wind.fetch is None:
            raise wrong("wind.fetch", "be given, so that the spectrum `jonswap` follows the wind")
        if self.band is not None and not 0 < self.band[0] < self.band[1]:
            raise wrong("band", "be [lower, upper] with 0 < lower < upper")
        if not 0 < self.choppiness_prior.mean < 3:
            raise wrong("choppiness_prior.mean", "lie between 0 and 3, as λ does")
        return self


class UncertaintyConfig(CalibratedSeaConfig):
    """`calibration_uncertainty`: can the errors of a calibration be trusted?"""

    experiment: Literal["calibration_uncertainty"] = key(
        "calibration_uncertainty", meaning="which experiment this config runs"
    )
    law: LawName = key("monahan_1980", meaning="whitecap law to obey")
    weak_deviation: float = key(
        0.5, unit="-", meaning="standard deviation of the weak prior on λ, for comparison", gt=0, le=100
    )
    chains: int = key(4, meaning="Markov chains of each posterior", ge=2, le=64)
    draws: int = key(750, meaning="draws of each chain", ge=100, le=100_000)
    warmup: int = key(300, meaning="steps of each chain before that", ge=100, le=10_000)
    points: int = key(41, meaning="values at which each likelihood is profiled", ge=11, le=1001)
    sets: int = key(1000, meaning="synthetic data sets whose intervals are counted", ge=10, le=100_000)
    sampled: int = key(
        50, meaning="of these, how many are also sampled; 0 for none", within="≤ sets", ge=0, le=10_000
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.sampled > self.sets:
            raise wrong("sampled", f"be at most `sets` ({self.sets}), but is {self.sampled}")
        if self.weak_deviation <= self.choppiness_prior.deviation:
            raise wrong(
                "weak_deviation",
                f"be greater than `choppiness_prior.deviation` ({self.choppiness_prior.deviation:g}), but is "
                f"{self.weak_deviation:g}",
            )
        return self


class EnsembleWindsConfig(WindsConfig):
    """`wind`: the winds at 10 m; each law is obeyed at those in its range."""

    speed: tuple[float, ...] = key(
        tuple(float(u) for u in range(4, 25)),
        unit="m/s",
        meaning="U10 of each",
        within="increasing, 0.5 to 60",
        min_length=2,
        max_length=200,
    )


class LawEnsembleConfig(CalibratedSeaConfig):
    """`law_ensemble`: the same sea calibrated to one whitecap law after the other."""

    experiment: Literal["law_ensemble"] = key("law_ensemble", meaning="which experiment this config runs")
    wind: EnsembleWindsConfig = key(EnsembleWindsConfig(), meaning="the winds")
    laws: tuple[LawName, ...] = key((), meaning="whitecap laws to obey, one after the other; []: all")
    least: float = key(1e-5, unit="-", meaning="coverage below which a law is not a target", gt=0, lt=1)
    draws: int = key(200, meaning="draws of ε and λ from each fit's errors, for the band", ge=20, le=100_000)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(set(self.laws)) < len(self.laws):
            raise wrong("laws", "name each law once")
        if len(self.laws) == 1:
            raise wrong("laws", "name at least two laws: an ensemble of one has no spread")
        return self
