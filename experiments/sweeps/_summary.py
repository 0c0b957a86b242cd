"""What a sweep found, in a table and in words; the numbers are read block by block."""

from typing import Any

import numpy as np

from ..harness._quantity import UNDEFINED, shown
from ..harness._result import Result, Table, cell
from ._design import Axis, Design
from ._effects import main_results, words_of_effects
from ._plan import Sweep
from ._results import DONE, Results, coordinate
from ._values import Between

SHOWN = 5
"""So many reasons of failures are told."""


def summarise(sweep: Sweep, results: Results, notes: tuple[str, ...]) -> Result:
    """Ranges of all numbers, and what failed."""
    design, base = sweep.points.design, sweep.base
    done, failed = results.tally()
    ranges, undefined = {}, {}
    for name in results.names():
        ranges[name], undefined[name] = _range(results, name, done)
    effects = words_of_effects(design, base, results, main_results(results, ranges))
    reasons = results.reasons().most_common()
    swept = [
        (
            axis.key,
            _count(axis),
            *_ends(axis),
            shown(coordinate(axis, base).units) if axis.values.numeric else "",
        )
        for axis in design.axes
    ]
    units = {name: shown(str(results.array(name).attrs["units"])) for name in ranges}
    return Result(
        values={
            "points": design.count,
            "done": done,
            "failed": failed,
            "reasons": dict(reasons[:SHOWN]),
            "undefined": {name: count for name, count in undefined.items() if count},
            "effects": effects,
            "ranges": {
                name: dict(zip(("least", "mean", "most"), ends, strict=True)) for name, ends in ranges.items()
            },
        },
        tables=(
            Table(f"Swept: {_kind(design)}", ("key", "values", "from", "to", "unit"), swept),
            Table(
                f"Results at {done:,} points",
                ("quantity", "least", "mean", "most", "unit"),
                [(name, *map(_defined, ends), units[name]) for name, ends in ranges.items()],
            ),
        ),
        notes=(*effects, *_undefined(undefined, done), *_failures(failed, reasons), *notes),
    )


def report(sweep: Sweep, result: Result, *, picture: str | None) -> str:
    """`report.md`; `picture`: the file beside it, if there is one."""
    swept, found = (
        "\n".join(
            ["| " + " | ".join(table.columns) + " |", "|---" * len(table.columns) + "|"]
            + ["| " + " | ".join(row) + " |" for row in table.cells()]
        )
        for table in result.tables
    )
    names = list(result.values["ranges"])
    first = names[0] if names else DONE
    listed = "\n".join(f"- {note}" for note in result.notes)
    drawn = "" if picture is None else f"![what changes over the swept keys]({picture})\n\n"
    return f"""# Sweep of {sweep.base.name}

{_answer(sweep, result)}

{listed}

{drawn}{swept}

{found}

```python
import xarray as xr
sweep = xr.open_dataset("results.nc")  # or xr.open_zarr("results.zarr", consolidated=False)
sweep["{first}"].where(sweep["{DONE}"] == 1)
```"""


def _answer(sweep: Sweep, result: Result) -> str:
    """The outcome in words."""
    values = result.values
    design = sweep.points.design
    keys = ", ".join(f"`{axis.key}`" for axis in design.axes)
    words = f"{values['done']:,} of {values['points']:,} points of {keys} were computed"
    words += f"; {values['failed']:,} failed." if values["failed"] else ", none failed."
    ranges = values["ranges"]
    first = next((name for name in ranges if np.isfinite(ranges[name]["mean"])), None)
    if first is None:
        return words
    ends = ranges[first]
    return f"{words} Over them `{first}` goes from {cell(ends['least'])} to {cell(ends['most'])}."


def _kind(design: Design) -> str:
    if design.kind == "cartesian":
        return "every combination, " + " x ".join(map(str, design.shape))
    if design.kind == "zip":
        return "side by side"
    return f"{design.kind.title()} design, {design.count:,} points, seed {design.seed}"


def _count(axis: Axis) -> Any:
    return "any" if isinstance(axis.values, Between) else len(axis.values)


def _ends(axis: Axis) -> tuple[str, str]:
    """The least and the greatest number, or the first and the last name."""
    values = axis.values
    if isinstance(values, Between):
        return f"{values.low:g}", f"{values.high:g}"
    if values.numeric:
        numbers = values.numbers(np.arange(len(values)))
        return f"{numbers.min():g}", f"{numbers.max():g}"
    return values.spell(0), values.spell(len(values) - 1)


def _range(results: Results, name: str, done: int) -> tuple[tuple[float, float, float], int]:
    """Least, mean and most of what is finite, NaN where nothing is; and at how many done points a number is none."""
    least, most, total, count = np.inf, -np.inf, 0.0, 0
    array = results.array(name)
    for start, stop in results.spans():
        values = np.asarray(array[start:stop])
        values = values[np.isfinite(values)]
        if values.size:
            least, most = min(least, float(values.min())), max(most, float(values.max()))
            total, count = total + float(values.sum()), count + values.size
    missing = done - count if array.ndim == 1 and array.attrs.get("comment") == UNDEFINED else 0
    return ((least, total / count, most) if count else (np.nan, np.nan, np.nan)), missing


def _defined(number: float) -> float | str:
    return "undefined" if np.isnan(number) else number


def _undefined(counts: dict[str, int], done: int) -> list[str]:
    return [
        f"`{name}` is undefined at {'all' if count == done else f'{count:,} of the'} {done:,} points (NaN)."
        for name, count in counts.items()
        if count
    ]


def _failures(failed: int, reasons: list[tuple[str, int]]) -> list[str]:
    if not failed:
        return []
    notes = [f"Points that failed (--retry-failed tries them again): {failed:,}."]
    notes += [f"{count:,} of them: {reason}" for reason, count in reasons[:SHOWN]]
    if len(reasons) > SHOWN:
        notes.append(f"and {len(reasons) - SHOWN:,} other reasons: the variable `reason` has them all.")
    return notes
