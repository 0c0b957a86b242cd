"""From a wavespectra-style dataset to a spectrum: conventions checked, units converted."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..spectra import AbstractTail, Dispersion, MeasuredSpectrum, PowerTail
from ..wind import Wind
from ._negative import AbstractNegativeCells, ClipAndRenormalise, repair

if TYPE_CHECKING:
    import xarray

Record = int | dict[str, int]
"""Which spectrum of a file: its index in time, or an index for each dimension by name."""


def spectrum_from_dataset(
    dataset: "xarray.Dataset",
    *,
    record: Record = 0,
    tail: AbstractTail | None = None,
    dispersion: Dispersion | None = None,
    cut_off: float | None = None,
    negative: AbstractNegativeCells | None = None,
) -> MeasuredSpectrum:
    """One record of a dataset `efth(…, freq, dir)` in wavespectra's conventions as a spectrum.

    The dataset has `efth` in m²/(Hz degree) and `dir` in degrees clockwise from north, **coming from**:

    $$ E(f, φ) = \\frac{180}{π}\\, \\mathrm{efth}, \\quad φ = 3π/2 − \\mathrm{dir}·π/180 $$

    **Arguments:**

    - `dataset`: an xarray dataset.
    - `record`: index in time, or `{"time": 3, "site": 0}` where there are more dimensions.
    - `tail`: what follows above the cut-off, `PowerTail()` by default; kept in the result.
    - `dispersion`: the depth where it was measured; by default the dataset's `dpt` [m] of this record where
      it has one, else deep water.
    - `cut_off`: frequencies above it [Hz] are dropped, and always those above the highest one with energy in
      any record of the dataset (buoys pad with zeros).
    - `negative`: what to do with negative cells, `ClipAndRenormalise()` by default.

    **Returns:** a `MeasuredSpectrum`, float64 under x64, else float32.

    **Raises:** `ValueError` that says what is wrong with the dataset (missing variable or coordinate, other
    direction or unit convention, directions that do not cover the circle evenly, missing values) and what to
    do about it.
    """
    efth = _checked_variable(dataset)
    one = _select(efth, record, strict=True)
    frequency = _frequencies(one)
    degrees = _directions(one)
    table = np.asarray(one.transpose("freq", "dir").values, np.float64)
    rows = (frequency > 0) & (frequency <= _highest_with_energy(efth, frequency))
    if cut_off is not None:
        rows &= frequency <= cut_off
    order = np.argsort(frequency)
    order = order[rows[order]]
    if order.size < 2:
        raise ValueError(
            f"Only {order.size} frequencies of the record have energy below the cut-off: "
            "choose another `record` or a higher `cut_off`."
        )
    frequency, table = frequency[order], table[order]
    if not np.isfinite(table).all():
        share = 1 - np.isfinite(table).mean()
        raise ValueError(
            f"Variable `efth` has missing values in {share:.0%} of record {record}: choose another `record`."
        )
    table, first = _columns_by_angle(table, degrees)
    angles = first + 2 * np.pi / table.shape[1] * np.arange(table.shape[1])
    table = repair(table, angles, ClipAndRenormalise() if negative is None else negative)
    return MeasuredSpectrum(
        table * (180 / np.pi),
        frequency,
        first,
        tail=PowerTail() if tail is None else tail,
        dispersion=_dispersion(dataset, record) if dispersion is None else dispersion,
    )


def wind_from_dataset(dataset: "xarray.Dataset", *, record: Record = 0) -> Wind:
    """The wind stored with a record (`wspd` [m/s] at 10 m, `wdir` coming from, degrees clockwise from north).

    Beware: that of Spotter buoys is itself derived from the wave spectrum.

    **Raises:** `ValueError` where the dataset has no wind, or not for this record.
    """
    values = []
    for name in ("wspd", "wdir"):
        if name not in dataset:
            raise ValueError(f"The dataset has no variable `{name}`: give the wind by hand.")
        value = float(_select(dataset[name], record).values)
        if not np.isfinite(value):
            raise ValueError(f"Variable `{name}` is missing in record {record}: give the wind by hand.")
        values.append(value)
    speed, from_degrees = values
    return Wind.from_meteorological(speed, from_degrees=from_degrees)


def _checked_variable(dataset: Any) -> Any:
    if "efth" not in dataset:
        names = ", ".join(f"`{name}`" for name in list(dataset.data_vars)[:6]) or "none"
        raise ValueError(
            f"The dataset has no variable `efth` (it has {names}): it is not a directional wave spectrum in "
            "wavespectra's convention."
        )
    efth = dataset["efth"]
    for name, meaning in (("freq", "frequency [Hz]"), ("dir", "direction [degrees]")):
        if name not in efth.dims or name not in dataset.coords:
            raise ValueError(
                f"Variable `efth` has no coordinate `{name}`, the {meaning}: "
                "it must have the dimensions (…, freq, dir), each with its coordinate."
            )
    units = str(efth.attrs.get("units", ""))
    if "rad" in units:
        raise ValueError(
            f"Variable `efth` is in {units}, but must be in m² s degree⁻¹: "
            "multiply it by π/180 and rename its units."
        )
    return efth


def _frequencies(efth: Any) -> np.ndarray:
    frequency = np.asarray(efth["freq"].values, np.float64)
    if (
        not np.isfinite(frequency).all()
        or (frequency < 0).any()
        or np.unique(frequency).size < frequency.size
    ):
        raise ValueError("Coordinate `freq` must hold different numbers of at least 0 Hz, but does not.")
    return frequency


def _directions(efth: Any) -> np.ndarray:
    """Directions in degrees, after a check of everything that betrays another convention."""
    coordinate = efth["dir"]
    name, units = (str(coordinate.attrs.get(key, "")).lower() for key in ("standard_name", "units"))
    text = f"{name} {str(coordinate.attrs.get('long_name', '')).lower()}".replace("_", " ")
    if "to direction" in text or "going to" in text or "towards" in text:
        raise ValueError(
            f"Coordinate `dir` holds directions that waves go to ({name or text.strip()}), but must hold "
            "those that they come from: replace it by (dir + 180) % 360 and correct its attributes."
        )
    degrees = np.asarray(coordinate.values, np.float64)
    if "rad" in units or (degrees.size > 4 and np.ptp(degrees) <= 2 * np.pi + 1e-3):
        raise ValueError(
            "Coordinate `dir` seems to be in radians, but must be in degrees clockwise from north: "
            "multiply it by 180/π, and `efth` by π/180."
        )
    if not np.isfinite(degrees).all() or degrees.min() < 0 or degrees.max() > 360:
        raise ValueError(
            "Coordinate `dir` must lie between 0 and 360 degrees clockwise from north, "
            f"but runs from {degrees.min():g} to {degrees.max():g}: take it modulo 360."
        )
    return degrees


def _columns_by_angle(table: np.ndarray, degrees: np.ndarray) -> tuple[np.ndarray, float]:
    """Columns in counter-clockwise order of the direction towards, and that of the first [rad]."""
    if 0 in degrees and 360 in degrees:  # the same direction twice
        keep = degrees != 360
        table, degrees = table[:, keep], degrees[keep]
    towards = np.mod(270 - degrees, 360)
    order = np.argsort(towards)
    steps = np.diff(np.append(towards[order], towards[order[0]] + 360))
    if degrees.size < 5 or np.ptp(steps) > 0.01 * 360 / degrees.size:
        raise ValueError(
            "Coordinate `dir` must cover the circle in at least 5 equal steps, but its "
            f"{degrees.size} directions have steps from {steps.min():g} to {steps.max():g} degrees: "
            "interpolate `efth` first."
        )
    return table[:, order], float(np.deg2rad(towards[order[0]]))


def _select(variable: Any, record: Record, *, strict: bool = False) -> Any:
    """One record of a variable: only the dimensions freq and dir remain.

    `strict` (for `efth`) wants every dimension that `record` names; other variables may lack some.
    """
    index = record if isinstance(record, dict) else {"time": record}
    if not isinstance(record, dict) and "time" not in variable.dims and record in (0, -1):
        index = {}
    for name, position in index.items():
        size = variable.sizes.get(name)
        if size is None and strict:
            raise ValueError(f"Argument `record` is {record}, but `efth` has no dimension `{name}`.")
        if size is not None and not -size <= position < size:
            raise ValueError(
                f"Argument `record` must lie within the {size} entries of `{name}`, but is {position}."
            )
    variable = variable.isel({name: index[name] for name in index if name in variable.dims})
    left = [name for name in variable.dims if name not in ("freq", "dir")]
    ambiguous = [name for name in left if variable.sizes[name] > 1]
    if ambiguous:
        example = dict(index) | dict.fromkeys(ambiguous, 0)
        raise ValueError(
            f"Argument `record` must choose along {' and '.join(ambiguous)} too, "
            f"for example {example}, but is {record}."
        )
    return variable.isel(dict.fromkeys(left, 0))


def _highest_with_energy(efth: Any, frequency: np.ndarray) -> float:
    energy = efth.sum([name for name in efth.dims if name != "freq"]).values
    with_energy = frequency[np.asarray(energy) > 0]
    if with_energy.size == 0:
        raise ValueError("Variable `efth` is 0 everywhere: there is no sea in it.")
    return float(with_energy.max())


def _dispersion(dataset: Any, record: Record) -> Dispersion:
    if "dpt" not in dataset:
        return Dispersion()
    depth = float(_select(dataset["dpt"], record).values)
    return Dispersion(depth) if np.isfinite(depth) and depth > 0 else Dispersion()
