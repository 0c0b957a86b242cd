"""Sweeps of toys in this process: what is in the store, what fails, what is found again, what is refused."""

import io
import json
import re
import shutil
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import zarr
from _sweep_toys import compute, computed, plan
from rich.console import Console

from experiments.harness._errors import UserError
from experiments.harness._lock import locked
from experiments.harness._quantity import shown, udunits, unit_of_name
from experiments.sweeps import find_finished, meter
from experiments.sweeps._executors import Inline
from experiments.sweeps._export import _rows
from experiments.sweeps._meter import clock, in_words, speed
from experiments.sweeps._single import _columns
from experiments.sweeps._task import reason_of


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    """A finished cartesian sweep of numbers and names, run by run: the folder and its netCDF file."""
    folder = tmp_path_factory.mktemp("grid")
    log = folder / "log"
    values = ("name=bee,ant", "value=0:6:2", "refuses=4", f"log={log}")
    return folder, values, compute(plan(folder, "runs", *values))


def test_a_cartesian_sweep_has_one_dimension_per_key(grid):
    _, _, data = grid
    assert data["square_m"].dims == ("name_index", "value")
    assert data["value"].values.tolist() == [0, 2, 4, 6]
    assert data["name"].values.tolist() == ["bee", "ant"]
    np.testing.assert_array_equal(data["square_m"], [[0, 4, np.nan, 36]] * 2)
    np.testing.assert_array_equal(data["is_bee"], [[1, 1, np.nan, 1], [0, 0, np.nan, 0]])


def test_numbers_are_collected_by_their_dotted_names_and_keep_their_shape(grid):
    _, _, data = grid
    assert data["nested_list_of_numbers"].dims[:2] == ("name_index", "value")
    np.testing.assert_array_equal(data["nested_list_of_numbers"][0, 1], [2, np.nan, 3])
    np.testing.assert_array_equal(data["rows_x"][1, 3], [6, -6])
    assert data["nested_list_of_numbers"].attrs["long_name"] == "nested.list, of numbers"
    # The key `value` is the coordinate; the result of that name stands beside it.
    np.testing.assert_array_equal(data["result_value"][0], [0, 2, np.nan, 6])
    assert not {"nested_text", "nested_nothing", "rows_name"} & set(data.variables)


def test_lists_of_several_lengths_end_in_nan(tmp_path):
    nan = np.nan
    expected = [[0, nan, nan], [0, 1, nan], [0, 1, 2], [0, nan, nan]]
    forward = compute(plan(tmp_path, "runs", "value=0:3:1"))["ragged"].values
    np.testing.assert_array_equal(forward, expected)


def test_variables_carry_units_and_names(grid):
    _, _, data = grid
    assert data["square_m"].attrs["units"] == "m"
    assert data["value"].attrs == {"units": "1", "long_name": "a number", "config_key": "value"}
    assert data.attrs["Conventions"] == "CF-1.11"
    assert data["done"].dtype == np.int8
    assert data["done"].attrs["flag_meanings"] == "not_done done"


def test_one_failed_point_is_recorded_with_its_reason_and_stops_nothing(grid):
    _, _, data = grid
    np.testing.assert_array_equal(data["done"], [[1, 1, 0, 1]] * 2)
    assert data["reason"].values[:, 2].tolist() == ["The toy must not be 4."] * 2
    assert set(data["reason"].values[data["done"].values == 1]) == {""}


def test_the_zarr_store_says_the_same_point_by_point(grid):
    folder, values, data = grid
    store = plan(folder, "runs", *values).folder / "results.zarr"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        points = xr.open_zarr(store, consolidated=False, chunks=None).load()
    assert set(points.coords) == {"name", "value"}
    for name in ("square_m", "done", "reason", "rows_x"):
        flat = data[name].values.reshape(8, *data[name].shape[2:])
        np.testing.assert_array_equal(points[name].values.astype(flat.dtype), flat)
    assert points["name"].values.tolist() == ["bee"] * 4 + ["ant"] * 4
    assert points.attrs["title"].startswith("Sweep of runs")


