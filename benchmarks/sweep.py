"""A sweep of closed-form coverage against the bare vmapped closed form, and the memory it takes."""

import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import jax
import numpy as np
from rich.console import Console
from rich.table import Table

from experiments import schema, sweeps
from experiments.closures.coverage import measure
from experiments.sweeps._batch import BATCH, with_numbers
from experiments.sweeps._executors import available_cores

LEAST = 100_000
"""Points per minute that a sweep must reach on two cores."""

SHARE = 0.8
"""Of the bare rate."""

VALUES = ("wind.speed=4:24", "threshold=0.2:0.7", "choppiness=0.8:1.4")
KEYS = tuple(value.partition("=")[0] for value in VALUES)


def run(*, quick: bool = False) -> None:
    """Print rates in points per second, side by side, and peak memory against the number of points."""
    points = 10_000 if quick else 1_000_000
    workers = available_cores()
    bare_before = _bare(points // 10)
    with tempfile.TemporaryDirectory() as folder:
        computing, whole = _swept(points, workers, Path(folder))
    bare_after = _bare(points // 10)
    bare = max(bare_before, bare_after)
    table = Table(title=f"Closed-form coverage, {points:,} points, {workers} cores, float64")
    for column in ("", "points/s", "points/min", "of the bare rate"):
        table.add_column(column, justify="left" if not column else "right")
    rows = {
        f"bare vmap in one process, batches of {BATCH}": bare,
        f"sweep with {workers} workers, first task to last": computing,
        "the whole command: start, compilation, netCDF": whole,
    }
    for name, rate in rows.items():
        table.add_row(name, f"{rate:,.0f}", f"{60 * rate:,.0f}", f"{rate / bare:.2f}")
    Console(width=110).print(table)
    good = "yes" if 60 * whole >= LEAST and computing >= SHARE * bare else "NO"
    print(f"At least {LEAST:,} points/min as a whole and {SHARE:g} of the bare rate: {good}")
    _memory((2_000,) if quick else (10_000, 200_000, 2_000_000), workers)


def _bare(points: int) -> float:
    """Points per second of the same function, vmapped and compiled, called again and again."""
    with jax.enable_x64(True):
        random = np.random.default_rng(0)
        low, high = np.array([[float(x) for x in v.partition("=")[2].split(":")] for v in VALUES]).T
        batches = [
            dict(zip(KEYS, (low + (high - low) * random.random((BATCH, len(KEYS)))).T, strict=True))
            for _ in range(max(2, points // BATCH))
        ]
        jax.block_until_ready(_coverage(batches[0]))
        began = time.perf_counter()
        jax.block_until_ready([_coverage(batch) for batch in batches])
        return len(batches) * BATCH / (time.perf_counter() - began)


@jax.jit
@jax.vmap
def _coverage(numbers: dict[str, jax.Array]) -> dict[str, jax.Array]:
    return measure(with_numbers(schema.CoverageConfig(), numbers))


def _swept(points: int, workers: int, folder: Path) -> tuple[float, float]:
    """Points per second from the end of the first task of each worker to the last task, and of everything."""
    began = time.perf_counter()
    plan = sweeps.plan("coverage", VALUES, kind="sobol", points=points, output=str(folder))
    times: list[tuple[float, int]] = []

    @contextmanager
    def watch(before: int, failed: int):
        yield lambda count, failures: times.append((time.perf_counter(), count))

    sweeps.run(plan, partial(sweeps.local, workers), watch, retry_failed=False, force=False)
    whole = points / (time.perf_counter() - began)
    first = times[workers - 1][0]
    counted = sum(count for _, count in times[workers:])
    return counted / (times[-1][0] - first) if counted else float("nan"), whole


def _memory(sizes: tuple[int, ...], workers: int) -> None:
    """Peak resident memory of the command and of its largest worker."""
    table = Table(title="Peak resident memory, MB")
    for column in ("points", "command", "largest worker"):
        table.add_column(column, justify="right")
    for points in sizes:
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "experiments", "sweep", "coverage", *VALUES]
            command += [
                "--design",
                "sobol",
                "--points",
                str(points),
                "--workers",
                str(workers),
                "--output",
                folder,
            ]
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            peaks: dict[int, float] = {}
            while process.poll() is None:
                for pid in (process.pid, *_children(process.pid)):
                    peaks[pid] = max(peaks.get(pid, 0.0), _peak(pid))
                time.sleep(0.1)
        table.add_row(f"{points:,}", f"{peaks.pop(process.pid):.0f}", f"{max(peaks.values()):.0f}")
    Console(width=110).print(table)


def _children(pid: int) -> list[int]:
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def _peak(pid: int) -> float:
    """The peak so far, in MB; a process that has ended has none."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0
    return next(
        (int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmHWM")), 0.0
    )
