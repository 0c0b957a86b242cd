"""From a command line to a checked sweep: its points, a config that stands for them, its identity, its folder."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .._registry import EXPERIMENTS, Experiment
from ..harness._errors import UserError
from ..harness._loading import Loaded, locate, read_text
from ..harness._store import digests, run_folder
from ..harness._version import version
from ._design import Axis, Kind, build
from ._points import Points, check_values, representative
from ._values import Between, parse


@dataclass(frozen=True)
class Sweep:
    """A checked sweep.

    **Arguments:** `points`; `base`: the config of its first valid point; `digest`: SHA-256 of all that decides its
    outcome; `folder`: where its store lies.
    """

    points: Points
    base: Loaded
    digest: str
    folder: Path


def plan(
    config: str,
    arguments: Sequence[str],
    *,
    kind: Kind = "cartesian",
    points: int | None = None,
    output: str | None = None,
    experiments: Sequence[Experiment] = EXPERIMENTS,
) -> Sweep:
    """Read a config and what is swept, and check as much as can be checked without visiting every point.

    **Arguments:** `config`: a name or a path; `arguments`: `key=4:24:2`, `key=1,2,5`, `key=low:high` (designs that
    draw), or plain overrides `key=value`; `kind`; `points`: of designs that draw; `output`: folder for sweeps;
    `experiments`: those that a config may name.

    **Raises:** `UserError` for whatever is wrong with it.
    """
    path = locate(config)
    text = read_text(path)
    parsed = [_parsed(argument) for argument in arguments]
    names = [key for key, _, _ in parsed]
    for key in names:
        if names.count(key) > 1:
            raise UserError(
                f"The key `{key}` is given {names.count(key)} times: put all its values into one list."
            )
    axes = [Axis(key, values) for key, _, values in parsed if values is not None]
    if any(axis.key in ("experiment", "output") for axis in axes):
        raise UserError(
            "The keys `experiment` and `output` cannot be swept: they are the same for all points."
        )
    drawn = build(kind, axes, points=points, seed=0)
    fixed = tuple((key, None if values is not None else value) for key, value, values in parsed)
    first = Points(path, text, fixed, output, drawn, tuple(experiments))
    # The seed of the design, and whether a key holds whole numbers, are known when a point has been read.
    base, _ = representative(first)
    design = build(kind, [_settled(axis, base) for axis in axes], points=points, seed=base.config.seed)
    all_points = Points(path, text, fixed, output, design, tuple(experiments))
    base, _ = representative(all_points)
    files = check_values(all_points, base)
    digest = _identity(all_points, base, files)
    return Sweep(all_points, base, digest, _folder(base, digest))


def _parsed(argument: str):
    """Key, text, and the values if it is swept."""
    key, equals, value = argument.partition("=")
    key = key.strip()
    if not equals or not key:
        raise UserError(
            f"The argument `{argument}` must read key.path=values, for example wind.speed=4:24:2 or threshold=0.2,0.4."
        )
    return key, value, parse(key, value.strip())


def _settled(axis: Axis, base: Loaded) -> Axis:
    """An interval of whole numbers draws whole numbers only where its key holds such."""
    if not isinstance(axis.values, Between):
        return axis
    value: Any = base.config
    for name in axis.key.split("."):
        value = getattr(value, name, None)
    return Axis(axis.key, replace(axis.values, whole=axis.values.whole and isinstance(value, int)))


def _identity(points: Points, base: Loaded, files: frozenset[str]) -> str:
    config = base.config.identity()
    content = {
        "experiment": base.experiment.name,
        "config": config,
        "design": points.design.canonical(),
        "inputs": digests(sorted(files)),
        "version": version(),
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _folder(base: Loaded, digest: str) -> Path:
    """`<output>/<config>-sweep-<hash8>`."""
    plain = run_folder(base, digest)
    return plain.with_name(f"{plain.name.removesuffix(f'-{digest[:8]}')}-sweep-{digest[:8]}")
