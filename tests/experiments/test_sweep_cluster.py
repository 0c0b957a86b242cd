"""Sweeps on a dask.distributed cluster of two workers, a program of its own."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, wait
from contextlib import contextmanager
from pathlib import Path

import _sweep_toys
import numpy as np
import pytest
import xarray as xr
from _sweep_toys import compute, computed, plan, unwatched

import experiments
from experiments import sweeps
from experiments.harness._errors import UserError
from experiments.sweeps import _drive, _executors, cluster
from experiments.sweeps._task import Outcome, Task

PROJECT = Path(experiments.__file__).parents[1]
PATHS = os.pathsep.join([str(PROJECT), str(PROJECT / "tests")])
PROGRAM = (sys.executable, str(Path(_sweep_toys.__file__)), "sweep", "runs.yaml")

CLUSTER = """
import sys
import dask
from distributed import LocalCluster
if __name__ == "__main__":
    # By default four workers must die before a task is blamed; to start each of them again takes seconds.
    dask.config.set({"distributed.scheduler.allowed-failures": 1})
    options = {"processes": True, "threads_per_worker": 1, "dashboard_address": None}
    with LocalCluster(n_workers=int(sys.argv[1]), **options) as cluster:
        print(cluster.scheduler_address, flush=True)
        sys.stdin.readline()
