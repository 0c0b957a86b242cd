"""Lines of JSON in a file, one for each finished piece of long work: what a killed process leaves can be read."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def append(file: Path, record: Mapping[str, Any]) -> None:
    """Add one record."""
    # A line that was cut off must not swallow this one.
    with file.open("a", encoding="utf-8") as lines:
        lines.write("\n" + json.dumps(record) + "\n")


def read(file: Path) -> list[dict[str, Any]]:
    """All whole records, none if there is no file."""
    found = []
    for line in file.read_text(encoding="utf-8").splitlines() if file.is_file() else ():
        try:
            found.append(json.loads(line))
        except ValueError:
            continue  # the last line of a process that was killed, or an empty one
    return found
