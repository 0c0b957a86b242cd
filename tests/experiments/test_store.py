"""Finished runs: found again by what decides them, written as a whole or not at all."""

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import _toy
import pytest
import xarray as xr
from _toy import TOYS, load_toy

import experiments
from experiments.harness import _execute
from experiments.harness._errors import UserError
from experiments.harness._execute import execute, find_finished
from experiments.harness._loading import load
from experiments.harness._store import RunWriter, identity, remove_stale


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


def test_a_run_leaves_its_config_result_provenance_summary_and_data(tmp_path):
    loaded = load_toy(tmp_path, "seed=7")
    finished = execute(loaded)
    assert finished.folder == tmp_path / "runs" / f"play-{identity(loaded)[:8]}"
    assert finished.files() == ["config.yaml", "numbers.nc", "provenance.json", "result.json", "summary.txt"]
    assert json.loads((finished.folder / "result.json").read_text()) == {"value": 3.0, "nothing": None}
    origin = finished.provenance()
    assert origin["seed"] == 7
    assert origin["hash"] == identity(loaded)
    assert {"jaxocean", "jax", "jaxlib", "numpy", "python"} <= set(origin["versions"])
    assert "cpu" in origin["device"].lower()
    assert "bear" in finished.summary()
    assert "A note." in finished.summary()


def test_the_saved_config_repeats_the_run(tmp_path):
    finished = execute(load_toy(tmp_path, "value=4.5"))
    again = load_toy(tmp_path)
    text = (finished.folder / "config.yaml").read_text()
    (tmp_path / "play.yaml").write_text(text)
    copy = load(str(tmp_path / "play.yaml"), output=again.config.output, experiments=TOYS)
    assert identity(copy) == finished.provenance()["hash"]


def test_data_carry_units_and_conventions(tmp_path):
    finished = execute(load_toy(tmp_path))
    with xr.open_dataset(finished.folder / "numbers.nc") as data:
        assert data.attrs["Conventions"] == "CF-1.11"
        assert data.attrs["band"] == "none"
        assert data["height"].attrs == {"units": "m", "long_name": "height of a toy"}
        assert data["height"].values.tolist() == [3.0, 2.0]
        assert "_FillValue" not in data["x"].encoding or data["x"].encoding["_FillValue"] is None


def test_a_finished_run_is_found_and_only_by_the_same_config(tmp_path):
    loaded = load_toy(tmp_path)
    assert find_finished(loaded) is None
    execute(loaded)
    assert find_finished(load_toy(tmp_path, "title=other")) is not None
    assert find_finished(load_toy(tmp_path, "value=3.5")) is None
    assert find_finished(load_toy(tmp_path, "seed=1")) is None


def test_the_identity_covers_the_contents_of_input_files_and_the_version(tmp_path, monkeypatch):
    source = tmp_path / "source.csv"
    source.write_text("1")
    before = identity(load_toy(tmp_path, f"source={source}"))
    source.write_text("2")
    after = identity(load_toy(tmp_path, f"source={source}"))
    assert before != after
    monkeypatch.setattr("experiments.harness._store.version", lambda: "99")
    assert identity(load_toy(tmp_path, f"source={source}")) != after


def test_a_folder_that_lost_its_result_does_not_count(tmp_path):
    finished = execute(load_toy(tmp_path))
    (finished.folder / "result.json").unlink()
    assert find_finished(load_toy(tmp_path)) is None
    assert find_finished(load_toy(tmp_path)) is None
    execute(load_toy(tmp_path))
    assert find_finished(load_toy(tmp_path)) is not None


@pytest.mark.parametrize(
    ("behaviour", "error"), [("user", ValueError), ("bug", KeyError), ("interrupt", KeyboardInterrupt)]
)
def test_a_failed_or_interrupted_run_leaves_nothing(tmp_path, behaviour, error):
    with pytest.raises(error):
        execute(load_toy(tmp_path, f"behaviour={behaviour}"))
    assert names(tmp_path / "runs") == []


def test_a_failed_repetition_keeps_the_earlier_run(tmp_path, monkeypatch):
    loaded = load_toy(tmp_path)
    execute(loaded)

    def broken(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("_toy.run", broken)
    with pytest.raises(KeyboardInterrupt):
        execute(loaded)
    assert find_finished(loaded) is not None
    assert len(names(tmp_path / "runs")) == 1


def test_an_error_of_the_rooms_becomes_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(_execute, "ROOMS", ("_toy",))
    with pytest.raises(UserError, match=r"^Argument `value` must please somebody\.$"):
        execute(load_toy(tmp_path, "behaviour=user"))


def test_a_value_error_from_elsewhere_keeps_its_traceback(tmp_path):
    with pytest.raises(ValueError, match="please somebody"):
        execute(load_toy(tmp_path, "behaviour=user"))
    assert names(tmp_path / "runs") == []


def test_a_warning_of_the_rooms_becomes_a_note(tmp_path, monkeypatch):
    monkeypatch.setattr(_execute, "ROOMS", ("_toy",))
    finished = execute(load_toy(tmp_path, "behaviour=warn"))
    assert "Warning: The law is outside its range." in finished.summary()


def test_a_killed_run_leaves_nothing_finished_and_the_next_one_cleans_up(tmp_path):
    process = subprocess.Popen(
        [sys.executable, str(Path(_toy.__file__)), str(tmp_path), "behaviour=sleep"],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(Path(experiments.__file__).parents[1])},
    )
    assert process.stdout is not None
    assert process.stdout.readline().strip() == "asleep"
    partial = names(tmp_path / "runs")
    assert len(partial) == 1
    assert partial[0].endswith(".partial")
    # While it lives, nobody removes its folder.
    remove_stale(tmp_path / "runs")
    assert names(tmp_path / "runs") == partial
    process.send_signal(signal.SIGKILL)
    process.wait(timeout=30)
    process.stdout.close()
    assert find_finished(load_toy(tmp_path, "behaviour=sleep")) is None
    finished = execute(load_toy(tmp_path))
    assert names(tmp_path / "runs") == [finished.folder.name]


def test_a_run_that_died_while_replacing_gives_the_earlier_one_back(tmp_path):
    loaded = load_toy(tmp_path)
    finished = execute(loaded)
    dead = dead_process()
    host = socket.gethostname().replace(".", "_")
    os.replace(
        finished.folder, finished.folder.with_name(f".{finished.folder.name}.{host}.{dead}.0123abcd.replaced")
    )
    assert find_finished(loaded) is None
    remove_stale(tmp_path / "runs")
    assert find_finished(loaded) is not None


def dead_process() -> int:
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait(timeout=30)
    return process.pid


def test_folders_of_other_machines_and_of_users_are_left_alone(tmp_path):
    for name in (".a-1.elsewhere.1.0123abcd.partial", ".hidden", "mine", "x.partial"):
        (tmp_path / name).mkdir()
    before = names(tmp_path)
    remove_stale(tmp_path)
    assert names(tmp_path) == before


def test_an_unwritable_output_folder_is_one_clear_sentence(tmp_path):
    (tmp_path / "runs").write_text("a file where a folder should be")
    with pytest.raises(UserError, match=r"output folder .*runs cannot be written .*--output"):
        execute(load_toy(tmp_path))


def test_a_run_cannot_finish_without_its_files(tmp_path):
    with RunWriter(tmp_path / "run") as writer, pytest.raises(RuntimeError, match=r"result\.json"):
        writer.finish()
    assert names(tmp_path) == []
