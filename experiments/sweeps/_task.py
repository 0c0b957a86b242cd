"""What a worker is given, and what it gives back: one chunk of points, computed as a whole."""

import logging
import time
from dataclasses import dataclass, field

import numpy as np

from .._registry import Experiment
from ..harness._cache import keep_compiled_programs
from ..harness._errors import UserError
from ..harness._execute import is_ours, one_line
from ..harness._quantity import Quantity
from ._points import Points

KINDS_DIFFER = "is a number at some points and a list at others: only one kind is kept."


@dataclass(frozen=True)
class Task:
    """The points `start` to `stop`, to be computed by one worker; `scratch`: a folder for what nobody keeps."""

    points: Points
    experiment: Experiment
    start: int
    stop: int
    scratch: str | None = None


@dataclass(frozen=True)
class Column:
    """One quantity at all points of a task, the points first; NaN where a point has none."""

    values: np.ndarray
    quantity: Quantity


@dataclass(frozen=True)
class Outcome:
    """What became of a task: columns by name, and for each point that failed, counted from `start`, why."""

    start: int
    stop: int
    columns: dict[str, Column]
    reasons: dict[int, str]
    seconds: float = 0.0
    notes: tuple[str, ...] = field(default=())


def compute(task: Task) -> Outcome:
    """Compute all points of a task, in whatever process this is; no point's failure gets out."""
    logging.getLogger("jax").setLevel(logging.WARNING)
    keep_compiled_programs()
    began = time.perf_counter()
    # Imported here: the command line does without JAX and matplotlib, and a worker without one of them.
    if task.experiment.config.varies():
        from . import _batch as way
    else:
        from . import _single as way
    columns, reasons, notes = way.compute(task)
    return Outcome(task.start, task.stop, columns, reasons, time.perf_counter() - began, notes)


def failure(task: Task, reason: str) -> Outcome:
    """The outcome of a task that no worker survived."""
    return Outcome(task.start, task.stop, {}, dict.fromkeys(range(task.stop - task.start), reason))


def reason_of(error: Exception) -> str:
    """Why a point failed, in one sentence."""
    # A store outlives the command line.
    said = one_line(error).replace(" on the command line", " at this point")
    return (
        said
        if isinstance(error, UserError) or is_ours(error)
        else f"{type(error).__name__}: {said} (unexpected)"
    )