def test_a_folder_holds_config_design_provenance_tables_and_words(grid):
    folder, values, _ = grid
    sweep = plan(folder, "runs", *values)
    finished = find_finished(sweep)
    assert finished is not None
    present = {path.name for path in finished.folder.iterdir()}
    assert present == {
        "config.yaml",
        "provenance.json",
        "report.md",
        "result.json",
        "results.nc",
        "results.zarr",
        "summary.txt",
        "sweep.json",
        "sweep.png",
    }
    about = json.loads((finished.folder / "sweep.json").read_text())
    assert about["hash"] == sweep.digest
    assert about["axes"][1] == {"key": "value", "values": [0, 2, 4, 6]}
    assert "2 of them: The toy must not be 4." in finished.summary()
    report = (finished.folder / "report.md").read_text()
    assert "6 of 8 points of `name`, `value` were computed; 2 failed." in report
    assert "`square_m` goes from 0 to 36" in report
    code = report.partition("```python")[2].partition("```")[0]
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=finished.folder, capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_report_says_what_changes_how_much_over_which_key(tmp_path):
    sweep = plan(tmp_path, "batch", "x=1:5:1", "y=0,3")
    compute(sweep)
    report = (sweep.folder / "report.md").read_text()
    # x^2 + y: the means over y are 2.5 and 26.5, those over x 11 and 14.
    assert (
        "`result` (means over the other keys): over `x` from 1 to 5 m/s it goes from 2.5 to 26.5 m" in report
    )
    assert "over `y` from 0 to 3 m it goes from 11 to 14 m (+27 %)" in report
    assert "`root` (means over the other keys): over `x`" in report
    assert "it does not depend on `y`" in report
    assert "![what changes over the swept keys](sweep.png)" in report


def test_undefined_numbers_are_called_so(tmp_path):
    sweep = plan(tmp_path, "batch", "x=-4:-1:1")
    data = compute(sweep)
    assert data["root"].attrs["comment"] == "NaN where it is undefined"
    assert "comment" not in data["result"].attrs
    finished = find_finished(sweep)
    assert finished is not None
    summary = " ".join(finished.summary().split())
    assert "root undefined undefined undefined" in summary
    assert "`root` is undefined at all 4 points" in summary


@pytest.mark.parametrize(
    ("values", "kind", "panels", "lines"),
    [
        (("x=1:5:1",), "cartesian", 3, 5),
        (("x=1:5:1", "y=0,3"), "cartesian", 3, 2),
        (("x=1:5:1", "y=0,3", "power=1,2"), "cartesian", 9, 20),
        (("x=0.5:2.5", "y=1:9"), "sobol", 6, 64),
        (("y=null,2.5,[1.0,2.0]",), "cartesian", 1, 3),
    ],
)
def test_every_kind_of_sweep_has_its_picture(tmp_path, monkeypatch, values, kind, panels, lines):
    """Panels with something in them; the first has so many lines, or points where one line holds them."""
    figures = []
    from experiments.harness._files import Files

    whole = Files.picture
    monkeypatch.setattr(Files, "picture", lambda self, n, fig: (figures.append(fig), whole(self, n, fig)))
    points = 64 if kind == "sobol" else None
    sweep = plan(tmp_path, "batch", *values, kind=kind, points=points)
    compute(sweep)
    assert (sweep.folder / "sweep.png").stat().st_size > 10_000
    (figure,) = figures
    filled = [axes for axes in figure.axes if axes.lines]
    assert len(filled) == panels
    assert all(axes.get_ylabel() for axes in filled[:1])
    first = filled[0].lines
    assert lines in (len(first), first[0].get_xdata().size)
    assert any(axes.get_xlabel() in ("x (m/s)", "y") for axes in filled)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("m s-1", "m/s"), ("rad m-1", "rad/m"), ("1", "-"), ("m-2", "m^-2"), ("m2 s", "m^2 s")],
)
def test_units_of_data_are_shown_as_configs_write_them(unit, expected):
    assert shown(unit) == expected


