"""The store of a sweep: a zarr group in which chunks of points appear as wholes."""

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from ..harness._errors import UserError
from ..harness._loading import Loaded
from ..harness._messages import paths
from ..harness._quantity import CONVENTIONS, Quantity, udunits
from ..harness._version import version
from ._design import Axis, Codes, Design
from ._task import KINDS_DIFFER, Column, Outcome

STANDARD_NAMES = {"wind.speed": "wind_speed"}
"""CF's names of keys that are swept."""

DONE, REASON = "done", "reason"
QUANTITIES = "quantities"
"""Attribute of the store: the names of what points have, in order."""


def variable_name(key: str) -> str:
    """The name of a swept key in the store."""
    return key.replace(".", "_")


def coordinate(axis: Axis, loaded: Loaded) -> Quantity:
    """Unit and name of a swept key, as the config has them."""
    for path, field in paths(loaded.experiment.config):
        if path == axis.key:
            extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
            unit = str(extra.get("unit", "")) if axis.values.numeric else ""
            return Quantity(udunits(unit), field.description or path, STANDARD_NAMES.get(path))
    return Quantity("1", axis.key)


def labels(axis: Axis, codes: np.ndarray) -> np.ndarray:
    """The swept values as numbers if they all are, else as texts."""
    if axis.values.numeric:
        return axis.values.numbers(codes)
    return np.asarray([axis.values.spell(code) for code in codes.tolist()], dtype=np.dtypes.StringDType())


def create(folder: Path, design: Design, loaded: Loaded, chunk: int) -> None:
    """An empty store: the coordinates of all points, and none of them done."""
    group = zarr.create_group(
        folder,
        zarr_format=3,
        attributes={
            "Conventions": CONVENTIONS,
            "title": f"Sweep of {loaded.name}: {loaded.config.title or loaded.experiment.summary}",
            "source": f"jaxocean {version()}, experiment {loaded.experiment.name}",
            "history": f"written by jaxocean sweep {loaded.name}",
        },
    )
    made = [
        group.create_array(
            variable_name(axis.key),
            shape=(design.count,),
            chunks=(chunk,),
            dtype="f8" if axis.values.numeric else str,
            fill_value=np.nan if axis.values.numeric else "",
            dimension_names=["point"],
            attributes={**_coordinate_attributes(axis, loaded), "config_key": axis.key},
        )
        for axis in design.axes
    ]
    for start in range(0, design.count, chunk):
        stop = min(start + chunk, design.count)
        codes: Codes = design.codes(start, stop)
        for axis, array, column in zip(design.axes, made, codes, strict=True):
            array[start:stop] = labels(axis, column)
    flag = {"flag_values": [0, 1], "flag_meanings": "not_done done"}
    options: Any = {"shape": (design.count,), "chunks": (chunk,), "dimension_names": ["point"]}
    names = " ".join(array.basename for array in made)
    group.create_array(
        DONE,
        dtype="i1",
        fill_value=0,
        attributes={"long_name": "whether the point has been computed", **flag, "coordinates": names},
        **options,
    )
    group.create_array(
        REASON,
        dtype=str,
        fill_value="",
        attributes={"long_name": "why the point could not be computed", "coordinates": names},
        **options,
    )


def _coordinate_attributes(axis: Axis, loaded: Loaded) -> dict[str, str]:
    attributes = coordinate(axis, loaded).attributes()
    if not axis.values.numeric:
        del attributes["units"]
    return attributes


