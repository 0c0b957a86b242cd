"""How far a sweep is: points, failures, rate and time left on a terminal, one line elsewhere."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

Advance = Callable[[int, int], None]
"""Told the numbers of points and of failures of each finished task."""


class _Rate(ProgressColumn):
    """Points per second, and the time left at that rate."""

    def render(self, task: Task) -> Text:
        rate = speed(task.fields["laps"], time.monotonic())
        if rate is None or task.total is None:
            return Text("")
        return Text(f"{in_words(rate)} · {clock((task.total - task.completed) / rate)} left")


def speed(laps: Sequence[tuple[float, int]], now: float) -> float | None:
    """Points per second; None before the first task is done.

    **Arguments:** `laps`: when this command began, and when each of its tasks ended, with the points done by then;
    `now`: the time. The first task is left out as soon as there are others: it has waited for compilation.
    """
    if len(laps) < 2:
        return None
    start, first = laps[0] if len(laps) == 2 else laps[1]
    end = laps[-1][0] if len(laps) > 2 else now
    return (laps[-1][1] - first) / max(end - start, 1e-9)


def in_words(rate: float) -> str:
    """A rate in the unit that reads best."""
    if rate >= 1:
        return f"{rate:,.0f} points/s" if rate >= 10 else f"{rate:.1f} points/s"
    return f"{60 * rate:.2g} points/min" if rate >= 1 / 60 else f"{3600 * rate:.2g} points/h"


def clock(seconds: float) -> str:
    """A duration as h:mm:ss, with days before it."""
    days, rest = divmod(round(seconds), 86400)
    text = f"{rest // 3600}:{rest // 60 % 60:02d}:{rest % 60:02d}"
    return f"{days} d {text}" if days else text


@contextmanager
def meter(console: Console, what: str, total: int, before: int, failed: int) -> Iterator[Advance]:
    """A bar on the console, gone without a trace when the work is done.

    **Arguments:** `what`: is being swept; `total`: number of points; `before`, `failed`: points that are there
    already, and those of them that failed.
    """
    if not console.is_terminal:
        there = f", {before:,} are there already" if before else ""
        console.print(f"Sweeping {what}: {total:,} points{there} …", highlight=False)
    columns = (TextColumn("{task.description}"), BarColumn(24), MofNCompleteColumn(), _Rate())
    failures = failed
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        laps = [(time.monotonic(), before)]
        task = progress.add_task(what, total=total, completed=before, laps=laps)

        def advance(points: int, failed: int) -> None:
            nonlocal failures
            failures += failed
            laps.append((time.monotonic(), laps[-1][1] + points))
            description = what if failures == 0 else f"{what} ({failures:,} failed)"
            progress.update(task, advance=points, description=description)

        yield advance
