"""Tables and notes as text: the same on the screen and in `summary.txt`."""

import io

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

from ._result import Result, Table

WIDTH = 110

WHOLE = 10
"""Characters of a cell, or of a word above it, that is not broken as long as the table has room."""

NONE = ("undefined", "-")
"""What stands in a column of numbers where there is none."""


def render(result: Result) -> str:
    """The tables and notes of a result as plain text."""
    buffer = io.StringIO()
    console = Console(file=buffer, width=WIDTH, color_system=None)
    for table in result.tables:
        console.print(Text(table.title), _table(table), highlight=False)
    for note in result.notes:
        console.print(Padding(Text(f"• {note}"), (0, 0, 0, 1)))
    return "\n".join(line.rstrip() for line in buffer.getvalue().splitlines()) + "\n"


def _table(table: Table) -> RichTable:
    rich = RichTable(box=SIMPLE_HEAD)
    cells = list(table.cells())
    for position, column in enumerate(table.columns):
        numeric = all(not isinstance(row[position], str) or row[position] in NONE for row in table.rows)
        lengths = [max((len(row[position]) for row in cells), default=0), *map(len, column.split())]
        rich.add_column(
            Text(column),
            justify="right" if numeric else "left",
            overflow="fold",
            min_width=max((length for length in lengths if length <= WHOLE), default=None),
        )
    for row in cells:
        rich.add_row(*(Text(text) for text in row))
    return rich
