"""The config of `measured_sea`, and what configs of measurements share."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._calibration import LawName
from ._data import data_folder
from ._sea import WindConfig, breaking_wavenumber_key, threshold_key

CALIBRATED_THRESHOLD, CALIBRATED_ERROR = 0.65, 0.02
"""ε and its error for which a developed sea obeys Monahan's law best (projected area, λ = 1, k_b = 73 rad/m)."""


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

SPECTRA_SUFFIXES = (".data_spec", ".csv", ".DIRSPEC", ".nc", ".spec")

RecordChoice = int | tuple[int, int] | None


def record_key():
    """The key `record`: one record, a range of them, or all."""
    return key(
        None,
        meaning="which records, counted from 0: one number, or [first, last]; null: all",
        within="0 ≤ first ≤ last",
    )


def check_record(record: RecordChoice) -> None:
    """For validators: the records of a choice must exist in some file."""
    first, last = record if isinstance(record, tuple) else (record or 0, record or 0)
    if not 0 <= first <= last:
        shown = f"[{first}, {last}]" if isinstance(record, tuple) else f"{record}"
        raise wrong("record", f"be a number from 0, or [first, last] with first ≤ last, but is {shown}")


def threshold_error_key(default: float = CALIBRATED_ERROR):
    """The key `threshold_error`: what the bands of figures show."""
    return key(default, unit="-", meaning="error of ε, for the bands of figures", ge=0, le=1)


def check_band(band: tuple[float, float]) -> None:
    """For validators: a band of wavenumbers must not be empty."""
    lower, upper = band
    if not 0 < lower < upper:
        raise wrong("band", f"be [lower, upper] with 0 < lower < upper, but is [{lower:g}, {upper:g}]")


def band_key():
    """The key `band`: which waves count."""
    return key(
        (1e-3, 400.0), unit="rad/m", meaning="[lower, upper] of |k| that counts", within="0 < lower < upper"
    )


class MeasuredSeaConfig(ExperimentConfig):
    """`measured_sea`: whitecap coverage predicted from measured directional spectra."""

    experiment: Literal["measured_sea"] = key("measured_sea", meaning="which experiment this config runs")
    files: tuple[str, ...] = key(
        (), meaning="spectrum files; []: those of $JAXOCEAN_DATA/spectra (../shared/data), else one made here"
    )
    kind: Literal["ndbc", "spotter", "triaxys", "ww3", "swan", "wavespectra"] | None = key(
        None, meaning="format of the files: ndbc, spotter, triaxys, ww3, swan, wavespectra; null: found out"
    )
    record: RecordChoice = record_key()
    times: tuple[str, str] | None = key(
        None, meaning="[first, last] time of the records, such as [2020-06-01, 2020-06-03T12:00]; null: all"
    )
    records: int | None = key(
        None, meaning="at most so many of them in each file, evenly spaced; null: all", ge=1, le=1_000_000
    )
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
    tail_from: float = key(
        0.8,
        unit="-",
        meaning="share of the highest frequency above which what was measured gives the tail its level; 1: the last "
        "one alone, which is noisy",
        gt=0,
        le=1,
    )
    wind: WindConfig = key(WindConfig(), meaning="for the tail `elfouhaily` and for the file made here")
    laws: tuple[LawName, ...] = key(
        ("callaghan_2008", "coare_3_6"), meaning="shown at the file's own wind, unless the waves gave it"
    )
    band: tuple[float, float] = band_key()
    choppiness: float = key(1.0, unit="-", meaning="horizontal displacement λ", ge=0, le=20)
    threshold: float = threshold_key(CALIBRATED_THRESHOLD)
    threshold_error: float = threshold_error_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_band(self.band)
        check_record(self.record)
        if self.times is not None:
            first, last = self.moments()
            if first > last:
                raise wrong("times", f"be [first, last] with first ≤ last, but is {list(self.times)}")
        return self

    def spectrum_files(self) -> tuple[Path, ...]:
        """The files to read; none where there is neither a key nor a data folder. One is NDBC's five."""
        if self.files:
            return tuple(Path(name).expanduser() for name in self.files)
        folder = data_folder() / "spectra"
        found = sorted(folder.iterdir()) if folder.is_dir() else []
        return tuple(path for path in found if path.suffix in SPECTRA_SUFFIXES)

    def moments(self) -> tuple[datetime, ...]:
        """First and last time of `times`, in UTC."""
        return tuple(_moment("times", text) for text in self.times or ())

    def inputs(self) -> tuple[str, ...]:
        siblings = [p for path in self.spectrum_files() for p in sorted(path.parent.glob(f"{path.stem}.sw*"))]
        return tuple(str(path) for path in (*self.spectrum_files(), *siblings))


def _moment(path: str, text: str) -> datetime:
    """A time in UTC, as NumPy and ISO 8601 write it."""
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise wrong(path, f"hold times such as 2020-06-01 or 2020-06-01T12:00, but one is {text!r}") from None
    return moment.astimezone(UTC).replace(tzinfo=None) if moment.tzinfo else moment
