"""Which result changes how much over which swept key: in words, from means that are gathered block by block."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..harness._loading import Loaded
from ..harness._quantity import shown
from ..harness._result import cell
from ._design import Axis, Design
from ._results import Results, coordinate, variable_name
from ._values import Between

MAIN = 4
"""So many results are drawn and told."""

BINS = 200
"""A key with more values than this is told by parts of its range."""

NOTHING, BEYOND = 1e-9, 0.02
"""Relative changes below are none; extremes that stand out by less than this share of all change are not told."""

PARTS = 10
"""Into so many parts the range of a key is cut whose values are drawn or listed."""


def main_results(results: Results, ranges: Mapping[str, tuple[float, float, float]]) -> list[str]:
    """The first result that changes of each kind: kinds are told apart by the first word of the name."""
    found: dict[str, str] = {}
    for name, (least, _, most) in ranges.items():
        if results.array(name).ndim == 1 and most > least:
            found.setdefault(name.partition("_")[0], name)
    return list(found.values())[:MAIN]


@dataclass(frozen=True)
class _Parts:
    """A key cut into parts: which part a point is in, and how a part is named."""

    axis: Axis
    names: Sequence[str]
    grid: bool
    low: float = 0.0
    width: float = 1.0

    def of(self, codes: np.ndarray) -> np.ndarray:
        """The part of each point."""
        if self.grid:
            return codes * len(self.names) // length(self.axis)
        place = (self.axis.values.numbers(codes) - self.low) / self.width
        return np.clip(place.astype(int), 0, len(self.names) - 1)


def words_of_effects(design: Design, loaded: Loaded, results: Results, names: Sequence[str]) -> list[str]:
    """One sentence for each result and each swept key."""
    parts = [part for axis in design.axes if (part := _parts(design, axis)) is not None]
    words = []
    mean = "" if len(design.axes) == 1 else " (means over the other keys)"
    for name in names:
        own = shown(str(results.array(name).attrs["units"]))
        told, idle = [], []
        for part, values in zip(parts, _means(design, results, name, parts), strict=True):
            unit = shown(coordinate(part.axis, loaded).units) if part.axis.values.numeric else "-"
            known = np.flatnonzero(np.isfinite(values))
            if known.size < 2:
                continue
            if np.ptp(values[known]) <= NOTHING * np.max(np.abs(values[known])):
                idle.append(f"`{part.axis.key}`")
            else:
                told.append(_course(part, values, known, unit, own))
        if idle:
            told.append(f"it does not depend on {' and '.join(idle)}")
        if told:
            words.append(f"`{name}`{mean}: {'; '.join(told)}.")
    return words


def _parts(design: Design, axis: Axis) -> _Parts | None:
    values = axis.values
    if not isinstance(values, Between) and design.kind == "cartesian":
        count = min(len(values), BINS)
        first = -(-np.arange(count) * len(values) // count)
        return _Parts(axis, [values.spell(int(code)) for code in first], grid=True)
    if not values.numeric:
        return None
    low, high = _extent(design, axis)
    if not high > low:
        return None
    width = (high - low) / PARTS
    return _Parts(axis, [f"{low + (i + 0.5) * width:.4g}" for i in range(PARTS)], False, low, width)


def _extent(design: Design, axis: Axis) -> tuple[float, float]:
    """The least and the greatest value of a key."""
    values = axis.values
    if isinstance(values, Between):
        return values.low, values.high
    numbers = values.numbers(np.arange(design.count if design.kind == "zip" else len(values)))
    return float(numbers.min()), float(numbers.max())


def _means(design: Design, results: Results, name: str, parts: Sequence[_Parts]) -> list[np.ndarray]:
    """The mean of a result in each part of each key."""
    sums = [np.zeros(len(part.names)) for part in parts]
    counts = [np.zeros(len(part.names)) for part in parts]
    array = results.array(name)
    places = {axis.key: i for i, axis in enumerate(design.axes)}
    for start, stop in results.spans():
        values = np.asarray(array[start:stop])
        known = np.isfinite(values)
        codes = design.codes(start, stop)
        for part, total, count in zip(parts, sums, counts, strict=True):
            where = part.of(codes[places[part.axis.key]])[known]
            total += np.bincount(where, values[known], len(total))
            count += np.bincount(where, minlength=len(count))
    with np.errstate(invalid="ignore"):
        return [total / count for total, count in zip(sums, counts, strict=True)]


def _course(part: _Parts, means: np.ndarray, known: np.ndarray, unit: str, own: str) -> str:
    """From where to where a result goes over one key, and where it is most or least if that is inside."""
    first, last = int(known[0]), int(known[-1])
    start, end = float(means[first]), float(means[last])
    near = "" if part.grid else "about "
    said = (
        f"over `{part.axis.key}` from {near}{part.names[first]} to {near}{_with_unit(part.names[last], unit)} it goes "
        f"from {cell(start)} to {_with_unit(cell(end), own)}{_change(start, end)}"
    )
    inside = known[1:-1]
    if not inside.size or not part.grid:
        # Extremes of means over drawn points are mostly chance.
        return said
    high, low = int(inside[np.argmax(means[inside])]), int(inside[np.argmin(means[inside])])
    least = BEYOND * float(np.ptp(means[known]))
    for best, beyond, word in (
        (high, means[high] - max(start, end), "most"),
        (low, min(start, end) - means[low], "least"),
    ):
        if beyond > least:
            said += (
                f", its {word} is {cell(float(means[best]))} at {near}{_with_unit(part.names[best], unit)}"
            )
    return said


def _change(start: float, end: float) -> str:
    if start * end <= 0:
        return ""
    ratio = end / start
    if 0.5 < ratio < 2:
        return f" ({100 * (ratio - 1):+.2g} %)"
    return f" (times {ratio:.3g})"


def _with_unit(number: str, unit: str) -> str:
    return number if unit == "-" else f"{number} {unit}"


def length(axis: Axis) -> int:
    """How many values a swept key has that is not drawn."""
    assert not isinstance(axis.values, Between)
    return len(axis.values)


def swept_numbers(results: Results, axis: Axis, where: np.ndarray) -> np.ndarray:
    """The swept values of some points, sorted by their numbers, as floats; of names their places in the list."""
    if axis.values.numeric:
        return picked(results, variable_name(axis.key), where)
    texts = picked(results, variable_name(axis.key), where)
    order = {axis.values.spell(code): code for code in range(length(axis))}
    return np.asarray([order[str(text)] for text in texts.tolist()], float)


def picked(results: Results, name: str, where: np.ndarray) -> np.ndarray:
    """The values of an array of the store at some points, in ascending order, chunk by chunk."""
    array = results.array(name)
    found = []
    for chunk in np.unique(where // results.chunk).tolist():
        start, stop = chunk * results.chunk, min((chunk + 1) * results.chunk, results.count)
        inside = where[(where >= start) & (where < stop)] - start
        found.append(np.asarray(array[start:stop])[inside])
    return np.concatenate(found)
