"""The config of each experiment."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key
from ._sea import (
    CascadeConfig,
    Choppiness,
    WindConfig,
    breaking_wavenumber_key,
    check_choppiness,
    choppiness_key,
    threshold_key,
)
from ._spectra import ElfouhailyConfig, SpectrumConfig


class MapConfig(Section):
    """`map`: the squares of sea that are drawn."""

    size: float = key(200.0, unit="m", meaning="side of the height map", gt=0, le=1e6)
    close_up: float = key(20.0, unit="m", meaning="side of the normal and folding maps", gt=0, le=1e6)
    resolution: int = key(256, meaning="points along each side", ge=16, le=1024)


class SeaStateConfig(ExperimentConfig):
    """`spectrum`: show a sea state."""

    experiment: Literal["spectrum"] = key("spectrum", meaning="which experiment this config runs")
    wind: WindConfig = key(WindConfig(), meaning="the wind")
    spectrum: SpectrumConfig = key(ElfouhailyConfig(), meaning="the wave spectrum")
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns")
    choppiness: Choppiness = choppiness_key()
    threshold: float = threshold_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    map: MapConfig = key(MapConfig(), meaning="the squares of sea that are drawn")
    time: float = key(0.0, unit="s", meaning="time of the realisation", ge=0, le=1e9)

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_choppiness(self.choppiness, len(self.cascade.sizes))
        return self
