"""One picture of a sweep: lines over one or two keys, scattered points over more; large sweeps are thinned."""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ..common import _plots
from ..harness._files import Files
from ..harness._loading import Loaded
from ..harness._quantity import shown
from ._design import Axis, Design
from ._effects import length, picked, swept_numbers
from ._results import Results, coordinate

ALONG, LINES, SCATTERED = 400, 7, 2000
"""At most so many points on a line, lines, and scattered points are drawn."""

TOGETHER = 5
"""So many results of one kind share a picture over one key."""


def draw(design: Design, loaded: Loaded, results: Results, names: Sequence[str], store: Files) -> None:
    """Write `sweep.png`; `names`: the results that are drawn, at least one."""
    draw_one = {1: _kind_over_one_key, 2: _over_two_keys if design.kind == "cartesian" else None}
    lines = draw_one.get(len(design.axes))
    title = f"Sweep of {loaded.name}: {design.count:,} points"
    if lines is not None:
        columns = min(2, len(names))
        rows = -(-len(names) // columns)
        size = (1.0 + 4.9 * columns, 0.5 + 3.9 * rows)
        with _plots.figure(rows, columns, size=size, title=title, squeeze=False) as (fig, axes):
            for place, panel in enumerate(axes.flat):
                if place < len(names):
                    lines(panel, design, loaded, results, names[place])
                else:
                    panel.set_axis_off()
            store.picture("sweep", fig)
        return
    swept = design.axes[:4]
    size = (1.0 + 3.3 * len(swept), 0.5 + 3.0 * len(names))
    options: Any = {"sharey": "row", "sharex": "col", "squeeze": False}
    with _plots.figure(len(names), len(swept), size=size, title=title, **options) as (fig, axes):
        where = np.unique(np.linspace(0, design.count - 1, min(SCATTERED, design.count)).astype(int))
        for row, name in zip(axes, names, strict=True):
            values = picked(results, name, where)
            for panel, axis in zip(row, swept, strict=True):
                panel.plot(
                    swept_numbers(results, axis, where), values, ".", color=_plots.BLUE, ms=4, alpha=0.5
                )
                _abscissa(panel, axis, loaded)
                panel.label_outer()
            _ordinate(row[0], _label(results, name), values)
        store.picture("sweep", fig)


def _kind_over_one_key(panel: Axes, design: Design, loaded: Loaded, results: Results, name: str) -> None:
    """A result, and those of its kind that change too, over the only key."""
    (axis,) = design.axes
    places = _thin(design.count, ALONG)
    kind = [each for each in results.names() if each.partition("_")[0] == name.partition("_")[0]]
    x = swept_numbers(results, axis, places)
    order = np.argsort(x, kind="stable")
    alike = [each for each in kind if each == name or _alike(results, each, name)][:TOGETHER]
    values = {each: picked(results, each, places)[order] for each in alike}
    drawn = {each: y for each, y in values.items() if each == name or _varies(y)}
    for each, y in drawn.items():
        _line(panel, axis, x[order], y, label=_wrapped(_words(results, each), 34))
    if len(drawn) > 1:
        panel.legend()
    _ordinate(panel, _label(results, name, alone=len(drawn) == 1), np.concatenate(list(drawn.values())))
    _abscissa(panel, axis, loaded)


def _over_two_keys(panel: Axes, design: Design, loaded: Loaded, results: Results, name: str) -> None:
    """A result over the key with the most numbers; a line for each value of the other one, if they differ."""
    across = max((0, 1), key=lambda i: (design.axes[i].values.numeric, design.shape[i]))
    axis, other = design.axes[across], design.axes[1 - across]
    places, lines = _thin(design.shape[across], ALONG), _thin(design.shape[1 - across], LINES)
    rows = []
    for line in lines.tolist():
        fixed = np.full_like(places, line)
        codes = (places, fixed) if across == 0 else (fixed, places)
        rows.append(picked(results, name, np.ravel_multi_index(codes, design.shape)))
    x = axis.values.numbers(places) if axis.values.numeric else places.astype(float)
    same = all(np.allclose(row, rows[0], rtol=1e-9, atol=0, equal_nan=True) for row in rows)
    colours = _plots.colours_for(len(lines)) if other.values.numeric else [None] * len(lines)
    for line, row, colour in zip(lines.tolist(), rows[:1] if same else rows, colours, strict=False):
        _line(panel, axis, x, row, label=other.values.spell(line), color=colour)
    unit = shown(coordinate(other, loaded).units)
    heading = other.key + ("" if unit == "-" else f" ({unit})")
    if same:
        panel.set_title(f"the same for every {heading}", fontsize=9, fontweight="normal")
    else:
        panel.legend(title=heading, title_fontsize=9)
    _ordinate(panel, _label(results, name), np.concatenate(rows))
    _abscissa(panel, axis, loaded)


def _varies(values: np.ndarray) -> bool:
    known = values[np.isfinite(values)]
    return bool(known.size) and float(np.ptp(known)) > 0


def _alike(results: Results, name: str, other: str) -> bool:
    """Whether two results of one kind belong on one axis: single numbers of the same unit."""
    one, two = results.array(name), results.array(other)
    return one.ndim == 1 and one.attrs["units"] == two.attrs["units"]


def _line(
    panel: Axes, axis: Axis, x: np.ndarray, values: np.ndarray, *, label: str, color: Any = None
) -> None:
    style = ("o-" if x.size <= 40 else "-") if axis.values.numeric else "o"
    panel.plot(x, values, style, ms=4, label=label, color=color)


def _thin(count: int, most: int) -> np.ndarray:
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(int))


def _abscissa(panel: Axes, axis: Axis, loaded: Loaded) -> None:
    if axis.values.numeric:
        panel.set_xlabel(f"{axis.key} ({shown(coordinate(axis, loaded).units)})")
        return
    panel.set_xlabel(axis.key)
    count = length(axis)
    codes = _thin(count, 8)
    names = [axis.values.spell(int(code)) for code in codes]
    panel.set_xticks(codes, names, rotation=0 if max(map(len, names)) < 8 else 30, fontsize=8)


def _ordinate(panel: Axes, label: str, values: np.ndarray) -> None:
    panel.set_ylabel(_wrapped(label, 42))
    known = values[np.isfinite(values)]
    if known.size and known.min() > 0 and known.max() > 30 * known.min():
        panel.set_yscale("log")


def _words(results: Results, name: str) -> str:
    return str(results.array(name).attrs["long_name"])


def _label(results: Results, name: str, *, alone: bool = True) -> str:
    """A result with its unit; where several share an axis, what their names have in common."""
    unit = shown(str(results.array(name).attrs["units"]))
    return f"{_words(results, name) if alone else name.partition('_')[0]} ({unit})"


def _wrapped(text: str, width: int) -> str:
    return "\n".join(textwrap.wrap(text, width))
