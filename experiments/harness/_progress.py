"""What an experiment says while it works."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

SECONDS = 5.0
"""At least so long between two lines of one count."""


class Reporter(Protocol):
    """The `progress` that an experiment's `run` is given."""

    def step(self, what: str) -> None:
        """Say what is being done now, for example "Fitting ε to Monahan 1980"."""

    def count(self, what: str, total: int) -> Callable[[], None]:
        """Say it with a bar of `total` parts; call the returned function after each part."""
        ...


class Silent:
    """Says nothing."""

    def step(self, what: str) -> None:
        del what

    def count(self, what: str, total: int) -> Callable[[], None]:
        del what, total
        return lambda: None


class Bars:
    """Live lines on a terminal; on anything else one line per step, and for a long count one every few seconds."""

    def __init__(self, console: Console, progress: Progress) -> None:
        self._console, self._progress = console, progress
        self._current = None

    def step(self, what: str) -> None:
        self._start(what, None)

    def count(self, what: str, total: int) -> Callable[[], None]:
        task = self._start(what, total)
        done, told = 0, time.monotonic()

        def advance() -> None:
            nonlocal done, told
            done += 1
            self._progress.update(task, advance=1)
            # In a log a bar is a line now and then.
            if not self._console.is_terminal and done < total and time.monotonic() - told >= SECONDS:
                told = time.monotonic()
                self._console.print(f"{what}: {done} of {total} …", highlight=False)

        return advance

    def _start(self, what: str, total: int | None):
        if not self._console.is_terminal:
            self._console.print(f"{what} …", highlight=False)
        if self._current is not None:
            self._progress.remove_task(self._current)
        self._current = self._progress.add_task(what, total=total)
        return self._current


@contextmanager
def bars(console: Console) -> Iterator[Bars]:
    """A `Reporter` on the console, gone without a trace when the work is done."""
    columns = (TextColumn("{task.description}"), BarColumn(24), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        yield Bars(console, progress)
