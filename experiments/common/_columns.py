"""Columns of numbers from a CSV file."""

import csv
import math
from collections.abc import Sequence
from pathlib import Path

from ..harness._errors import UserError


def read_columns(name: str, wanted: Sequence[str]) -> dict[str, list[float]]:
    """The wanted columns of a CSV file with a header line.

    **Raises:** `UserError` for a file that is not there, no text, empty, or without a wanted column, and for a cell
    that is no number, with its line.
    """
    path = Path(name).expanduser()
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UserError(f"The file {path} must be a CSV file that can be read, but: {error}.") from error
    if not rows:
        raise UserError(f"The file {path} must hold a header and at least one line of data, but is empty.")
    present = [column for column in rows[0] if column is not None]
    for column in wanted:
        if column not in present:
            there = ", ".join(f"`{one}`" for one in present)
            raise UserError(
                f"The file {path} must have a column `{column}`, but has {there}: "
                "name your columns with points.wind=… and points.coverage=…."
            )
    return {
        column: [_number(row[column], path, i, column) for i, row in enumerate(rows, 2)] for column in wanted
    }


def _number(text: str | None, path: Path, line: int, column: str) -> float:
    try:
        number = float(text or "")
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise UserError(f"Line {line} of {path} must hold a number in column `{column}`, but holds {text!r}.")
    return number
