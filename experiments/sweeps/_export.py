"""From the store to one CF netCDF file, block by block, so that memory does not grow with the points.

Nothing is compressed here: the store is, and zlib would take a good part of the time of a large sweep.
"""

import errno
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from ..harness._loading import Loaded
from ._design import Design
from ._results import DONE, REASON, Results, coordinate, labels, variable_name

BLOCK = 2**17
"""Numbers that are copied at a time."""


def export(results: Results, design: Design, loaded: Loaded, path: Path) -> None:
    """Write `path`: a cartesian design with one dimension per key, any other along `point`.

    **Raises:** `OSError` if it cannot be written.
    """
    partial = path.with_name(f".{path.name}.partial")
    try:
        with netCDF4.Dataset(partial, "w", format="NETCDF4") as file:
            file.set_fill_off()
            file.setncatts({key: str(value) for key, value in results.attributes().items()})
            names = _unstacked(file, design, loaded) if design.kind == "cartesian" else _listed(file, results)
            for name in (*results.names(), DONE, *([REASON] if results.reasons() else [])):
                _copy(file, results, name, design, names)
        os.replace(partial, path)
    except RuntimeError as error:
        # netCDF's own error hides what the system said; a full disk is by far the likeliest.
        raise OSError(errno.ENOSPC, f"netCDF: {error}") from error
    finally:
        partial.unlink(missing_ok=True)


def _unstacked(file: Any, design: Design, loaded: Loaded) -> str:
    """Dimensions of a cartesian design; names of the coordinates that are no dimensions."""
    names = []
    for axis, length in zip(design.axes, design.shape, strict=True):
        name = variable_name(axis.key)
        values = labels(axis, np.arange(length))
        numeric = axis.values.numeric
        # A coordinate variable must hold numbers: names stand beside a dimension without one.
        dimension = name if numeric else f"{name}_index"
        file.createDimension(dimension, length)
        variable = file.createVariable(name, "f8" if numeric else str, (dimension,))
        variable[:] = values if numeric else values.astype(object)
        attributes = coordinate(axis, loaded).attributes()
        if not numeric:
            del attributes["units"]
            names.append(name)
        variable.setncatts({**attributes, "config_key": axis.key})
    return " ".join(names)


def _listed(file: Any, results: Results) -> str:
    """The dimension `point` and the coordinates of the points."""
    file.createDimension("point", results.count)
    names = results.coordinates()
    for name in names:
        array = results.array(name)
        text = array.dtype.kind == "T"
        shape = (results.count,)
        variable = file.createVariable(name, str if text else "f8", ("point",))
        variable.setncatts(dict(array.attrs))
        for where, start, stop in _rows(shape, 1):
            values = np.asarray(array[start:stop])
            variable[where] = values.astype(object) if text else values
    return " ".join(names)


def _copy(file: Any, results: Results, name: str, design: Design, coordinates: str) -> None:
    """One variable of the store."""
    array = results.array(name)
    attributes: dict[str, Any] = {key: value for key, value in array.attrs.items() if key != "coordinates"}
    if coordinates:
        attributes["coordinates"] = coordinates
    if "flag_values" in attributes:
        attributes["flag_values"] = np.asarray(attributes["flag_values"], "i1")
    dimensions = tuple(_dimension(design, i) for i in range(len(design.axes)))
    if design.kind != "cartesian":
        dimensions = ("point",)
    shape = design.shape if design.kind == "cartesian" else (results.count,)
    inner = array.shape[1:]
    for i, length in enumerate(inner):
        file.createDimension(f"{name}_{i}", length)
    text = array.dtype.kind == "T"
    number = "i1" if array.dtype == np.int8 else "f8"
    variable = file.createVariable(
        name,
        str if text else number,
        (*dimensions, *(f"{name}_{i}" for i in range(len(inner)))),
        fill_value=np.nan if number == "f8" and not text else None,
    )
    variable.setncatts(attributes)
    for where, start, stop in _rows(shape, max(1, int(np.prod(inner)))):
        values = np.asarray(array[start:stop])
        values = values.reshape(*(one.stop - one.start for one in where), *shape[len(where) :], *inner)
        variable[where] = values.astype(object) if text else values


def _dimension(design: Design, i: int) -> str:
    axis = design.axes[i]
    return variable_name(axis.key) + ("" if axis.values.numeric else "_index")


def _rows(shape: tuple[int, ...], inner: int) -> Iterator[tuple[tuple[slice, ...], int, int]]:
    """Boxes of a grid that are contiguous and not too large: leading indices, first and last point."""
    behind = [int(np.prod(shape[i + 1 :], dtype=object)) for i in range(len(shape))]
    split = next(i for i in range(len(shape)) if behind[i] * inner <= BLOCK or i == len(shape) - 1)
    step = max(1, BLOCK // (behind[split] * inner))
    for number, leading in enumerate(np.ndindex(*shape[:split])):
        for first in range(0, shape[split], step):
            last = min(first + step, shape[split])
            start = (number * shape[split] + first) * behind[split]
            stop = (number * shape[split] + last) * behind[split]
            yield (*(slice(i, i + 1) for i in leading), slice(first, last)), start, stop
