"""Points of one shape at once: a vmapped program for each shape, compiled once per process."""

import functools
import importlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import jax
import numpy as np
from pydantic import BaseModel, ValidationError

from ..harness._messages import sentence
from ..schema import ExperimentConfig
from ._design import Axis, Codes
from ._task import Column, Task, reason_of
from ._values import Between, Listed, Steps, is_number

BATCH = 512
"""Points of one call: large enough to be rid of overheads, small enough for the caches."""


def compute(task: Task) -> tuple[dict[str, Column], dict[int, str], tuple[str, ...]]:
    """Columns of all quantities that the experiment's module declares, and why points failed."""
    module = importlib.import_module(task.experiment.module)
    count = task.stop - task.start
    columns = {name: Column(np.full(count, np.nan), quantity) for name, quantity in module.QUANTITIES.items()}
    reasons: dict[int, str] = {}
    codes = task.points.design.codes(task.start, task.stop)
    for where in _groups(task, codes):
        try:
            group = _Group.of(task, codes, where)
            refused = group.refused()
            reasons |= {int(where[i]): reason for i, reason in refused.items()}
            keep = np.setdiff1d(np.arange(where.size), list(refused))
            measured = group.measure(keep)
        except Exception as error:  # whatever it is, the other points go on
            reasons |= dict.fromkeys(where.tolist(), reason_of(error))
            continue
        for name, values in measured.items():
            columns[name].values[where[keep]] = values
    _refuse_undefined(columns, reasons)
    return columns, reasons, ()


def _refuse_undefined(columns: dict[str, Column], reasons: dict[int, str]) -> None:
    """A number that must be one and is not fails its point."""
    for name, column in columns.items():
        if column.quantity.may_be_undefined:
            continue
        for i in np.flatnonzero(~np.isfinite(column.values)).tolist():
            reasons.setdefault(i, f"The number `{name}` came out as {column.values[i]}.")
    for column in columns.values():
        column.values[list(reasons)] = np.nan


def _groups(task: Task, codes: Codes) -> Iterator[np.ndarray]:
    """Places of points that differ only in numbers that a compiled program takes as arguments."""
    varies = task.experiment.config.varies()
    label = np.zeros(task.stop - task.start, int)
    for axis, column in zip(task.points.design.axes, codes, strict=True):
        kinds = _kinds(axis, column, varies)
        if kinds is not None:
            label = np.unique(label * (kinds.max() + 1) + kinds, return_inverse=True)[1]
    if not label.any():
        yield np.arange(label.size)
        return
    order = np.argsort(label, kind="stable")
    yield from np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def _kinds(axis: Axis, codes: np.ndarray, varies: frozenset[str]) -> np.ndarray | None:
    """A number for each point, equal where the key's value has one kind; None where all have."""
    traced = axis.key in varies
    if isinstance(axis.values, Steps | Between) and traced:
        return None
    present, kinds = np.unique(codes, return_inverse=True)
    if isinstance(axis.values, Listed) and traced:
        names = [_kind(axis.values.values[code]) for code in present]
        kinds = np.unique(names, return_inverse=True)[1][kinds]
    return kinds


def _kind(value: Any) -> str:
    """Values of one kind are arguments of one program: numbers, or lists of equally many numbers."""
    if is_number(value):
        return "number"
    if isinstance(value, list) and value and all(map(is_number, value)):
        return f"list of {len(value)}"
    return json.dumps(value)


@dataclass(frozen=True)
class _Group:
    """Points of one shape: the config of the first, and the numbers in which they differ."""

    task: Task
    config: ExperimentConfig
    numbers: dict[str, np.ndarray]

    @classmethod
    def of(cls, task: Task, codes: Codes, where: np.ndarray) -> "_Group":
        loaded = task.points.load([column[where[0]].item() for column in codes])
        varies = task.experiment.config.varies()
        numbers = {
            axis.key: values
            for axis, column in zip(task.points.design.axes, codes, strict=True)
            if axis.key in varies and (values := _numbers(axis, column[where])) is not None
        }
        return cls(task, loaded.config, numbers)

    def refused(self) -> dict[int, str]:
        """The points whose numbers are out of range, found by their extremes where there are none."""
        if not self.numbers:
            return {}
        ends = [
            {key: end(values, axis=0) for key, values in self.numbers.items()} for end in (np.min, np.max)
        ]
        if all(self._problem(end) is None for end in ends):
            return {}
        count = len(next(iter(self.numbers.values())))
        points = ({key: values[i] for key, values in self.numbers.items()} for i in range(count))
        return {i: problem for i, point in enumerate(points) if (problem := self._problem(point)) is not None}

    def _problem(self, numbers: Mapping[str, np.ndarray]) -> str | None:
        data = self.config.model_dump(mode="json")
        for key, value in numbers.items():
            *sections, name = key.split(".")
            functools.reduce(dict.__getitem__, sections, data)[name] = value.tolist()
        try:
            type(self.config).model_validate_json(json.dumps(data))
        except ValidationError as error:
            return sentence(error, type(self.config), data, lambda _: "at this point")
        return None

    def measure(self, keep: np.ndarray) -> dict[str, np.ndarray]:
        """The quantities at some of the points, in batches of one size: the last is filled up."""
        names = tuple(self.numbers)
        fixed = with_numbers(self.config, dict.fromkeys(names)).model_dump_json(warnings=False)
        program = _program(_Shape(self.task.experiment.module, fixed, names, self.config))
        with jax.enable_x64(True):
            found = []
            for start in range(0, keep.size, BATCH):
                batch = keep[np.minimum(np.arange(start, start + BATCH), keep.size - 1)]
                found.append(program({name: values[batch] for name, values in self.numbers.items()}))
            quantities = list(found[0]) if found else []
            return {name: np.concatenate([each[name] for each in found])[: keep.size] for name in quantities}


def _numbers(axis: Axis, codes: np.ndarray) -> np.ndarray | None:
    """The values of points of one kind as an array, or None if they are no numbers."""
    if isinstance(axis.values, Listed):
        values = axis.values.values
        if _kind(values[int(codes[0])]) != "number" and not isinstance(values[int(codes[0])], list):
            return None
        return np.asarray([values[code] for code in codes.tolist()], float)
    return axis.values.numbers(codes)


@dataclass(frozen=True)
class _Shape:
    """What decides about a compiled program; `config` is one of the configs that share it."""

    module: str
    fixed: str
    names: Sequence[str]
    config: ExperimentConfig = field(compare=False)


@functools.lru_cache(maxsize=256)
def _program(shape: _Shape) -> Callable[[dict[str, Any]], Mapping[str, Any]]:
    measure = importlib.import_module(shape.module).measure

    def one(numbers: dict[str, jax.Array]) -> dict[str, jax.Array]:
        return measure(with_numbers(shape.config, numbers))

    if shape.names:
        return jax.jit(jax.vmap(one))
    # Nothing differs: one point stands for all.
    alone = jax.jit(one)
    return lambda _: {name: np.full(BATCH, value) for name, value in alone({}).items()}


def with_numbers(config: Any, numbers: Mapping[str, Any]) -> Any:
    """A copy of a config with other values, traced ones too, at some dotted keys; nothing is checked."""
    here: dict[str, Any] = {}
    inside: dict[str, dict[str, Any]] = {}
    for key, value in numbers.items():
        head, _, rest = key.partition(".")
        if rest:
            inside.setdefault(head, {})[rest] = value
        else:
            here[head] = value
    sections: dict[str, BaseModel] = {
        head: with_numbers(getattr(config, head), values) for head, values in inside.items()
    }
    return config.model_copy(update=here | sections)
