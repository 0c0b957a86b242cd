"""Columns of numbers from a CSV file."""

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ..harness._errors import UserError


class Allowed(NamedTuple):
    """What a column may hold: numbers greater than zero and at most `most`, and how to say so."""

    words: str
    most: float = math.inf


def read_columns(
    name: str, wanted: Sequence[str], allowed: Mapping[str, Allowed] | None = None
) -> dict[str, list[float]]:
    """The wanted columns of a CSV file with a header line.

    **Arguments:** `wanted`: the names of the columns; `allowed`: what they may hold, by name; any number if left out.

    **Raises:** `UserError` for a file that is not there, no text, empty, without rows, or without a wanted column, and
    for a cell that is no number or none that is allowed, with its line.
    """
    path = Path(name).expanduser()
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file)
            rows, header = list(reader), reader.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UserError(f"The file {path} must be a CSV file that can be read, but: {error}.") from error
    if not header:
        raise UserError(f"The file {path} must hold a header and at least one line of data, but is empty.")
    present = [column for column in header if column]
    for column in wanted:
        if column not in present:
            there = ", ".join(f"`{one}`" for one in present)
            raise UserError(
                f"The file {path} must have a column `{column}`, but has {there}: "
                "name your columns with points.wind=… and points.coverage=…."
            )
    if not rows:
        raise UserError(f"The file {path} must hold at least one line of data, but is without rows.")
    accepted = allowed or {}
    return {
        column: [_number(row[column], path, i, column, accepted.get(column)) for i, row in enumerate(rows, 2)]
        for column in wanted
    }


def _number(text: str | None, path: Path, line: int, column: str, allowed: Allowed | None) -> float:
    try:
        number = float(text or "")
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise UserError(f"Line {line} of {path} must hold a number in column `{column}`, but holds {text!r}.")
    if allowed is not None and not 0 < number <= allowed.most:
        raise UserError(
            f"Line {line} of {path} must hold {allowed.words} in column `{column}`, but holds {number:g}."
        )
    return number
