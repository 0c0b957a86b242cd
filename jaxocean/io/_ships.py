"""Ship records of wind, height and phase speed, as tables of numbers under a line of names."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

NEEDED = {"u": "wind speed [m/s]", "zu": "its height [m]", "sigH": "Hs [m]", "cp": "phase speed [m/s]"}
OPTIONAL = ("jd", "ta", "tsnk", "lat", "lon")


@dataclass(frozen=True)
class ShipRecords:
    """What a ship measured, record by record, NaN where it did not.

    **Arguments:** `day` of the year [days, from 1], `wind_speed` [m/s] at `wind_height` [m],
    `significant_wave_height` [m], `peak_speed`: phase speed at the spectral peak [m/s], `air_temperature` and
    `sea_temperature` of the skin [°C], `latitude` and `longitude` [degrees].
    """

    day: Float[np.ndarray, " record"]
    wind_speed: Float[np.ndarray, " record"]
    wind_height: Float[np.ndarray, " record"]
    significant_wave_height: Float[np.ndarray, " record"]
    peak_speed: Float[np.ndarray, " record"]
    air_temperature: Float[np.ndarray, " record"]
    sea_temperature: Float[np.ndarray, " record"]
    latitude: Float[np.ndarray, " record"]
    longitude: Float[np.ndarray, " record"]

    def complete(self) -> Bool[np.ndarray, " record"]:
        """Where wind, height and phase speed are all there and can be: not missing, not a negative stand-in."""
        wind = np.isfinite(self.wind_speed) & (self.wind_speed >= 0) & (self.wind_height > 0)
        waves = (self.significant_wave_height > 0) & (self.peak_speed > 0)
        return wind & waves & np.isfinite(self.significant_wave_height + self.peak_speed)


def read_ship_records(path: str | os.PathLike) -> ShipRecords:
    """A table in the form of the test data of the COARE bulk flux algorithm.

    The first line names the columns, each other line holds as many numbers (`nan` where one is missing), separated by
    spaces or tabs. Needed are `u`, `zu`, `sigH` and `cp`; used where present `jd` (day of the year), `ta`, `tsnk`,
    `lat` and `lon`; others are passed over.

    **Arguments:** `path`: the file.

    **Returns:** `ShipRecords`, in the file's order.

    **Raises:** `FileNotFoundError`; `ValueError` for a file that is no text, lacks a column or a record, or has a line
    that does not fit, with its number.
    """
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"There is no file `{file}`.")
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"File `{file}` is not a text file with a table of ship records.") from error
    lines = [(number, line.split()) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    names = lines[0][1] if lines else []
    missing = [f"`{name}` ({meaning})" for name, meaning in NEEDED.items() if name not in names]
    if missing:
        raise ValueError(
            f"File `{file}` must name in its first line the columns of ship records, but lacks "
            f"{', '.join(missing)}."
        )
    if len(lines) < 2:
        raise ValueError(f"File `{file}` names columns, but holds no record.")
    table = np.array([_numbers(cells, len(names), file, number) for number, cells in lines[1:]])
    columns = {name: table[:, names.index(name)] for name in (*NEEDED, *OPTIONAL) if name in names}
    absent = np.full(table.shape[0], np.nan)
    return ShipRecords(
        day=columns.get("jd", absent),
        wind_speed=columns["u"],
        wind_height=columns["zu"],
        significant_wave_height=columns["sigH"],
        peak_speed=columns["cp"],
        air_temperature=columns.get("ta", absent),
        sea_temperature=columns.get("tsnk", absent),
        latitude=columns.get("lat", absent),
        longitude=columns.get("lon", absent),
    )


def _numbers(cells: list[str], count: int, file: Path, number: int) -> list[float]:
    if len(cells) != count:
        raise ValueError(
            f"Line {number} of `{file}` must hold {count} numbers, one per column, but holds {len(cells)}: "
            "is the file cut short?"
        )
    values = []
    for cell in cells:
        try:
            values.append(float(cell))
        except ValueError:
            raise ValueError(f"Line {number} of `{file}` must hold numbers, but holds {cell!r}.") from None
    return values
