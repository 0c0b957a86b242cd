"""Tables and notes as text: the same on the screen and in `summary.txt`."""

import io

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

from ._result import Result, Table

WIDTH = 110

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
    for position, column in enumerate(table.columns):
        numeric = all(not isinstance(row[position], str) or row[position] in NONE for row in table.rows)
        rich.add_column(Text(column), justify="right" if numeric else "left", overflow="fold")
    for row in table.cells():
        rich.add_row(*(Text(text) for text in row))
    return rich
