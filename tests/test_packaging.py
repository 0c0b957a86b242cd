"""What a user gets: a wheel that carries the configs and works far from the clone."""

import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from _compiler import QUICK

PROJECT = Path(__file__).resolve().parent.parent
PYPROJECT = tomllib.loads((PROJECT / "pyproject.toml").read_text())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """The wheel, built without network."""
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=PROJECT,
        check=True,
        capture_output=True,
    )
    (built,) = folder.glob("jaxocean-*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory) -> Path:
    """A folder that holds nothing but the installed wheel."""
    target = tmp_path_factory.mktemp("site")
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "install",
            "--no-deps",
            "--no-index",
            "--target",
            str(target),
            str(wheel),
        ],
        check=True,
        capture_output=True,
    )
    return target


def jaxocean(installed: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess:
    """The installed entry point, run outside of the clone; dependencies come from this environment."""
    program = (
        "import sys\n"
        "from experiments.__main__ import main\n"
        "import experiments\n"
        f"assert experiments.__file__.startswith({str(installed)!r}), experiments.__file__\n"
        "sys.argv[0] = 'jaxocean'\n"
        "main()\n"
    )
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", program, *arguments],
        cwd=cwd,
        env={
            "XLA_FLAGS": QUICK,
            **os.environ,
            "PYTHONPATH": str(installed),
            "JAXOCEAN_CACHE": str(cwd / "cache"),
        },
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def test_the_wheel_carries_rooms_configs_licence_and_entry_point(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        entry = next(name for name in names if name.endswith("entry_points.txt"))
        assert "jaxocean = experiments.__main__:main" in archive.read(entry).decode()
    for config in (PROJECT / "configs").glob("*.yaml"):
        assert f"experiments/configs/{config.name}" in names
    for room in ("jaxocean", "fitting", "experiments"):
        assert f"{room}/__init__.py" in names
    for data in ("optics/cie_1931.csv", "optics/sky/hosek_wilkie.npz", "optics/sky/hosek_wilkie.txt"):
        assert f"jaxocean/{data}" in names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not [name for name in names if name.startswith(("tests", "benchmarks", "docs"))]


def test_list_and_show_work_from_the_wheel_outside_of_the_clone(installed, tmp_path):
    listed = jaxocean(installed, tmp_path, "list")
    assert listed.returncode == 0, listed.stderr
    for config in (PROJECT / "configs").glob("*.yaml"):
        assert config.stem in listed.stdout
    shown = jaxocean(installed, tmp_path, "show", "spectrum")
    assert str(installed / "experiments" / "configs" / "spectrum.yaml") in shown.stdout.replace("\n", "")


def test_the_main_job_runs_from_the_wheel_outside_of_the_clone_and_is_found_again(installed, tmp_path):
    fewer = ("wind.speed=[8.0,12.0,16.0]", "breaking_wavenumbers=[73.0]", "realisations=0")
    command = ("run", "calibrate_monahan", *fewer)
    first = jaxocean(installed, tmp_path, *command)
    assert first.returncode == 0, first.stderr
    (folder,) = (tmp_path / "runs").iterdir()
    assert (folder / "result.json").is_file()
    again = jaxocean(installed, tmp_path, *command)
    assert again.returncode == 0, again.stderr
    assert "Found again" in again.stdout
    assert again.stderr == ""
    summary = (folder / "summary.txt").read_text()
    assert first.stdout.startswith(summary)
    assert again.stdout.startswith(summary)


def test_constraints_are_plain_versions_of_everything_that_is_required():
    lines = [
        line for line in (PROJECT / "constraints.txt").read_text().splitlines() if not line.startswith("#")
    ]
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.]+", line) for line in lines)
    pinned = {canonical(line.split("==")[0]) for line in lines}
    extras = PYPROJECT["project"]["optional-dependencies"].values()
    for requirement in [*PYPROJECT["project"]["dependencies"], *(r for extra in extras for r in extra)]:
        name = canonical(re.split(r"[\[<>=!~; ]", requirement)[0])
        assert name == "jaxocean" or name in pinned, requirement


def canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def test_the_check_runs_exactly_the_readmes_test_command():
    readme = (PROJECT / "README.md").read_text()
    assert re.search(r'^pip install -c constraints\.txt -e "\.\[test\]" && pytest$', readme, re.MULTILINE)
    script = PROJECT / ".ci" / "run"
    assert os.access(script, os.X_OK)
    assert "README.md" in script.read_text()
    subprocess.run(["bash", "-n", str(script)], check=True)
