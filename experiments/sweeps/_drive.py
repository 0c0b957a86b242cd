"""The loop of a sweep: tasks out, outcomes in, until every point is done or has failed."""

from collections import Counter, deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import replace

from ..harness._errors import UserError
from ._results import Results
from ._task import Outcome, Task, compute, failure

DEATHS = 3
"""A task that so many processes did not survive has failed."""

SECONDS = 1.0
"""Runs so short that a task of one would be all overhead are bundled into tasks of about this long."""


def drive(
    results: Results,
    template: Task,
    executor: Executor,
    lanes: int,
    *,
    retry_failed: bool,
    advance: Callable[[int, int], None],
) -> tuple[str, ...]:
    """Compute and write whatever is not there.

    **Arguments:** `template`: a task whose points are replaced; `lanes`: tasks on the way at a time;
    `retry_failed`: whether failed points are computed again; `advance`: told the numbers of points and of failures
    after each task.

    **Returns:** notes of the tasks.

    **Raises:** `UserError` if the scheduler is lost; `OSError` if the store cannot be written.
    """
    source = _Source(results, template, retry_failed=retry_failed)
    on_the_way: dict[Future[Outcome], Task] = {}
    notes: dict[str, None] = {}
    while True:
        while len(on_the_way) < lanes and (task := source.next(idle=not on_the_way)) is not None:
            on_the_way[executor.submit(compute, task)] = task
        if not on_the_way:
            return tuple(notes)
        finished = [(on_the_way.pop(f), f) for f in wait(on_the_way, return_when=FIRST_COMPLETED).done]
        # The free workers get something to do before the time-consuming writing.
        outcomes = [outcome for done in finished if (outcome := source.outcome(*done)) is not None]
        while len(on_the_way) < lanes and (task := source.next(idle=not on_the_way)) is not None:
            on_the_way[executor.submit(compute, task)] = task
        for outcome in outcomes:
            notes |= dict.fromkeys(results.write(outcome, clear=retry_failed))
            advance(outcome.stop - outcome.start, len(outcome.reasons))


class _Source:
    """Which task is next: what a killed process left behind, then unfinished points in their order, then suspects.

    A cluster blames the death of a worker on every task that it had given to that worker. Those tasks are suspects:
    when all others are done, each is computed with nothing else on the way, and only what kills then is the culprit.
    """

    def __init__(self, results: Results, template: Task, *, retry_failed: bool) -> None:
        self._template = template
        self._batched = bool(template.experiment.config.varies())
        self._spans = self._whole(results.unfinished(retry_failed=retry_failed), results.chunk)
        self._span = (0, 0)
        self._size = results.chunk if self._batched else 1
        self._again: deque[Task] = deque()
        self._deaths: Counter[int] = Counter()
        self._suspects: deque[Task] = deque()
        self._alone: Task | None = None

    def _whole(self, spans: Iterator[tuple[int, int]], chunk: int) -> Iterator[tuple[int, int]]:
        """For batched points one span per chunk: to compute a gap again costs less than a task of its own."""
        held: tuple[int, int] | None = None
        for span in spans:
            if held is not None and self._batched and held[0] // chunk == span[0] // chunk:
                held = (held[0], span[1])
                continue
            if held is not None:
                yield held
            held = span
        if held is not None:
            yield held

    def next(self, *, idle: bool) -> Task | None:
        """The next task, or None if there is none now; `idle`: no task is on the way."""
        if self._alone is not None:
            return None
        if self._again:
            return self._again.popleft()
        if self._span[0] >= self._span[1]:
            span = next(self._spans, None)
            if span is None:
                self._alone = self._suspects.popleft() if self._suspects and idle else None
                return self._alone
            self._span = span
        start, stop = self._span[0], min(self._span[0] + self._size, self._span[1])
        self._span = (stop, self._span[1])
        return replace(self._template, start=start, stop=stop)

    def outcome(self, task: Task, future: Future[Outcome]) -> Outcome | None:
        """What became of a task; None if it is to be tried again."""
        alone, self._alone = task is self._alone, None
        try:
            outcome = future.result()
        except CancelledError as error:
            raise UserError(
                "The scheduler or all of its workers are gone; everything that was finished is kept, and the same "
                "command goes on from there."
            ) from error
        except Exception as error:
            if type(error).__name__ == "KilledWorker":
                return self._after_deaths_of_workers(task, alone=alone)
            if not isinstance(error, BrokenExecutor):
                raise
            return self._after_death(task)
        if not self._batched:
            each = outcome.seconds / (task.stop - task.start)
            # At most double: points need not cost the same.
            self._size = max(1, min(int(SECONDS / max(each, 1e-9)), 2 * self._size))
        return outcome

    def _after_death(self, task: Task) -> Outcome | None:
        """After the death of a process that had nothing but this task."""
        if self._divisible(task):
            self._again.extend(_points(task))
            return None
        self._deaths[task.start] += 1
        if self._deaths[task.start] < DEATHS:
            self._again.append(task)
            return None
        return failure(task, f"The process that computed it was killed, {DEATHS} times (out of memory?).")

    def _after_deaths_of_workers(self, task: Task, *, alone: bool) -> Outcome | None:
        """After the deaths of several workers of a cluster, all of which had been given this task."""
        if not alone:
            self._suspects.append(task)
            return None
        if self._divisible(task):
            self._suspects.extend(_points(task))
            return None
        return failure(
            task,
            "The workers that computed it were killed, even when nothing else was computed (out of memory?).",
        )

    def _divisible(self, task: Task) -> bool:
        """Whether it can be known which of its points kills."""
        return not self._batched and task.stop - task.start > 1


def _points(task: Task) -> Iterator[Task]:
    """A task for each point of a task."""
    return (replace(task, start=i, stop=i + 1) for i in range(task.start, task.stop))
