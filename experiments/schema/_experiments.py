"""The config of `spectrum`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._data import DATA_VARIABLE as DATA_VARIABLE
from ._sea import (
    CascadeConfig,
    Choppiness,
    WindConfig,
    breaking_wavenumber_key,
    check_choppiness,
    choppiness_key,
    threshold_key,
)
from ._spectra import ElfouhailyConfig, SpectrumConfig, TmaConfig


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
    depth: float | None = key(
        None, unit="m", meaning="water depth; null: deep, or that of the spectrum `tma`", gt=0, le=12000
    )
    surface_tension: float = key(
        0.0, unit="m^3/s^2", meaning="γ_s/ρ in the dispersion: 0 none, 7.2e-5 clean sea water", ge=0, le=1e-3
    )
    repeat_period: float | None = key(
        None, unit="s", meaning="the sea repeats exactly after it; null: never", ge=1, le=1e7
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_choppiness(self.choppiness, len(self.cascade.sizes))
        if self.depth is not None and isinstance(self.spectrum, TmaConfig):
            raise wrong("depth", "be null, since the spectrum `tma` has a key `spectrum.depth` of its own")
        return self
