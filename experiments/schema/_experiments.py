"""The config of each experiment."""

import os
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ._base import ExperimentConfig, Section, key, wrong
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


class NoTailConfig(Section):
    """Nothing above the cut-off."""

    law: Literal["none"] = key("none", meaning="what follows above the cut-off")


class PowerTailConfig(Section):
    """A power law in frequency."""

    law: Literal["power"] = key("power", meaning="what follows above the cut-off")
    exponent: float = key(-5.0, unit="-", meaning="n of E ∝ f^n: -5 or -4", ge=-10, le=-1.01)


class ElfouhailyTailConfig(Section):
    """The unified spectrum of the file's own wind, or of `wind` where it has none."""

    law: Literal["elfouhaily"] = key("elfouhaily", meaning="what follows above the cut-off")
    blend: float = key(1.5, unit="-", meaning="frequency ratio over which it is blended in", ge=1.01, le=100)
    exponent: float = key(-5.0, unit="-", meaning="of the power law meanwhile", ge=-10, le=-1.01)


TailConfig = Annotated[NoTailConfig | PowerTailConfig | ElfouhailyTailConfig, Field(discriminator="law")]

DATA_VARIABLE = "JAXOCEAN_DATA"
SPECTRA_SUFFIXES = (".data_spec", ".csv", ".DIRSPEC", ".nc", ".spec")


class MeasuredSeaConfig(ExperimentConfig):
    """`measured_sea`: whitecap coverage predicted from measured directional spectra."""

    experiment: Literal["measured_sea"] = key("measured_sea", meaning="which experiment this config runs")
    files: tuple[str, ...] = key(
        (), meaning="spectrum files; []: those of $JAXOCEAN_DATA/spectra (../shared/data), else one made here"
    )
    records: int = key(200, meaning="at most so many records of each file, evenly spaced", ge=1, le=100_000)
    cut_off: float | None = key(
        0.4,
        unit="Hz",
        meaning="drop what was measured above: buoys lose energy there",
        gt=0,
        le=10,
    )
    negative: Literal["renormalise", "maximum_entropy", "clip"] = key(
        "renormalise", meaning="what becomes of negative cells of buoys"
    )
    tail: TailConfig = key(PowerTailConfig(), meaning="what follows above the cut-off")
    wind: WindConfig = key(WindConfig(), meaning="for the tail `elfouhaily` and for the file made here")
    band: tuple[float, float] = key(
        (1e-3, 400.0), unit="rad/m", meaning="[lower, upper] of |k| that counts", within="0 < lower < upper"
    )
    choppiness: float = key(1.0, unit="-", meaning="horizontal displacement λ", ge=0, le=20)
    threshold: float = threshold_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()

    @model_validator(mode="after")
    def _check(self) -> Self:
        lower, upper = self.band
        if not 0 < lower < upper:
            raise wrong("band", f"be [lower, upper] with 0 < lower < upper, but is [{lower:g}, {upper:g}]")
        return self

    def spectrum_files(self) -> tuple[Path, ...]:
        """The files to read; none where there is neither a key nor a data folder. One is NDBC's five."""
        if self.files:
            return tuple(Path(name).expanduser() for name in self.files)
        folder = Path(os.environ.get(DATA_VARIABLE, "../shared/data")) / "spectra"
        found = sorted(folder.iterdir()) if folder.is_dir() else []
        return tuple(path for path in found if path.suffix in SPECTRA_SUFFIXES)

    def inputs(self) -> tuple[str, ...]:
        siblings = [p for path in self.spectrum_files() for p in sorted(path.parent.glob(f"{path.stem}.sw*"))]
        return tuple(str(path) for path in (*self.spectrum_files(), *siblings))
