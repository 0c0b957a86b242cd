"""`report.md`: the answer first, then its tables."""

from collections.abc import Sequence

from ..harness._result import Table


def page(title: str, answer: Sequence[str], tables: Sequence[Table], *, picture: str, setting: str) -> str:
    """A report of one page.

    **Arguments:** `title`; `answer`: paragraphs; `tables`; `picture`: name of the figure beside it; `setting`: what
    the numbers depend on.
    """
    parts = [f"# {title}", *answer, f"![{title}]({picture}.png)", f"All numbers: {setting}."]
    return "\n\n".join([*parts, *(f"## {table.title}\n\n{_rows(table)}" for table in tables)])


def _rows(table: Table) -> str:
    lines = [table.columns, ["---"] * len(table.columns), *table.cells()]
    return "\n".join(f"| {' | '.join(cell.strip().replace('|', '/') for cell in line)} |" for line in lines)
