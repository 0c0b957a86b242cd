"""From a wavespectra-style dataset to a spectrum: conventions checked, units converted."""

from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from ..spectra import AbstractTail, Dispersion, MeasuredSpectrum, PowerTail
from ..wind import Wind
from ._conventions import (
    checked_variable,
    columns_by_angle,
    directions,
    frequencies,
    highest_with_energy,
)
from ._negative import AbstractNegativeCells, ClipAndRenormalise, repair

if TYPE_CHECKING:
    import xarray

Record = int | dict[str, int]
"""Which spectrum of a file: its index in time, or an index for each dimension by name."""

WindOrigin: TypeAlias = Literal["measured", "model", "derived", "unknown"]
ORIGIN = "wind_origin"
"""The attribute of `wspd` in which readers say where it comes from."""


def spectrum_from_dataset(
    dataset: "xarray.Dataset",
    *,
    record: Record = 0,
    tail: AbstractTail | None = None,
    dispersion: Dispersion | None = None,
    cut_off: float | None = None,
    negative: AbstractNegativeCells | None = None,
    tail_bins: int = 1,
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
    - `tail_bins`: how many of the highest frequencies give the tail its level.

    **Returns:** a `MeasuredSpectrum`, float64 under x64, else float32.

    **Raises:** `ValueError` that says what is wrong with the dataset (missing variable or coordinate, other
    direction or unit convention, directions that do not cover the circle evenly, missing values) and what to
    do about it.
    """
    return SpectrumRecords(dataset, cut_off=cut_off, negative=negative).spectrum(
        record, tail=tail, dispersion=dispersion, tail_bins=tail_bins
    )


class SpectrumRecords:
    """All records of a dataset as spectra of one shape, so that they can be stacked and mapped over.

    The dataset is checked once; each record then costs no more than itself, however many there are.

    **Arguments:** `dataset`, `cut_off`, `negative` as in `spectrum_from_dataset`.

    **Attributes:** `frequency`: those that are used [Hz], increasing.

    **Raises:** `ValueError` as `spectrum_from_dataset` does, for what is wrong with the dataset as a whole.
    """

    def __init__(
        self,
        dataset: "xarray.Dataset",
        *,
        cut_off: float | None = None,
        negative: AbstractNegativeCells | None = None,
    ) -> None:
        self._dataset = dataset
        self._efth = checked_variable(dataset)
        self._negative = ClipAndRenormalise() if negative is None else negative
        frequency = frequencies(self._efth)
        self._columns, self._angles = columns_by_angle(directions(self._efth))
        rows = (frequency > 0) & (frequency <= highest_with_energy(self._efth, frequency))
        if cut_off is not None:
            rows &= frequency <= cut_off
        order = np.argsort(frequency)
        self._rows = order[rows[order]]
        if self._rows.size < 2:
            raise ValueError(
                f"Only {self._rows.size} frequencies of the dataset have energy below the cut-off: "
                "choose a higher `cut_off`."
            )
        self.frequency = frequency[self._rows]

    def records(self) -> list[dict[str, int]]:
        """The index of every record along each dimension but frequency and direction, the last one fastest."""
        sizes = {str(name): size for name, size in self._efth.sizes.items() if name not in ("freq", "dir")}
        return [dict(zip(sizes, map(int, index), strict=True)) for index in np.ndindex(*sizes.values())]

    def spectrum(
        self,
        record: Record,
        *,
        tail: AbstractTail | None = None,
        dispersion: Dispersion | None = None,
        tail_bins: int = 1,
    ) -> MeasuredSpectrum:
        """One record.

        **Arguments:** `record`, `tail`, `dispersion`, `tail_bins` as in `spectrum_from_dataset`.

        **Raises:** `ValueError` for a record that is not there or has missing values.
        """
        one = _select(self._efth, record, strict=True).transpose("freq", "dir")
        table = np.asarray(one.values, np.float64)[np.ix_(self._rows, self._columns)]
        if not np.isfinite(table).all():
            share = 1 - np.isfinite(table).mean()
            raise ValueError(
                f"Variable `efth` has missing values in {share:.0%} of record {record}: choose another `record`."
            )
        table = repair(table, self._angles, self._negative)
        return MeasuredSpectrum(
            table * (180 / np.pi),
            self.frequency,
            self._angles[0],
            tail=PowerTail() if tail is None else tail,
            dispersion=_dispersion(self._dataset, record) if dispersion is None else dispersion,
            tail_bins=min(tail_bins, self.frequency.size),
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


def wind_origin(dataset: "xarray.Dataset") -> WindOrigin | None:
    """Where the wind of a dataset comes from; None where it has none.

    "measured" by an instrument, the forcing of a "model", "derived" from the waves themselves (Spotter buoys infer it
    from the tail of their spectrum: it must not be held against what that spectrum predicts), or "unknown".
    """
    if "wspd" not in dataset or "wdir" not in dataset:
        return None
    told = dataset["wspd"].attrs.get(ORIGIN)
    if told in get_args(WindOrigin):
        return told
    return "derived" if "spotter" in str(dataset.attrs.get("source", "")).lower() else "unknown"


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


def _dispersion(dataset: Any, record: Record) -> Dispersion:
    if "dpt" not in dataset:
        return Dispersion()
    depth = float(_select(dataset["dpt"], record).values)
    return Dispersion(depth) if np.isfinite(depth) and depth > 0 else Dispersion()
