"""The experiments that describe seas, on small grids: what they leave and whether the numbers are right."""

import io
import json
import re

import numpy as np
import pytest
import xarray as xr
from PIL import Image
from rich.console import Console

from experiments.common import _build
from experiments.harness._execute import execute
from experiments.harness._loading import load, shipped
from experiments.harness._progress import bars
from experiments.harness._report import render
from experiments.harness._result import Result, Table
from jaxocean.surface import Cascade

SMALL = ("cascade.resolution=32", "map.resolution=32")


@pytest.fixture(scope="module")
def sea_state(tmp_path_factory):
    """A finished run of `spectrum`."""
    return execute(load("spectrum", SMALL, output=str(tmp_path_factory.mktemp("runs"))))


def result_of(finished) -> dict:
    return json.loads((finished.folder / "result.json").read_text())


def test_spectrum_reports_the_reference_sea(sea_state):
    result = result_of(sea_state)
    # SciPy-checked values of the fully developed sea at 10 m/s, k from 1e-3 to 400 rad/m.
    assert result["significant_wave_height_m"] == pytest.approx(2.606, rel=1e-3)
    assert result["bands"][0]["mss"] == pytest.approx(0.05164, rel=1e-3)
    assert result["breaking_wavenumber_rad_per_m"] == pytest.approx(73.11, rel=1e-3)
    parts = sum(band["significant_wave_height_m"] ** 2 for band in result["bands"][1:])
    assert parts == pytest.approx(result["significant_wave_height_m"] ** 2, rel=0.02)


def test_spectrum_draws_every_picture_large_enough_to_read(sea_state):
    pictures = {path.stem: Image.open(path) for path in sea_state.folder.glob("*.png")}
    assert set(pictures) == {"spectrum", "directional", "height", "normal", "folding"}
    for name, picture in pictures.items():
        assert min(picture.size) > 500, name
        # A picture that shows something has many colours.
        assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 20, name


def test_spectrum_saves_fields_that_belong_together(sea_state):
    with xr.open_dataset(sea_state.folder / "sea.nc") as data:
        assert data["height"].dims == ("y", "x")
        assert data["jacobian"].attrs["units"] == "1"
        share = float((data["jacobian"] < 0.5).mean())
        spread = 4 * float(data["height"].std())
    assert share == pytest.approx(result_of(sea_state)["coverage_of_the_map"])
    assert 0.3 < spread / 2.606 < 2
    with xr.open_dataset(sea_state.folder / "spectrum.nc") as data:
        energy = data["energy"]
        height = 4 * np.sqrt(float(np.trapezoid(energy.values, data["frequency"].values)))
    assert height == pytest.approx(2.606, rel=0.03)


def test_report_is_headed_by_what_the_run_is_and_links_every_picture(sea_state, tmp_path):
    report = (sea_state.folder / "report.md").read_text()
    assert report.startswith("# Sea state: Elfouhaily at U10 = 10 m/s")
    for picture in sea_state.folder.glob("*.png"):
        assert f"({picture.name})" in report
    assert "Warning: the cascade does not hold" not in report
    storm = execute(load("spectrum", (*SMALL, "wind.speed=60"), output=str(tmp_path)))
    told = (storm.folder / "report.md").read_text()
    assert told.startswith("# Sea state: Elfouhaily at U10 = 60 m/s")
    assert "does not hold the peak" in told
    assert "U10 from 1 to 50 m/s, but here U10 = 60 m/s" in told
    held = np.sqrt(sum(band["significant_wave_height_m"] ** 2 for band in result_of(storm)["bands"][1:]))
    assert f"Hs = {held:.3g} m instead of" in told


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("spectrum.inverse_wave_age=0.84", None),
        ("spectrum.inverse_wave_age=6", "Ω = 6:"),
        ("wind.fetch=300", "Ω = "),
        ("wind.fetch=100e3", None),
        ("wind.speed=0.5", "U10 = 0.5 m/s"),
        ("spectrum={family: pierson_moskowitz}", None),
    ],
)
def test_winds_and_ages_that_the_spectrum_was_not_made_for_are_told(override, says):
    config = load("spectrum", [override]).config
    notes = _build.outside_validity(config.spectrum, config.wind)
    assert len(notes) == (says is not None)
    assert says is None or says in notes[0]


def test_a_peak_fits_if_the_largest_pattern_and_the_variance_suffice():
    cascade = Cascade(sizes=(100.0, 11.0), resolution=32)
    k = 2 * np.pi / 40
    assert _build.unheld_waves(cascade, k, 2.0, 1.99) == []
    assert "at least 101 m" in _build.unheld_waves(cascade, 40 / 40.2 * k, 2.0, 1.99)[0]
    assert "90.2 % of the height variance" in _build.unheld_waves(cascade, k, 2.0, 1.9)[0]


def test_tables_wrap_words_and_cut_nothing():
    columns = ("reading", *(f"a heading of several words, number {i}" for i in range(8)))
    rows = [("a sentence in a cell that is longer than its column can be", *map(float, range(8)))]
    text = render(Result(values={}, tables=(Table("Wide", columns, rows),)))
    assert "…" not in text
    assert set(rows[0][0].split()) <= set(text.split())
    assert max(map(len, text.splitlines())) <= 110


def test_log_tells_how_far_a_long_count_is(monkeypatch):
    monkeypatch.setattr("experiments.harness._progress.SECONDS", 0.0)
    log = io.StringIO()
    with bars(Console(file=log, force_terminal=False)) as progress:
        advance = progress.count("Seas", 3)
        for _ in range(3):
            advance()
    assert log.getvalue().splitlines() == ["Seas …", "Seas: 1 of 3 …", "Seas: 2 of 3 …"]


def test_titles_of_configs_hold_no_quantities_that_a_key_could_change():
    for path in shipped():
        assert not re.search(r"\d (m|s|km|m/s|x|rad/m)\b", load(str(path)).config.title), path


def test_the_classic_graphics_sea_is_the_students_case():
    config = load("tessendorf_report").config
    assert config.cascade.resolution == 256
    assert config.cascade.sizes == (1000.0,)
    assert config.wind.speed == 30.0
    assert config.wind.direction == pytest.approx(np.pi / 4)
    assert config.spectrum.amplitude == 6e-7
