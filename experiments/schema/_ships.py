"""The config of `ship_records`."""

from pathlib import Path
from typing import Literal, Self

from pydantic import model_validator

from ._base import TURN, ExperimentConfig, Section, key
from ._calibration import LawName
from ._data import data_folder
from ._measured import (
    CALIBRATED_THRESHOLD,
    RecordChoice,
    band_key,
    check_band,
    check_record,
    record_key,
    threshold_error_key,
)
from ._sea import breaking_wavenumber_key, threshold_key
from ._spectra import MitsuyasuSpreading, SpreadingConfig


class ShipSwellConfig(Section):
    """`swell`: what ships do not report of it."""

    angle: float = key(
        0.0,
        unit="rad",
        meaning="of the swell to the wind, counter-clockwise",
        ge=-TURN,
        le=TURN,
    )
    width: float = key(0.1, unit="-", meaning="σ/f_p of its bell in frequency", ge=0.01, le=0.3)
    spreading: SpreadingConfig = key(
        MitsuyasuSpreading(s_max=75.0), meaning="how its energy spreads over directions"
    )


class ShipRecordsConfig(ExperimentConfig):
    """`ship_records`: whitecap coverage predicted from wind, height and phase speed, beside laws."""

    experiment: Literal["ship_records"] = key("ship_records", meaning="which experiment this config runs")
    file: str | None = key(
        None, meaning="table of records; null: $JAXOCEAN_DATA/meteorology/test_36_data.txt (../shared/data)"
    )
    record: RecordChoice = record_key()
    laws: tuple[LawName, ...] = key(
        ("coare_3_6", "callaghan_2008"), meaning="laws to compare with", min_length=1, max_length=4
    )
    drag: Literal["elfouhaily", "wu"] = key(
        "elfouhaily", meaning="drag law: brings the wind to 10 m (neutral profile), and makes short waves"
    )
    swell: ShipSwellConfig = key(ShipSwellConfig(), meaning="what ships do not report of the swell")
    band: tuple[float, float] = band_key()
    choppiness: float = key(1.0, unit="-", meaning="horizontal displacement λ", ge=0, le=20)
    threshold: float = threshold_key(CALIBRATED_THRESHOLD)
    threshold_error: float = threshold_error_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    resamples: int = key(2000, meaning="bootstrap resamples of whole blocks of records", ge=100, le=100_000)
    block: float = key(
        1.0, unit="d", meaning="length of those blocks: records close in time are alike", gt=0, le=100
    )
    confidence: float = key(0.95, unit="-", meaning="of the intervals", gt=0, lt=1)

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_band(self.band)
        check_record(self.record)
        return self

    def path(self) -> Path:
        """The file of records."""
        if self.file is not None:
            return Path(self.file).expanduser()
        return data_folder() / "meteorology" / "test_36_data.txt"

    def inputs(self) -> tuple[str, ...]:
        return (str(self.path()),)
