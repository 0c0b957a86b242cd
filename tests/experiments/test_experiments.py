"""The experiments that describe seas, on small grids: what they leave and whether the numbers are right."""

import json

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from experiments.harness._execute import execute
from experiments.harness._loading import load

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


def test_the_classic_graphics_sea_is_the_students_case():
    config = load("tessendorf_report").config
    assert config.cascade.resolution == 256
    assert config.cascade.sizes == (1000.0,)
    assert config.wind.speed == 30.0
    assert config.wind.direction == pytest.approx(np.pi / 4)
    assert config.spectrum.amplitude == 6e-7
