"""What an experiment hands back, and how it is shown."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Table:
    """A table for people: `columns` name quantity and unit, `rows` hold text or numbers."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str | float]]

    def cells(self) -> list[list[str]]:
        return [[cell(value) for value in row] for row in self.rows]


@dataclass(frozen=True)
class Result:
    """The outcome of an experiment.

    **Arguments:** `values`: numbers, texts, arrays and nests of them for `result.json` (NaN becomes null);
    `tables` and `notes`: what the user sees at the end and again when the run is found.
    """

    values: Mapping[str, Any]
    tables: Sequence[Table] = ()
    notes: Sequence[str] = field(default=())


def cell(value: str | float) -> str:
    """A number with four significant digits; text as it is."""
    if isinstance(value, str):
        return value
    number = float(value)
    if number.is_integer() and "int" in type(value).__name__:
        return str(int(number))
    return "-" if math.isnan(number) else f"{number:.4g}"


def jsonable(value: Any) -> Any:
    """NumPy and JAX values as plain ones that JSON knows; what is not finite becomes None."""
    if isinstance(value, Mapping):
        return {str(name): jsonable(part) for name, part in value.items()}
    if hasattr(value, "tolist"):
        return jsonable(value.tolist())
    if isinstance(value, (list, tuple)):
        return [jsonable(part) for part in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (str, bool, int)):
        return value
    raise TypeError(f"A result holds a {type(value).__name__}, which JSON does not know: {value!r}")
