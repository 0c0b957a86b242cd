"""Which points a sweep visits: grids, zipped lists, random and Sobol designs, point by point without a list."""

import json
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..harness._errors import UserError
from ._values import Between, Values

Kind = Literal["cartesian", "zip", "sobol", "random"]
KINDS: tuple[Kind, ...] = ("cartesian", "zip", "sobol", "random")
MOST = 10**9
BLOCK = 4096
"""Random points are drawn in blocks of this size, so that any of them can be drawn alone."""

Codes = list[np.ndarray]
"""For each axis the places of the points' values in its list, or, for an interval, the values themselves."""


@dataclass(frozen=True)
class Axis:
    """A key that is swept, and its values."""

    key: str
    values: Values


@dataclass(frozen=True)
class Design:
    """The points of a sweep, numbered from 0.

    **Arguments:** `kind`; `axes`: in a cartesian design the last one runs fastest; `count`: number of points;
    `seed`: of random and Sobol designs.
    """

    kind: Kind
    axes: tuple[Axis, ...]
    count: int
    seed: int = 0

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes of a cartesian design."""
        return tuple(_length(axis) for axis in self.axes)

    def codes(self, start: int, stop: int) -> Codes:
        """The points `start` to `stop`, without those before them."""
        if self.kind == "zip":
            return [np.arange(start, stop) for _ in self.axes]
        if self.kind == "cartesian":
            return list(np.unravel_index(np.arange(start, stop), self.shape))
        uniform = self._sobol(start, stop) if self.kind == "sobol" else self._random(start, stop)
        return [_drawn(axis, uniform[:, i]) for i, axis in enumerate(self.axes)]

    def _sobol(self, start: int, stop: int) -> np.ndarray:
        from scipy.stats import qmc

        sequence = qmc.Sobol(len(self.axes), scramble=True, rng=self.seed)
        if start > 0:
            sequence.fast_forward(start)
        with warnings.catch_warnings():
            # It is balanced at powers of two, which a block of points need not be: the whole design counts.
            warnings.simplefilter("ignore", UserWarning)
            return sequence.random(stop - start)

    def _random(self, start: int, stop: int) -> np.ndarray:
        blocks = range(start // BLOCK, -(-stop // BLOCK))
        drawn = [
            np.random.default_rng([self.seed, block]).random((BLOCK, len(self.axes))) for block in blocks
        ]
        first = blocks.start * BLOCK
        return np.concatenate(drawn)[start - first : stop - first]

    def canonical(self) -> dict[str, Any]:
        """The same for all ways of writing this design."""
        drawn = {"seed": self.seed, "points": self.count} if self.kind in ("sobol", "random") else {}
        return {
            "kind": self.kind,
            "axes": [{"key": axis.key, "values": axis.values.canonical()} for axis in self.axes],
            **drawn,
        }


def build(kind: Kind, axes: Sequence[Axis], *, points: int | None, seed: int) -> Design:
    """A checked design.

    **Raises:** `UserError` for a design without points, with points twice, or with values that do not fit its kind.
    """
    drawn = kind in ("sobol", "random")
    if not axes:
        example = "wind.speed=4:24" if drawn else "wind.speed=4:24:2"
        raise UserError(f"Nothing is swept: give at least one key several values, for example {example}.")
    if drawn and (points is None or points < 1):
        given = "none is given" if points is None else f"it is {points}"
        raise UserError(
            f"A {kind} design needs a number of points: --points must be at least 1, but {given}."
        )
    if not drawn and points is not None:
        raise UserError("The option --points belongs to a design that draws: add --design sobol or random.")
    if drawn and not any(isinstance(axis.values, Between) for axis in axes):
        raise UserError(
            f"A {kind} design needs at least one interval to draw from, for example wind.speed=4:24."
        )
    for axis in axes:
        if isinstance(axis.values, Between) and not drawn:
            raise UserError(
                f"The values of `{axis.key}` must read start:stop:step or be a list; "
                "an interval start:stop is for --design sobol or random."
            )
    if kind != "zip":
        for axis in axes:
            _check_values_differ(axis)
    axes = tuple(Axis(axis.key, axis.values.sorted()) if kind == "cartesian" else axis for axis in axes)
    if kind == "zip":
        count = _check_zipped(axes)
    elif kind == "cartesian":
        count = int(np.prod([_length(axis) for axis in axes], dtype=object))
    else:
        assert points is not None
        count = points
    if count > MOST:
        raise UserError(f"The sweep has {count:,} points, more than a billion: take fewer values.")
    return Design(kind, tuple(axes), count, seed if drawn else 0)


def _check_values_differ(axis: Axis) -> None:
    if isinstance(axis.values, Between):
        return
    seen: set[str] = set()
    values = axis.values.canonical()
    for value in values if isinstance(values, list) else ():
        text = json.dumps(value)
        if text in seen:
            raise UserError(f"The values of `{axis.key}` must differ, but {text} is there twice.")
        seen.add(text)


def _check_zipped(axes: Sequence[Axis]) -> int:
    lengths = {axis.key: _length(axis) for axis in axes}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"`{key}` has {length}" for key, length in lengths.items())
        raise UserError(f"With --zip all keys must have equally many values, but {told}.")
    count = next(iter(lengths.values()))
    columns = [axis.values.canonical() for axis in axes]
    if not all(isinstance(column, list) for column in columns):
        return count  # a range has no value twice
    seen: dict[str, int] = {}
    for number, point in enumerate(zip(*columns, strict=True)):
        text = json.dumps(point)
        if text in seen:
            where = ", ".join(f"{a.key}={a.values.spell(number)}" for a in axes)
            places = f"places {seen[text] + 1} and {number + 1}"
            raise UserError(f"The points must differ, but {where} is there twice ({places}).")
        seen[text] = number
    return count


def _length(axis: Axis) -> int:
    assert not isinstance(axis.values, Between)
    return len(axis.values)


def _drawn(axis: Axis, uniform: np.ndarray) -> np.ndarray:
    if isinstance(axis.values, Between):
        return axis.values.draw(uniform)
    return np.minimum((uniform * len(axis.values)).astype(int), len(axis.values) - 1)
