"""Sweeps as real processes that are killed, interrupted, starved of disk: nothing is lost, nothing is left running."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import _sweep_toys
import numpy as np
import pytest
import xarray as xr
import zarr
from _compiler import QUICK
from _sweep_toys import compute, computed, plan

import experiments
from experiments._sweep_command import sweep_command
from experiments.harness._errors import UserError
from experiments.sweeps import find_finished
from experiments.sweeps._drive import DEATHS
from experiments.sweeps._executors import SpawnPool

PROJECT = Path(experiments.__file__).parents[1]
LONGEST = 120  # seconds; a busy machine imports slowly


def command(folder: Path, experiment: str, *values: str) -> list[str]:
    (folder / f"{experiment}.yaml").write_text(f"experiment: {experiment}\n")
    program = [sys.executable, "-W", "error", str(Path(_sweep_toys.__file__))]
    return [*program, "sweep", f"{experiment}.yaml", *values, "--output", "sweeps"]


def environment() -> dict[str, str]:
    path = os.pathsep.join([str(PROJECT), str(PROJECT / "tests")])
    return {"XLA_FLAGS": QUICK, **os.environ, "PYTHONPATH": path, "JAXOCEAN_CACHE": "off"}


LISTENING = "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"
"""Runs another program that hears Ctrl-C even where the tests were started in the background of a shell."""


def start(folder: Path, experiment: str, *values: str) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-c", LISTENING, *command(folder, experiment, *values)],
        cwd=folder,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def wait_until(condition: Callable[[], object], process: subprocess.Popen | None = None) -> None:
    deadline = time.monotonic() + LONGEST
    while not condition():
        assert time.monotonic() < deadline
        assert process is None or process.poll() is None, process.communicate()
        time.sleep(0.02)


def session_of(process: subprocess.Popen) -> list[int]:
    """Processes of the session that the process leads, dead ones that nobody has buried yet aside."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == process.pid and fields[0] != "Z":
            found.append(int(stat.parent.name))
    return found


def workers(log: Path) -> set[int]:
    return {int(line.split()[0]) for line in log.read_text().splitlines()} if log.exists() else set()


@pytest.fixture
def values(tmp_path) -> tuple[str, ...]:
    return ("value=0:29:1", "wait=0.05", f"log={tmp_path / 'log'}")


