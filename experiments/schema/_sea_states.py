"""The config of `sea_states`."""

import itertools
from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._measured import CALIBRATED_THRESHOLD, band_key, check_band, threshold_error_key
from ._sea import breaking_wavenumber_key, threshold_key
from ._spectra import MitsuyasuSpreading, SpreadingConfig


class StateWindsConfig(Section):
    """`wind`: the winds of the wind seas."""

    speed: tuple[float, ...] = key(
        (6.0, 10.0, 15.0),
        unit="m/s",
        meaning="U10 of each",
        within="increasing, 1 to 50, 1 to 6 of them",
        min_length=1,
        max_length=6,
    )
    drag: Literal["elfouhaily", "wu"] = key("elfouhaily", meaning="drag law for the friction velocity")


class StateSwellConfig(Section):
    """`swell`: the swell that is turned, and the wind sea that it meets."""

    at_wind: float = key(10.0, unit="m/s", meaning="U10 of the developed wind sea beside it", ge=1, le=50)
    significant_wave_height: tuple[float, ...] = key(
        (1.0, 2.0, 3.0),
        unit="m",
        meaning="Hs of each swell",
        within="increasing, > 0, 1 to 6 of them",
        min_length=1,
        max_length=6,
    )
    peak_period: float = key(8.0, unit="s", meaning="Tp while it is turned", ge=2, le=40)
    peak_periods: tuple[float, float] = key(
        (6.0, 16.0), unit="s", meaning="[shortest, longest] Tp while it is not", within="2 to 40, increasing"
    )
    width: float = key(0.1, unit="-", meaning="σ/f_p of the bell in frequency", ge=0.01, le=0.3)
    spreading: SpreadingConfig = key(
        MitsuyasuSpreading(s_max=75.0), meaning="how its energy spreads over directions"
    )


class SeaStatesConfig(ExperimentConfig):
    """`sea_states`: what swell, its angle, and the age of the wind sea do to whitecaps at one wind."""

    experiment: Literal["sea_states"] = key("sea_states", meaning="which experiment this config runs")
    wind: StateWindsConfig = key(StateWindsConfig(), meaning="the winds of the wind seas")
    swell: StateSwellConfig = key(StateSwellConfig(), meaning="the swell, and the wind sea that it meets")
    inverse_wave_age: tuple[float, float] = key(
        (0.84, 5.0), unit="-", meaning="[oldest, youngest] Ω = U10/c_p", within="0.84 to 5, increasing"
    )
    fetch: tuple[float, float] = key(
        (3e3, 3e6), unit="m", meaning="[shortest, longest] fetch", within="100 to 1e8, increasing"
    )
    points: int = key(49, meaning="points along each curve", ge=5, le=2000)
    band: tuple[float, float] = band_key()
    choppiness: float = key(1.0, unit="-", meaning="horizontal displacement λ", ge=0, le=20)
    threshold: float = threshold_key(CALIBRATED_THRESHOLD)
    threshold_error: float = threshold_error_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_band(self.band)
        _check_range("wind.speed", self.wind.speed, 1, 50)
        _check_range("swell.significant_wave_height", self.swell.significant_wave_height, 1e-3, 30)
        _check_range("swell.peak_periods", self.swell.peak_periods, 2, 40)
        _check_range("inverse_wave_age", self.inverse_wave_age, 0.84, 5)
        _check_range("fetch", self.fetch, 100, 1e8)
        return self


def _check_range(path: str, values: tuple[float, ...], lowest: float, highest: float) -> None:
    for value in values:
        if not lowest <= value <= highest:
            raise wrong(path, f"hold numbers from {lowest:g} to {highest:g}, but one is {value:g}")
    for before, after in itertools.pairwise(values):
        if after <= before:
            raise wrong(path, f"increase from one to the next, but {after:g} follows {before:g}")
