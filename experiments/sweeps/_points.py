"""The config of each point: a config file, the overrides of all points, and the design."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from .._registry import Experiment
from ..harness._errors import UserError
from ..harness._loading import CHOOSING, Loaded, called, resolve
from ..harness._messages import paths, sentence
from ._design import Axis, Design
from ._values import Between, Listed, Steps

TRIED = 64
"""So many points are tried before a sweep without a valid one is refused."""

CHECKED = 4096
"""So many values of an axis are checked before anything starts, among them the first and the last."""


@dataclass(frozen=True)
class Points:
    """All that makes the configs of a sweep's points; small, so that each task carries it.

    **Arguments:** `path`, `text`: the config file; `arguments`: key and value in the order of the command line,
    None where the key is swept; `output`: folder for runs; `experiments`: those that a config may name.
    """

    path: Path
    text: str
    arguments: tuple[tuple[str, str | None], ...]
    output: str | None
    design: Design
    experiments: tuple[Experiment, ...]

    def load(self, codes: Sequence[int | float]) -> Loaded:
        """The checked config of the point with these codes, one per axis.

        **Raises:** `UserError` if it is not valid.
        """
        swept = {
            axis.key: axis.values.spell(code) for axis, code in zip(self.design.axes, codes, strict=True)
        }
        overrides = [f"{key}={swept[key] if text is None else text}" for key, text in self.arguments]
        return resolve(self.path, self.text, overrides, output=self.output, experiments=self.experiments)

    def codes(self, number: int) -> list[Any]:
        """The codes of one point."""
        return [column[0].item() for column in self.design.codes(number, number + 1)]


def representative(points: Points) -> tuple[Loaded, list[Any]]:
    """A valid point and its codes: the first one, or the first valid one of some that lie all over the design.

    **Raises:** `UserError` with what is wrong with the first one if none is valid.
    """
    refused: UserError | None = None
    spread = np.linspace(0, points.design.count - 1, min(TRIED, points.design.count)).astype(int)
    for number in dict.fromkeys([*range(min(TRIED, points.design.count)), *spread.tolist()]):
        codes = points.codes(number)
        try:
            return points.load(codes), codes
        except UserError as error:
            refused = refused or error
    assert refused is not None
    raise refused


def check_values(points: Points, base: Loaded) -> frozenset[str]:
    """Check the swept values, each on its own, before anything starts.

    What only a combination makes wrong is found at its point.

    **Returns:** the files that the points read, as far as one key decides about them.

    **Raises:** `UserError` for a value that its key does not allow.
    """
    files = set(base.config.inputs())
    for axis in points.design.axes:
        if axis.key.rpartition(".")[2] in CHOOSING or axis.key == "experiment":
            continue
        for value in _values(axis):
            files.update(_check_value(axis.key, value, base))
    return frozenset(files)


def _values(axis: Axis) -> Iterator[Any]:
    """What to check of an axis: numbers lie between the first and the last."""
    match axis.values:
        case Between(low=low, high=high, whole=whole):
            yield from (int(low), int(high)) if whole else (low, high)
        case Listed(values=values):
            yield from (values[i] for i in _sample(len(values)))
        case Steps(whole=whole):
            for code in _sample(len(axis.values)):
                spelled = axis.values.spell(code)
                yield int(spelled) if whole else float(spelled)


def _sample(count: int) -> list[int]:
    if count <= CHECKED:
        return list(range(count))
    return np.unique(np.linspace(0, count - 1, CHECKED).astype(int)).tolist()


def _check_value(key: str, value: Any, base: Loaded) -> tuple[str, ...]:
    """The files that the config reads with this value; an error if the key itself does not allow it."""
    data: dict[str, Any] = base.config.model_dump(mode="json")
    *sections, name = key.split(".")
    inner: Any = data
    for section in sections:
        inner = inner.get(section) if isinstance(inner, dict) else None
    if not isinstance(inner, dict):
        return ()
    inner[name] = value
    model = base.experiment.config
    try:
        return model.model_validate_json(json.dumps(data)).inputs()
    except ValidationError as error:
        own = [problem for problem in error.errors() if _is_about(problem, key)]
        if own and key in {path for path, _ in paths(model)}:
            message = sentence(error, model, data, lambda _: "on the command line")
            raise UserError(
                f"{message} `jaxocean show {called(base.path)}` lists every key with its range."
            ) from None
    return ()


def _is_about(problem: Any, key: str) -> bool:
    """Whether the key's own range or type is violated, whatever stands at other keys."""
    if problem["type"] in ("config", "extra_forbidden", "missing"):
        return False
    names = [part for part in problem["loc"] if isinstance(part, str)]
    wanted = key.split(".")
    return bool(names) and wanted[0] == names[0] and wanted[-1] in names
