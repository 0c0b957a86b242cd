"""Points one after another: each is a run of its own, of which only the numbers are kept."""

import re
import tempfile
import threading
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from ..harness._execute import collect_warnings
from ..harness._files import Files
from ..harness._loading import Loaded
from ..harness._progress import Silent
from ..harness._quantity import Quantity, unit_of_name
from ..harness._result import jsonable
from ._task import KINDS_DIFFER, Column, Task, reason_of

ONE_AT_A_TIME = threading.Lock()
"""Pictures and warnings belong to the process: a cluster's threads take turns."""


class _Scratch(Files):
    """Files that live as long as the run; pictures are not even made."""

    def picture(self, name: str, figure: Figure) -> None:
        del name
        plt.close(figure)


def compute(task: Task) -> tuple[dict[str, Column], dict[int, str], tuple[str, ...]]:
    """Columns of all numbers that the runs' results have, and why points failed."""
    count = task.stop - task.start
    codes = task.points.design.codes(task.start, task.stop)
    found: list[dict[str, np.ndarray]] = []
    reasons: dict[int, str] = {}
    for i in range(count):
        numbers: dict[str, np.ndarray] = {}
        try:
            with ONE_AT_A_TIME:
                numbers = _run(task.points.load([column[i].item() for column in codes]), task.scratch)
        except Exception as error:  # whatever it is, the other points go on
            reasons[i] = reason_of(error)
        found.append(numbers)
    columns, notes = _columns(found)
    return columns, reasons, notes


def _run(loaded: Loaded, scratch: str | None) -> dict[str, np.ndarray]:
    run = loaded.experiment.load()
    if scratch is not None and not Path(scratch).is_dir():
        scratch = None  # another machine
    with tempfile.TemporaryDirectory(prefix="point-", dir=scratch) as folder, warnings.catch_warnings():
        collect_warnings()
        result = run(loaded.config, Silent(), _Scratch(Path(folder), loaded))
    return dict(_flat(jsonable(result.values)))


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, np.ndarray]]:
    """Every number, and every list of numbers of one shape, by its dotted name; texts and nulls are left out."""
    if isinstance(value, Mapping):
        for name, part in value.items():
            yield from _flat(part, f"{path}.{name}" if path else name)
    elif isinstance(value, (bool, int, float)):
        yield path, np.asarray(float(value))
    elif isinstance(value, list) and value and all(isinstance(part, Mapping) for part in value):
        for name in value[0]:
            yield from _flat([part.get(name) for part in value], f"{path}.{name}")
    elif isinstance(value, list):
        try:
            # None becomes NaN; a text, or rows of different lengths, are refused.
            array = np.asarray(value, float)
        except (TypeError, ValueError):
            return
        if array.size:
            yield path, array


def _columns(found: Sequence[Mapping[str, np.ndarray]]) -> tuple[dict[str, Column], tuple[str, ...]]:
    """The numbers of all points by name; lists of several lengths are filled up with NaN."""
    together: dict[str, dict[int, np.ndarray]] = {}
    for i, numbers in enumerate(found):
        for path, values in numbers.items():
            together.setdefault(path, {})[i] = values
    columns: dict[str, Column] = {}
    notes: list[str] = []
    for path, at in together.items():
        # A number at some points and a list at others: the lists are kept.
        dimensions = max(values.ndim for values in at.values())
        kept = {i: values for i, values in at.items() if values.ndim == dimensions}
        shape = tuple(np.max([values.shape for values in kept.values()], axis=0).astype(int).tolist())
        filled = np.full((len(found), *shape), np.nan)
        for i, values in kept.items():
            filled[(i, *map(slice, values.shape))] = values
        name, quantity = _name(path), Quantity(unit_of_name(_name(path)), path, may_be_undefined=True)
        while name in columns:
            name += "_"  # two paths that differ in punctuation only
        columns[name] = Column(filled, quantity)
        if len(kept) < len(at):
            notes.append(f"`{_name(path)}` {KINDS_DIFFER}")
    return columns, tuple(notes)


def _name(path: str) -> str:
    """A dotted name as CF allows it: letters, digits and underscores, a letter first."""
    name = re.sub(r"[^A-Za-z0-9]+", "_", path).strip("_")
    return name if name[:1].isalpha() else f"value_{name}"