"""


def start(folder: Path, workers: int) -> subprocess.Popen:
    program = folder / "cluster.py"
    program.write_text(CLUSTER)
    return subprocess.Popen(
        [sys.executable, str(program), str(workers)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": PATHS, "JAXOCEAN_CACHE": "off"},
        text=True,
    )


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory) -> Iterator[str]:
    """The address of a cluster of two workers."""
    with start(tmp_path_factory.mktemp("cluster"), 2) as process:
        assert process.stdout is not None
        yield process.stdout.readline().strip()
        process.communicate("\n", timeout=60)


def sweep(folder: Path, *arguments: str) -> subprocess.CompletedProcess:
    """`jaxocean sweep runs.yaml …` as a process, which warnings of distributed do not disturb."""
    (folder / "runs.yaml").write_text("experiment: runs\n")
    return subprocess.run(
        [
            sys.executable,
            str(Path(_sweep_toys.__file__)),
            "sweep",
            "runs.yaml",
            *arguments,
            "--output",
            "sweeps",
        ],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": PATHS, "JAXOCEAN_CACHE": "off"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_a_cluster_computes_the_same_store_on_both_of_its_workers(scheduler, tmp_path):
    log = tmp_path / "log"
    values = ("value=0:11:1", "wait=0.05", "refuses=3", f"log={log}")
    done = sweep(tmp_path, *values, "--scheduler", scheduler)
    assert done.returncode == 0, done.stderr
    assert len({line.split()[0] for line in log.read_text().splitlines()}) == 2
    assert sorted(computed(log)) == list(range(12))
    (folder,) = (tmp_path / "sweeps").glob("runs-sweep-*")
    here = tmp_path / "here"
    here.mkdir()
    with xr.open_dataset(folder / "results.nc") as data:
        xr.testing.assert_identical(data.load(), compute(plan(here, "runs", *values)))


def test_a_point_that_kills_workers_of_a_cluster_fails_alone(scheduler, tmp_path):
    done = sweep(tmp_path, "value=0:3:1", "kills=2", "--scheduler", scheduler)
    assert done.returncode == 0, done.stderr
    (folder,) = (tmp_path / "sweeps").glob("runs-sweep-*")
    with xr.open_dataset(folder / "results.nc") as data:
        np.testing.assert_array_equal(data["done"], [1, 1, 0, 1])
        assert "killed" in str(data["reason"].values[2])


class KilledWorker(Exception):
    """Has the name of what distributed raises."""


class BlamingCluster(Executor):
    """Does what a cluster can do at worst: when a point kills, all tasks on the way are blamed.

    `tried` has what was on the way together, again and again, as first and last points.
    """

    def __init__(self, *killers: int) -> None:
        self._killers = killers
        self._on_the_way: list[tuple[Callable[[Task], Outcome], Task, Future[Outcome]]] = []
        self.tried: list[list[range]] = []

    def submit(self, fn: Callable[..., Outcome], /, *args: Task, **kwargs: Task) -> Future[Outcome]:
        assert not kwargs
        future: Future[Outcome] = Future()
        self._on_the_way.append((fn, *args, future))
        return future

    def work(self) -> None:
        """Compute all that is on the way, or let it be killed."""
        together, self._on_the_way = self._on_the_way, []
        self.tried.append([range(task.start, task.stop) for _, task, _ in together])
        killed = any(killer in points for killer in self._killers for points in self.tried[-1])
        for fn, task, future in together:
            if killed:
                future.set_exception(KilledWorker(f"Attempted to run task {task.start} on 4 workers"))
            else:
                future.set_result(fn(task))


def blame(monkeypatch, sweep: sweeps.Sweep, *killers: int) -> tuple[xr.Dataset, list[list[range]]]:
    """Compute a sweep on a cluster that blames; its netCDF file, and what was on the way together."""
    blaming = BlamingCluster(*killers)

    @contextmanager
    def opened():
        yield blaming, 3

    def work_and_wait(futures, **options):
        blaming.work()
        return wait(futures, **options)

    monkeypatch.setattr(_drive, "wait", work_and_wait)
    monkeypatch.setenv("JAXOCEAN_CACHE", "off")
    finished = sweeps.run(sweep, opened, unwatched, retry_failed=False, force=False)
    return xr.load_dataset(finished.folder / "results.nc"), blaming.tried


@pytest.mark.parametrize("killers", [(1,), (8,), (0, 11), (6, 7)])
def test_points_that_a_cluster_blames_for_another_ones_kill_are_computed(monkeypatch, tmp_path, killers):
    data, tried = blame(monkeypatch, plan(tmp_path, "runs", "value=0:11:1"), *killers)
    expected = [value not in killers for value in range(12)]
    np.testing.assert_array_equal(data["done"], expected)
    np.testing.assert_array_equal(data["square_m"][expected], np.arange(12)[expected] ** 2)
    assert ["killed" in reason for reason in data["reason"].values] == [not done for done in expected]
    # What is blamed waits for the rest, and is then alone; nothing is tried without end.
    alone = next(i for i, together in enumerate(tried) if len(together) == 1)
    assert all(len(together) == 1 for together in tried[alone:])
    kills = [points for together in tried for points in together if set(points) & set(killers)]
    assert len(kills) <= 3 * len(killers)


def test_vmapped_points_that_a_cluster_blames_for_another_chunks_kill_are_computed(monkeypatch, tmp_path):
    data, tried = blame(monkeypatch, plan(tmp_path, "batch", "x=1:1100:1"), 700)
    chunks = [range(512), range(512, 1024), range(1024, 1100)]
    assert tried[0] == chunks
    assert sorted(tried[1:], key=str) == sorted(([chunk] for chunk in chunks), key=str)
    np.testing.assert_array_equal(data["done"], [i not in chunks[1] for i in range(1100)])


def test_a_lost_cluster_is_one_sentence_and_what_was_computed_is_kept(tmp_path):
    log = tmp_path / "log"
    values = ("value=0:9:1", "wait=0.3", f"log={log}")
    with start(tmp_path, 1) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        (tmp_path / "runs.yaml").write_text("experiment: runs\n")
        running = subprocess.Popen(
            [*PROGRAM, *values, "--scheduler", address, "--output", "sweeps"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": PATHS, "JAXOCEAN_CACHE": "off"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        while len(computed(log)) < 5:
            assert running.poll() is None, running.communicate()
        process.kill()
    _, err = running.communicate(timeout=120)
    assert running.returncode == 2, err
    assert "the same command goes on from there" in err
    assert "Traceback" not in err.rpartition("Error: ")[2]
    before = len(computed(log))
    compute(plan(tmp_path, "runs", *values))
    assert len(computed(log)) - before <= 7


def test_a_scheduler_that_is_not_there_is_one_sentence(monkeypatch):
    monkeypatch.setattr(_executors, "PATIENCE", "0.5s")
    says = r"No scheduler answers at tcp://127\.0\.0\.1:9 .*dask scheduler"
    with pytest.raises(UserError, match=says), cluster("tcp://127.0.0.1:9"):
        raise AssertionError("a cluster where there is none")


def test_without_distributed_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UserError, match=r"pip install jaxocean\[cluster\]"), cluster("tcp://127.0.0.1:9"):
        raise AssertionError("a cluster without its package")


def test_a_cluster_without_workers_is_one_sentence(tmp_path):
    with start(tmp_path, 0) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        done = sweep(tmp_path, "value=1,2", "--scheduler", address)
        process.communicate("\n", timeout=60)
    assert done.returncode == 2
    assert "has no workers" in done.stderr
    assert "Traceback" not in done.stderr
