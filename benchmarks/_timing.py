"""Timing of several ways to do the same thing, side by side."""

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

WARM, COUNTED = 2, 6  # calls of one run


@dataclass(frozen=True)
class Timing:
    """Milliseconds of one contestant over all rounds."""

    median: float
    best: float
    spread: float  # between the quartiles


def interleave(contestants: Mapping[str, Callable[[int], object]], rounds: int) -> dict[str, Timing]:
    """Time every contestant in turn, a short run of calls each, so that a busy machine slows all of them
    alike.

    The first calls of a run find the neighbour's data in the caches and are not counted: a program that
    animates a sea calls the same frame again and again.

    **Arguments:** `contestants`: functions of the number of the call that return when the work is done.
    """
    samples: dict[str, list[float]] = {name: [] for name in contestants}
    gc.collect()
    gc.disable()
    try:
        for number in range(rounds):
            for name, contestant in contestants.items():
                for call in range(WARM + COUNTED):
                    start = time.perf_counter()
                    contestant(number * (WARM + COUNTED) + call)
                    if call >= WARM:
                        samples[name].append(1e3 * (time.perf_counter() - start))
    finally:
        gc.enable()
    return {name: _summary(times) for name, times in samples.items()}


def _summary(times: list[float]) -> Timing:
    low, _, high = statistics.quantiles(times, n=4)
    return Timing(statistics.median(times), min(times), high - low)