def test_only_unfinished_and_on_demand_failed_points_are_computed_again(tmp_path):
    log, mended = tmp_path / "log", tmp_path / "mended"
    values = ("value=0:9:1", "refuses=4", f"log={log}", f"mended={mended}")
    compute(plan(tmp_path, "runs", *values))
    assert computed(log) == list(range(10))
    sweep = plan(tmp_path, "runs", *values)
    group = zarr.open_group(sweep.folder / "results.zarr", mode="r+", use_consolidated=False)
    group["done"][6:8] = 0  # as if it had been killed there
    log.unlink()
    compute(sweep)
    assert computed(log) == [6, 7]
    log.unlink()
    mended.touch()
    assert compute(sweep)["done"].values.tolist() == [1, 1, 1, 1, 0, 1, 1, 1, 1, 1]
    assert computed(log) == []
    data = compute(sweep, retry_failed=True)
    assert computed(log) == [4]
    assert data["done"].values.all()
    assert data["square_m"].values[4] == 16
    assert "reason" not in data
    log.unlink()
    compute(sweep, force=True)
    assert computed(log) == list(range(10))


def test_reasons_in_the_store_do_not_speak_of_a_command_line():
    error = UserError("Key `value` on the command line must be at least 0, but is -1.")
    assert reason_of(error) == "Key `value` at this point must be at least 0, but is -1."


def test_a_mistake_of_ours_is_a_reason_too(tmp_path):
    data = compute(plan(tmp_path, "runs", "value=1,2", "breaks=2"))
    assert data["reason"].values[1] == "KeyError: 'a mistake of ours' (unexpected)"


def test_a_sweep_in_which_nothing_works_says_why_and_keeps_its_store(tmp_path):
    sweep = plan(tmp_path, "batch", "power=9", "x=1,2,3")
    with pytest.raises(UserError, match=r"None of the 3 points could be computed: .*Nine is too much"):
        compute(sweep)
    assert find_finished(sweep) is None
    assert sweep.folder.is_dir()


def test_points_of_several_shapes_are_vmapped_apart_and_land_at_their_places(tmp_path):
    values = ("y=null,2.5,[1.0,2.0],[1.0,2.0,3.0]", "power=0,1,9,3", "x=-2:700:1.5")
    sweep = plan(tmp_path, "batch", *values)
    data = compute(sweep)
    assert data["result"].shape == (4, 4, 469)
    x, powers, sums = data["x"].values, np.array([0, 1, 9, 3]), np.array([0, 2.5, 3, 6])
    expected = x ** np.sort(powers)[:, None] + sums[:, None, None]
    expected[:, 3] = np.nan
    np.testing.assert_allclose(data["result"], expected, rtol=1e-14)
    assert "Nine is too much" in str(data["reason"].values[0, 3, 0])
    np.testing.assert_array_equal(np.isnan(data["root"].values[0, 0]), x < 0)
    assert data["done"].values[:, :3].all()


def test_a_number_that_must_be_one_and_is_not_fails_its_point(tmp_path):
    data = compute(plan(tmp_path, "batch", "x=-101,-100,-99"))
    assert data["done"].values.tolist() == [0, 0, 1]
    assert data["reason"].values.tolist() == [
        "The number `log` came out as nan.",
        "The number `log` came out as -inf.",
        "",
    ]
    assert np.isnan(data["result"].values[:2]).all()


def test_batched_points_out_of_range_are_found_each(tmp_path, monkeypatch):
    sweep = plan(tmp_path, "batch", "x=1:5:1")
    monkeypatch.setattr("_sweep_toys.BatchConfig._most", 3.0)
    data = compute(sweep)
    assert data["done"].values.tolist() == [1, 1, 1, 0, 0]
    assert data["reason"].values[3] == "Key `x` at this point must be at most 3, but is 4."


