"""The command line as a user meets it, each time in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import experiments
from experiments.harness._version import version

PROJECT = Path(experiments.__file__).parents[1]
HEAVY = ("jax", "jaxlib", "matplotlib", "xarray", "numpy", "scipy", "pandas")


def jaxocean(*arguments: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess:
    """Run `python -W error -m experiments` from `cwd`."""
    return subprocess.run(
        [sys.executable, "-W", "error", "-m", "experiments", *arguments],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(PROJECT), "JAXOCEAN_CACHE": "off", **environment},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.mark.parametrize(
    "command", [["--help"], ["--version"], ["list"], ["show", "spectrum"], ["run", "--help"]]
)
def test_light_commands_import_nothing_heavy(tmp_path, command):
    program = (
        "import sys\n"
        "from experiments.__main__ import main\n"
        f"sys.argv = ['jaxocean', *{command!r}]\n"
        "try:\n    main()\n"
        "except SystemExit as end:\n    assert not end.code, end.code\n"
        f"print('HEAVY', [name for name in {HEAVY!r} if name in sys.modules])\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(PROJECT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "HEAVY []" in done.stdout


def test_version_is_that_of_the_project(tmp_path):
    assert jaxocean("--version", cwd=tmp_path).stdout.strip() == f"jaxocean {version()}"


def test_help_says_where_runs_go(tmp_path):
    shown = " ".join(jaxocean("run", "--help", cwd=tmp_path, COLUMNS="200").stdout.split())
    assert "Folder for runs; runs unless said." in shown


def test_list_names_every_config(tmp_path):
    listed = jaxocean("list", cwd=tmp_path).stdout
    names = [path.stem for path in (PROJECT / "configs").glob("*.yaml")]
    assert names
    assert all(name in listed for name in names)


def test_show_tells_unit_default_range_and_meaning_of_every_key_in_one_line(tmp_path):
    shown = jaxocean("show", "spectrum", "wind.speed=12.5", cwd=tmp_path).stdout
    line = next(line for line in shown.splitlines() if "wind.speed" in line)
    for part in ("12.5", "m/s", "10", "≥ 0 and ≤ 100", "U10"):
        assert part in line
    family = next(line for line in shown.splitlines() if "spectrum.family" in line)
    assert "jonswap" in family


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run", "spectrum", "wind.sped=3"], "did you mean `wind.speed`?"),
        (["run", "spectrum", "wind.speed=.nan"], "must be a finite number"),
        (["run", "nothing"], "There is no config `nothing`"),
        (["show", "spectrum", "cascade.resolution=7"], "cascade.resolution"),
        (["run", "spectrum", "--output", "/proc/nowhere"], "cannot be written"),
        (["run", "spectrum", "spectrum.family=jonswap"], "needs either `wind.fetch`"),
        (["run", "spectrum", "wind.fetch=1e5", "spectrum.inverse_wave_age=1"], "exactly one"),
        (["run"], "Missing argument"),
        (["run", "spectrum", "--nothing"], "No such option"),
        (["fly"], "No such command"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_one_sentence_and_exit_code_2_and_nothing_is_left(tmp_path, arguments, says):
    done = jaxocean(*arguments, cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    left = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert not left
