"""Sweeps on a dask.distributed cluster of two workers, a program of its own."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import _sweep_toys
import numpy as np
import pytest
import xarray as xr
from _sweep_toys import compute, computed, plan

import experiments
from experiments.harness._errors import UserError
from experiments.sweeps import _executors, cluster

PROJECT = Path(experiments.__file__).parents[1]
PATHS = os.pathsep.join([str(PROJECT), str(PROJECT / "tests")])
PROGRAM = (sys.executable, str(Path(_sweep_toys.__file__)), "sweep", "runs.yaml")

CLUSTER = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
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
        timeout=120,
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