@pytest.mark.parametrize("kind", ["zip", "random", "sobol"])
def test_designs_that_are_no_grid_lie_along_points(tmp_path, kind):
    drawn = kind != "zip"
    values = ("x=0.5:2.5", "y=1:9") if drawn else ("x=0.5,2.5,1.5", "y=1,1,[2.0,1.0]")
    data = compute(plan(tmp_path, "batch", *values, kind=kind, points=700 if drawn else None))
    assert data["result"].dims == ("point",)
    assert set(data.coords) == {"x", "y"}
    if drawn:
        np.testing.assert_allclose(data["result"], data["x"] ** 2 + data["y"], rtol=1e-14)
    else:
        assert data["y"].values.tolist() == ["1", "1", "[2.0,1.0]"]
        np.testing.assert_allclose(data["result"], [1.25, 7.25, 5.25])


def test_netcdf_files_of_grids_lists_and_draws_pass_the_cf_checker(grid, tmp_path):
    folder, values, _ = grid
    plans = [
        plan(folder, "runs", *values),
        plan(tmp_path, "batch", "x=0.5,2.5,1.5", "y=1,1,[2.0,1.0]", kind="zip"),
        plan(tmp_path, "batch", "x=-101:2", "y=1:4", kind="random", points=20),
    ]
    for each in plans[1:]:
        compute(each)
    checker = Path(sys.executable).parent / "compliance-checker"
    checked = subprocess.run(
        [checker, "-t", "cf:1.11", *(each.folder / "results.nc" for each in plans)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert checked.stdout.count("All tests passed!") == 3


def test_numbers_whose_names_differ_in_punctuation_only_are_both_kept():
    columns, notes = _columns(
        [{"a.b": np.asarray(1.0), "a b": np.asarray(2.0)}, {"c": np.zeros(2), "d": np.ones(2)}]
    )
    assert {name: column.values[0].tolist() for name, column in columns.items() if name[0] == "a"} == {
        "a_b": 1,
        "a_b_": 2,
    }
    assert not notes
    _, notes = _columns([{"a": np.asarray(1.0)}, {"a": np.zeros(2)}])
    assert "number at some points and a list at others" in notes[0]


def test_chunks_do_not_change_the_numbers(tmp_path, monkeypatch):
    (tmp_path / "small").mkdir()
    values = ("x=0.5:2.5", "y=1:9")
    one = compute(plan(tmp_path, "batch", *values, kind="random", points=2000))
    monkeypatch.setattr("experiments.sweeps._sweep.SMALLEST", 64)
    sweep = plan(tmp_path / "small", "batch", *values, kind="random", points=2000)
    many = compute(sweep)
    assert len(list((sweep.folder / "results.zarr" / "done" / "c").iterdir())) > 20
    xr.testing.assert_equal(one, many)


@pytest.mark.parametrize(("shape", "inner"), [((3, 5, 7), 1), ((40, 2), 3), ((9,), 1), ((2, 3, 4, 5), 2)])
def test_blocks_of_a_grid_follow_each_other_and_stay_small(shape, inner, monkeypatch):
    monkeypatch.setattr("experiments.sweeps._export.BLOCK", 16)
    numbers = np.arange(np.prod(shape)).reshape(shape)
    last = 0
    for where, start, stop in _rows(shape, inner):
        assert start == last
        assert numbers[where].ravel().tolist() == list(range(start, stop))
        assert (stop - start) * inner <= max(16, inner)
        last = stop
    assert last == numbers.size


def test_a_store_of_another_sweep_is_refused_and_kept(tmp_path):
    first, second = (plan(tmp_path, "runs", f"value=1,{last}") for last in (2, 3))
    compute(first)
    shutil.copytree(first.folder, second.folder)
    with pytest.raises(UserError, match=r"belongs to another sweep \(of runs, 2 points\).*--output"):
        compute(second)
    assert find_finished(second) is None
    assert (second.folder / "results.nc").is_file()
    assert compute(second, force=True)["square_m"].values.tolist() == [1, 9]


@pytest.mark.parametrize("damage", ["sweep.json", "results.zarr/zarr.json", "results.zarr/done/zarr.json"])
def test_a_damaged_store_is_one_sentence(tmp_path, damage):
    sweep = plan(tmp_path, "runs", "value=1,2")
    compute(sweep)
    (sweep.folder / damage).write_text("{")
    with pytest.raises(UserError, match="--force") as error:
        compute(sweep)
    assert "\n" not in str(error.value)


def test_two_commands_do_not_write_one_store(tmp_path):
    sweep = plan(tmp_path, "runs", "value=1,2")
    sweep.folder.parent.mkdir()
    with locked(sweep.folder), pytest.raises(UserError, match="Another process is working on"):
        compute(sweep)
    compute(sweep)
    assert [path.name for path in sweep.folder.parent.iterdir()] == [sweep.folder.name]


def test_an_error_of_a_task_comes_out_of_its_future():
    with Inline() as executor:
        assert executor.submit(divmod, 7, 2).result() == (3, 1)
        assert isinstance(executor.submit(divmod, 7, 0).exception(), ZeroDivisionError)


def test_the_meter_tells_points_failures_rate_and_time_left_on_a_terminal():
    screen = io.StringIO()
    console = Console(file=screen, force_terminal=True, width=120)
    with meter(console, "toys", 1000, 100, 0) as advance:
        for _ in range(3):
            advance(100, 1)
            time.sleep(0.02)
    shown = screen.getvalue()
    assert "400/1000" in shown
    assert "toys (3 failed)" in shown
    assert re.search(r"[\d,]+ points/s · 0:00:0\d left", shown)


def test_the_meter_is_one_line_where_there_is_no_terminal():
    screen = io.StringIO()
    with meter(Console(file=screen, force_terminal=False), "toys", 1000, 100, 0) as advance:
        advance(900, 0)
    assert screen.getvalue() == "Sweeping toys: 1,000 points, 100 are there already …\n"


def test_the_rate_leaves_out_the_first_task_which_waits_for_compilation():
    assert speed([(0.0, 50)], 5.0) is None
    assert speed([(0.0, 50), (4.0, 90)], 8.0) == 5.0
    assert speed([(0.0, 50), (10.0, 60), (12.0, 160), (14.0, 260)], 99.0) == 50.0


@pytest.mark.parametrize(
    ("rate", "words"),
    [(12345.6, "12,346 points/s"), (1.26, "1.3 points/s"), (0.5, "30 points/min"), (0.001, "3.6 points/h")],
)
def test_rates_are_told_in_the_unit_that_reads_best(rate, words):
    assert in_words(rate) == words


@pytest.mark.parametrize(("seconds", "text"), [(59.6, "0:01:00"), (3661, "1:01:01"), (90061, "1 d 1:01:01")])
def test_durations_are_told_as_hours_minutes_and_seconds(seconds, text):
    assert clock(seconds) == text


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("m/s", "m s-1"), ("rad/m", "rad m-1"), ("m^-2", "m-2"), ("-", "1"), ("", "1"), ("K", "K")],
)
def test_units_of_configs_are_written_as_udunits_has_them(unit, expected):
    assert udunits(unit) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("peak_period_s", "s"),
        ("files.a.wave_height_m", "m"),
        ("wind_speed_m_per_s", "m s-1"),
        ("k_rad_per_m", "rad m-1"),
        ("jacobian_variance", "1"),
    ],
)
def test_the_name_of_a_number_tells_its_unit(name, expected):
    assert unit_of_name(name) == expected