class Results:
    """A store that is open for writing. A point is done when its flag says so, which is written last.

    **Raises:** `UserError` if there is no store in the folder, or it has been damaged.
    """

    def __init__(self, folder: Path) -> None:
        try:
            self._group = zarr.open_group(folder, mode="r+", use_consolidated=False)
            self._done, self._reason = self.array(DONE), self.array(REASON)
        except (OSError, KeyError, ValueError, json.JSONDecodeError) as error:
            raise UserError(
                f"The store {folder} cannot be read ({type(error).__name__}): --force starts the sweep anew."
            ) from error
        self.count: int = self._done.shape[0]
        self.chunk: int = self._done.chunks[0]
        # In the order in which they came: a folder has none.
        self._arrays = {name: self.array(name) for name in str(self._group.attrs.get(QUANTITIES, "")).split()}
        self._coordinates = str(self._done.attrs["coordinates"])

    def array(self, name: str) -> zarr.Array:
        """An array of the store."""
        array = self._group[name]
        assert isinstance(array, zarr.Array)
        return array

    def names(self) -> list[str]:
        """The quantities that points have."""
        return list(self._arrays)

    def coordinates(self) -> list[str]:
        """The names of the swept keys."""
        return self._coordinates.split()

    def attributes(self) -> dict[str, Any]:
        """What is said of the store as a whole."""
        return {name: value for name, value in self._group.attrs.items() if name != QUANTITIES}

    def spans(self) -> Iterator[tuple[int, int]]:
        """Start and stop of each chunk."""
        for start in range(0, self.count, self.chunk):
            yield start, min(start + self.chunk, self.count)

    def state(self, start: int, stop: int) -> tuple[np.ndarray, np.ndarray]:
        """Which points of a chunk are done, and which failed."""
        done = np.asarray(self._done[start:stop], bool)
        failed = np.zeros_like(done)
        if not done.all():
            failed = ~done & (np.asarray(self._reason[start:stop]).astype(object) != "")
        return done, failed

    def unfinished(self, *, retry_failed: bool) -> Iterator[tuple[int, int]]:
        """Runs of neighbouring points, each inside one chunk, that are to be computed."""
        for start, stop in self.spans():
            done, failed = self.state(start, stop)
            wanted = ~done if retry_failed else ~done & ~failed
            edges = np.flatnonzero(np.diff(np.concatenate([[False], wanted, [False]]).astype(int)))
            for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
                yield start + first, start + last

    def tally(self) -> tuple[int, int]:
        """How many points are done, and how many failed."""
        done = failed = 0
        for span in self.spans():
            is_done, is_failed = self.state(*span)
            done, failed = done + int(is_done.sum()), failed + int(is_failed.sum())
        return done, failed

    def reasons(self) -> Counter[str]:
        """How often each reason of a failure occurs."""
        counted: Counter[str] = Counter()
        for start, stop in self.spans():
            _, failed = self.state(start, stop)
            if failed.any():
                counted.update(map(str, np.asarray(self._reason[start:stop]).astype(object)[failed]))
        return counted

    def write(self, outcome: Outcome, *, clear: bool) -> tuple[str, ...]:
        """Write what became of a task: numbers first, the flag last, so that a half-written task is not done.

        **Arguments:** `outcome`; `clear`: whether reasons of earlier failures may stand there.

        **Returns:** notes on what could not be kept.
        """
        notes = outcome.notes
        where = slice(outcome.start, outcome.stop)
        for name, column in outcome.columns.items():
            array = self._arrays.get(self._free(name)) or self._create(name, column)
            inner = column.values.shape[1:]
            if len(inner) != array.ndim - 1:
                notes += (f"`{name}` {KINDS_DIFFER}",)
                continue
            if any(mine > there for mine, there in zip(inner, array.shape[1:], strict=True)):
                # Lists of several lengths end in NaN, whichever comes first.
                array.resize((self.count, *map(max, inner, array.shape[1:])))
            array[(where, *map(slice, inner))] = column.values
        reasons = np.full(outcome.stop - outcome.start, "", dtype=np.dtypes.StringDType())
        for place, reason in outcome.reasons.items():
            reasons[place] = reason
        if outcome.reasons or clear:
            self._reason[where] = reasons
        self._done[where] = (reasons == "").astype("i1")
        return notes

    def _free(self, name: str) -> str:
        """A name that no coordinate has."""
        return f"result_{name}" if name in (*self.coordinates(), DONE, REASON) else name

    def _create(self, name: str, column: Column) -> zarr.Array:
        name, inner = self._free(name), column.values.shape[1:]
        array = self._group.create_array(
            name,
            shape=(self.count, *inner),
            chunks=(self.chunk, *inner),
            dtype="f8",
            fill_value=np.nan,
            dimension_names=["point", *(f"{name}_{i}" for i in range(len(inner)))],
            attributes={**column.quantity.attributes(), "coordinates": self._coordinates},
            overwrite=True,
        )
        self._arrays[name] = array
        self._group.attrs[QUANTITIES] = " ".join(self._arrays)
        return array
