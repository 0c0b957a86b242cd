"""The config of `footprint_bias`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._gaussian import ComparedWindsConfig
from ._sea import CascadeConfig, Choppiness, breaking_wavenumber_key, check_choppiness, choppiness_key
from ._spectra import ElfouhailyConfig, SpectrumConfig


class TileConfig(Section):
    """`tile`: the square of sea on which the truth is counted."""

    points: int = key(
        2048, meaning="samples along each side", within="a power of two, 64 to 4096", ge=64, le=4096
    )
    spacing: float = key(0.04, unit="m", meaning="between samples, the smallest footprint", gt=0, le=100)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.points & (self.points - 1):
            raise wrong("points", f"be a power of two, but is {self.points}")
        return self


class FootprintWindsConfig(ComparedWindsConfig):
    """`wind`: the winds at 10 m whose seas are compared."""

    speed: tuple[float, ...] = key(
        (8.0, 12.0, 18.0),
        unit="m/s",
        meaning="U10 of each sea",
        within="increasing, 0.5 to 60, 1 to 8 of them",
        min_length=1,
        max_length=8,
    )


class FootprintBiasConfig(ExperimentConfig):
    """`footprint_bias`: how wrong closures are in footprints from one sample to the whole tile."""

    experiment: Literal["footprint_bias"] = key("footprint_bias", meaning="which experiment this config runs")
    wind: FootprintWindsConfig = key(FootprintWindsConfig(), meaning="the winds")
    spectrum: SpectrumConfig = key(ElfouhailyConfig(), meaning="the wave spectrum of each wind")
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns")
    choppiness: Choppiness = choppiness_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    thresholds: tuple[float, ...] = key(
        (0.5, 0.7),
        unit="-",
        meaning="breaking thresholds ε",
        within="increasing, -100 to 1, 1 to 6 of them",
        min_length=1,
        max_length=6,
    )
    tile: TileConfig = key(TileConfig(), meaning="the square of sea on which the truth is counted")
    realisations: int = key(5, meaning="seas of each wind: their spread is the error", ge=3, le=10_000)

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_choppiness(self.choppiness, len(self.cascade.sizes))
        if not any(self.choppiness if isinstance(self.choppiness, tuple) else (self.choppiness,)):
            raise wrong("choppiness", "be greater than 0: without displacement j = 1 everywhere")
        for threshold in self.thresholds:
            if not -100 <= threshold <= 1:
                raise wrong("thresholds", f"lie between -100 and 1, but one is {threshold:g}")
        if list(self.thresholds) != sorted(set(self.thresholds)):
            raise wrong("thresholds", "increase from one to the next")
        return self