def test_a_killed_sweep_leaves_no_process_and_the_same_command_computes_what_was_not_finished(
    tmp_path, values
):
    log = tmp_path / "log"
    process = start(tmp_path, "runs", *values, "--workers", "2")
    wait_until(lambda: len(computed(log)) >= 12 and len(workers(log)) == 2, process)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=LONGEST)
    wait_until(lambda: not session_of(process))
    sweep = plan(tmp_path, "runs", *values)
    group = zarr.open_group(sweep.folder / "results.zarr", mode="r", use_consolidated=False)
    done = np.flatnonzero(np.asarray(group["done"])).tolist()
    started = computed(log)
    assert done
    assert find_finished(sweep) is None
    # What is flagged is there.
    assert [int(value) for value in np.asarray(group["square_m"])[done]] == [value**2 for value in done]
    again = subprocess.run(
        [*command(tmp_path, "runs", *values), "--workers", "2"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=LONGEST,
        check=False,
    )
    assert again.returncode == 0, again.stderr
    assert f"{len(done)} are there already" in again.stderr
    assert sorted(computed(log)[len(started) :]) == sorted(set(range(30)) - set(done))
    with xr.open_dataset(sweep.folder / "results.nc") as data:
        np.testing.assert_array_equal(data["square_m"], np.arange(30) ** 2)
    assert not list(tmp_path.glob("sweeps/.*"))
    assert not (sweep.folder / "scratch").exists()


def test_ctrl_c_ends_all_processes_and_tells_what_is_kept(tmp_path, values):
    log = tmp_path / "log"
    # Slow enough that a busy machine notices the eighth point long before the last one.
    values = tuple(value.replace("wait=0.05", "wait=0.1") for value in values)
    process = start(tmp_path, "runs", *values, "seed=1", "--workers", "2")
    wait_until(lambda: len(computed(log)) >= 8, process)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: the workers get it too
    out, err = process.communicate(timeout=LONGEST)
    assert process.returncode == 130
    assert "points are kept in sweeps/runs-sweep-" in err
    assert "Traceback" not in err
    assert out == ""
    wait_until(lambda: not session_of(process))
    kept = int(err.partition("Interrupted: ")[2].split()[0])
    assert 1 <= kept < 30
    started = computed(log)
    compute(plan(tmp_path, "runs", *values, "seed=1"))
    assert len(computed(log)) - len(started) == 30 - kept


def test_a_killed_worker_costs_its_task_and_a_point_that_always_kills_fails_alone(tmp_path):
    log = tmp_path / "log"
    values = ("value=0:11:1", "kills_once=3", "kills=8", f"log={log}")
    data = compute(plan(tmp_path, "runs", *values), workers=2)
    assert np.flatnonzero(data["done"].values == 0).tolist() == [8]
    assert f"killed, {DEATHS} times" in str(data["reason"].values[8])
    assert computed(log).count(3) >= 2
    assert computed(log).count(8) >= DEATHS


def test_a_worker_killed_from_outside_is_replaced(tmp_path):
    pool = SpawnPool(1)
    try:
        first = pool.submit(os.getpid).result(timeout=LONGEST)
        os.kill(first, signal.SIGKILL)
        wait_until(lambda: not Path(f"/proc/{first}").exists())
        second = pool.submit(os.getpid)
        if second.exception(timeout=LONGEST) is not None:
            second = pool.submit(os.getpid)
        assert second.result(timeout=LONGEST) != first
        assert pool.submit(os.getenv, "PJRT_NPROC").result(timeout=LONGEST) == str(
            len(os.sched_getaffinity(0))
        )
    finally:
        pool.shutdown()


def test_a_full_disk_is_one_sentence_and_what_is_written_is_kept(tmp_path):
    log = tmp_path / "log"
    # Each point adds 512 bytes to the chunk of `wide`, which soon is too large a file.
    values = ("value=0:99:1", f"log={log}")

    program = (
        "import resource, sys\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, resource.RLIM_INFINITY))\n"
        f"sys.argv = {[*command(tmp_path, 'runs', *values)[3:], '--workers', '1']!r}\n"
        "import _sweep_toys\n"
        "_sweep_toys.main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**environment(), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        timeout=LONGEST,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "cannot be written" in done.stderr
    assert "the same command goes on from there" in done.stderr
    assert "Traceback" not in done.stderr
    kept = int(done.stderr.partition("): ")[2].split()[0])
    started = len(computed(log))
    data = compute(plan(tmp_path, "runs", *values))
    assert len(computed(log)) - started == 100 - kept
    np.testing.assert_array_equal(data["square_m"], np.arange(100) ** 2)


def test_many_processes_say_what_one_says(tmp_path, monkeypatch):
    # To the last bit, so the others must be compiled as this one is.
    monkeypatch.setenv("XLA_FLAGS", os.environ.get("XLA_FLAGS", QUICK))
    (tmp_path / "one").mkdir()
    values = ("x=0.5:2.5", "y=1:9")
    many = compute(plan(tmp_path, "batch", *values, kind="sobol", points=3000), workers=2)
    one = compute(plan(tmp_path / "one", "batch", *values, kind="sobol", points=3000))
    xr.testing.assert_identical(many, one)


def test_help_imports_nothing_heavy():
    heavy = ("jax", "matplotlib", "xarray", "numpy", "scipy", "zarr", "netCDF4", "distributed")
    program = (
        "import sys\n"
        "from experiments.__main__ import main\n"
        "sys.argv = ['jaxocean', 'sweep', '--help']\n"
        "try:\n    main()\n"
        "except SystemExit as end:\n    assert not end.code, end.code\n"
        f"print('HEAVY', [name for name in {heavy!r} if name in sys.modules])\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "HEAVY []" in done.stdout


OPTIONS = {
    "workers": None,
    "zipped": False,
    "design": None,
    "points": None,
    "scheduler": None,
    "output": None,
    "retry_failed": False,
    "force": False,
}


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({}, "an interval start:stop is for --design"),
        ({"design": "latin"}, "must be sobol or random, but is latin"),
        ({"design": "sobol", "zipped": True}, "at most one of --zip and --design"),
        ({"workers": 2, "scheduler": "tcp://here:1"}, "at most one of --workers and --scheduler"),
        ({"design": "random", "points": -1}, "--points must be at least 1, but it is -1"),
    ],
)
def test_options_that_make_no_sense_are_refused(options, says):
    with pytest.raises(UserError, match=says):
        sweep_command("coverage", ["wind.speed=4:9"], **OPTIONS | options)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--workers", "0"], "--workers"),
        (["--output", "/proc/nowhere"], "cannot be written"),
    ],
)
def test_bad_options_are_one_sentence_and_exit_code_2(tmp_path, arguments, says):
    done = subprocess.run(
        [*command(tmp_path, "runs", "value=1,2"), *arguments],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=LONGEST,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


def test_memory_does_not_grow_with_the_number_of_points(tmp_path):
    peaks = []
    for points in (5_000, 200_000):
        program = (
            "import sys\n"
            f"sys.argv = {command(tmp_path, 'batch', 'x=1:2', 'y=1:2')[3:]!r}\n"
            f"sys.argv += ['--design', 'random', '--points', '{points}', '--workers', '1']\n"
            "import _sweep_toys\n"
            "try:\n    _sweep_toys.main()\n"
            "except SystemExit as end:\n    assert not end.code, end.code\n"
            "print(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')))\n"
        )
        done = subprocess.run(
            [sys.executable, "-c", program],
            cwd=tmp_path,
            env=environment(),
            capture_output=True,
            text=True,
            timeout=LONGEST,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        peaks.append(int(done.stdout.rpartition("VmHWM:")[2].split()[0]) / 1024)
    # MB; the results alone are 8 MB, the numbers that made them 3 MB more.
    assert peaks[1] - peaks[0] < 25, peaks


def test_a_finished_sweep_is_found_again_without_importing_jax(tmp_path):
    sweep = plan(tmp_path, "runs", "value=1,2,3")
    compute(sweep)
    program = (
        "import sys\n"
        f"sys.argv = {command(tmp_path, 'runs', 'value=1,2,3')[3:]!r}\n"
        "import _sweep_toys\n"
        "try:\n    _sweep_toys.main()\n"
        "except SystemExit as end:\n    assert not end.code, end.code\n"
        "print('HEAVY', [name for name in ('jax', 'matplotlib') if name in sys.modules])\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=LONGEST,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "Found again" in done.stdout
    assert "HEAVY []" in done.stdout
    assert done.stderr == ""
