"""The config of `foam_in_time`."""

import itertools
import math
import os
from pathlib import Path
from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._calibration import LawName, WindsConfig
from ._experiments import DATA_VARIABLE
from ._sea import CascadeConfig, Choppiness, breaking_wavenumber_key, check_choppiness, choppiness_key
from ._spectra import ElfouhailyConfig, JonswapConfig, PiersonMoskowitzConfig, SpectrumConfig

SIZES = (128.0, 32.0)


class FoamWindsConfig(WindsConfig):
    """`wind`: the winds at 10 m, each with a sea of its own."""

    speed: tuple[float, ...] = key(
        (8.0, 10.0, 12.0, 15.0),
        unit="m/s",
        meaning="U10 of each sea",
        within="increasing, 0.5 to 60, 2 to 12 of them",
        min_length=2,
        max_length=12,
    )


class WorldTileConfig(Section):
    """`tile`: the square on which the sum of all patterns repeats."""

    size: float = key(
        128.0,
        unit="m",
        meaning="side; the cascade's sizes are rounded to whole fractions of it",
        gt=0,
        le=1e5,
    )
    resolution: int = key(256, meaning="grid points per side", within="even, 32 to 4096", ge=32, le=4096)


class EventsConfig(Section):
    """`events`: breakers that are followed from their first point to their last."""

    window: float = key(6.0, unit="s", meaning="how long they are followed", gt=0, le=600)
    file: str | None = key(
        None,
        meaning="measured events, CSV; null: $JAXOCEAN_DATA/breaking/breaking_events.csv if it is there",
    )
    shortest: float = key(
        1 / 3,
        unit="s",
        meaning="shorter ones are left out where means are compared: no camera sees them",
        ge=0,
    )


class FoamInTimeConfig(ExperimentConfig):
    """`foam_in_time`: active and total coverage on a world tile, and without it."""

    experiment: Literal["foam_in_time"] = key("foam_in_time", meaning="which experiment this config runs")
    wind: FoamWindsConfig = key(FoamWindsConfig(), meaning="the winds")
    spectrum: SpectrumConfig = key(
        ElfouhailyConfig(),
        meaning="the wave spectrum of each wind",
        within="elfouhaily, pierson_moskowitz, or jonswap with wind.fetch",
    )
    cascade: CascadeConfig = key(CascadeConfig(sizes=SIZES, resolution=128), meaning="the periodic patterns")
    tile: WorldTileConfig = key(WorldTileConfig(), meaning="the world tile")
    choppiness: Choppiness = choppiness_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key(6.0)
    threshold: float | None = key(
        None, unit="-", meaning="ε; null: fitted to `active_law`, one for all winds", ge=-100, lt=1
    )
    decay_time: float | None = key(
        None, unit="s", meaning="τ of the foam; null: fitted to `total_law`, one for all winds", gt=0, le=60
    )
    active_law: LawName = key("monahan_lu_1990_stage_a", meaning="whitecap law of what breaks now")
    total_law: LawName = key("monahan_1980", meaning="whitecap law of all foam")
    decay_times: tuple[float, ...] = key(
        (0.5, 1.0, 3.53),
        unit="s",
        meaning="τ at which the closed forms are held against the tile, besides the fitted one",
        within="increasing, each > 0 and ≤ 60",
        min_length=1,
        max_length=20,
    )
    step: float = key(0.05, unit="s", meaning="time step Δt", gt=0, le=10)
    spin_up: float = key(5.0, unit="-", meaning="longest decay times before means are taken", ge=5, le=100)
    duration: float = key(18.0, unit="s", meaning="over which means are taken", gt=0, le=1e5)
    block: float = key(
        3.0, unit="s", meaning="length of the blocks whose scatter is the error of the closed forms", gt=0
    )
    seas: int = key(8, meaning="realisations of each wind: their scatter is the error", ge=2, le=1000)
    breaking_wavenumbers: tuple[float, ...] = key(
        (3.0, 6.0, 12.0, 24.0),
        unit="rad/m",
        meaning="k_b for which ε and τ are tabled; [] for none",
        within="each > 0",
    )
    events: EventsConfig = key(EventsConfig(), meaning="breakers and their durations")
    drawn_wind: float | None = key(
        None, unit="m/s", meaning="the wind whose foam is drawn, one of `wind.speed`; null: the strongest"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        speeds = self.wind.speed
        for speed in speeds:
            if not 0.5 <= speed <= 60:
                raise wrong("wind.speed", f"hold speeds from 0.5 to 60 m/s, but one is {speed:g}")
        for before, after in itertools.pairwise(speeds):
            if after <= before:
                raise wrong("wind.speed", f"increase from one to the next, but {after:g} follows {before:g}")
        check_choppiness(self.choppiness, len(self.cascade.sizes))
        if not any(self.choppiness if isinstance(self.choppiness, tuple) else (self.choppiness,)):
            raise wrong("choppiness", "be greater than 0: without displacement j = 1 everywhere")
        if self.cascade.bands is not None:
            raise wrong("cascade.bands", "be null: they follow from the sizes, which the tile rounds")
        if self.tile.resolution % 2:
            raise wrong("tile.resolution", f"be even, but is {self.tile.resolution}")
        self._check_spectrum()
        self._check_times()
        if any(not 0 < k <= 1e5 for k in self.breaking_wavenumbers):
            raise wrong("breaking_wavenumbers", "hold wavenumbers greater than 0 rad/m and at most 1e5")
        if self.drawn_wind is not None and self.drawn_wind not in speeds:
            listed = ", ".join(f"{speed:g}" for speed in speeds)
            raise wrong("drawn_wind", f"be one of `wind.speed` ({listed}), but is {self.drawn_wind:g}")
        return self

    def _check_spectrum(self) -> None:
        if not isinstance(self.spectrum, ElfouhailyConfig | PiersonMoskowitzConfig | JonswapConfig):
            raise wrong("spectrum.family", "follow the wind: elfouhaily, pierson_moskowitz or jonswap")
        if isinstance(self.spectrum, JonswapConfig) and self.wind.fetch is None:
            raise wrong("wind.fetch", "be given, so that the spectrum `jonswap` follows the wind")

    def _check_times(self) -> None:
        for tau in self.decay_times:
            if not 0 < tau <= 60:
                raise wrong(
                    "decay_times", f"hold times greater than 0 s and at most 60 s, but one is {tau:g}"
                )
        for before, after in itertools.pairwise(self.decay_times):
            if after <= before:
                raise wrong("decay_times", f"increase from one to the next, but {after:g} follows {before:g}")
        if self.events.window < 4 * self.step:
            raise wrong(
                "events.window", f"last at least 4 steps of {self.step:g} s, but is {self.events.window:g}"
            )
        if self.duration < 2 * self.block:
            raise wrong("duration", f"hold at least 2 blocks of {self.block:g} s, but is {self.duration:g}")
        if self.block < self.step:
            raise wrong("block", f"last at least one step of {self.step:g} s, but is {self.block:g}")

    @property
    def chunk(self) -> int:
        """Steps that are taken at once: those of a window of events."""
        return math.ceil(self.events.window / self.step - 1e-9)

    def events_file(self) -> Path | None:
        """The measured events, or None where there are none."""
        if self.events.file is not None:
            return Path(self.events.file).expanduser()
        folder = Path(os.environ.get(DATA_VARIABLE, "../shared/data"))
        path = folder / "breaking" / "breaking_events.csv"
        return path if path.is_file() else None

    def inputs(self) -> tuple[str, ...]:
        path = self.events_file()
        return () if path is None else (str(path),)
