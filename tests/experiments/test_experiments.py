"""The experiments that describe seas, on small grids: what they leave and whether the numbers are right."""

import json
import os
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from PIL import Image

import jaxocean as jo
from experiments._errors import UserError
from experiments._execute import execute
from experiments._loading import load

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


@pytest.fixture(scope="module")
def made_sea(tmp_path_factory):
    """A finished run of `measured_sea` where no measured files are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JAXOCEAN_DATA", "/nowhere")
        return execute(load("measured_sea", ["wind.speed=12"], output=str(tmp_path_factory.mktemp("runs"))))


def test_measured_sea_makes_a_file_where_there_is_none(made_sea):
    assert "made_here.nc" in made_sea.files()
    assert "No measured files were found" in made_sea.summary()
    made = result_of(made_sea)["files"]["made_here"]
    sea = jo.spectra.JONSWAP.from_fetch(jo.Wind(12.0), fetch=200e3)
    assert made["significant_wave_height_m"][0] == pytest.approx(float(sea.significant_wave_height), rel=0.02)
    assert made["peak_period_s"][0] == pytest.approx(float(sea.peak_period), rel=0.03)
    assert 0 < made["coverage_projected"][0] < made["coverage_rest"][0]


def test_measured_sea_names_its_tail_everywhere(made_sea):
    assert result_of(made_sea)["tail"] == {"law": "power", "exponent": -5.0}
    assert "tail f^-5" in made_sea.summary()
    with xr.open_dataset(made_sea.folder / "made_here_records.nc") as data:
        assert data.attrs["tail"] == "f^-5"
        assert data.attrs["breaking_wavenumber_rad_per_m"] == pytest.approx(73.11, rel=1e-3)
        assert data["significant_wave_height"].attrs["standard_name"] == "sea_surface_wave_significant_height"


def test_measured_sea_agrees_with_the_library_on_its_own_file(made_sea):
    spectrum = jo.io.read_spectrum(made_sea.folder / "made_here.nc", cut_off=0.4)
    stats = jo.whitecaps.strain_statistics(
        spectrum, 1.0, band=(1e-3, 400.0), breaking_wavenumber=np.pi * 256 / 11
    )
    expected = float(jo.whitecaps.ExactClosure()(stats, jnp.asarray(0.5)))
    assert result_of(made_sea)["files"]["made_here"]["coverage_projected"][0] == pytest.approx(
        expected, rel=1e-3
    )


@pytest.mark.parametrize(
    ("content", "says"), [("hello\n", "not a spectrum of a known format"), (None, "There is no file")]
)
def test_measured_sea_refuses_what_is_no_spectrum_in_one_sentence(tmp_path, content, says):
    path = tmp_path / "file.txt"
    if content is not None:
        path.write_text(content)
    with pytest.raises(UserError, match=says) as error:
        execute(load("measured_sea", [f"files=[{path}]"], output=str(tmp_path / "runs")))
    assert "\n" not in str(error.value)
    assert not list((tmp_path / "runs").iterdir())


def test_a_missing_wavespectra_is_one_sentence_that_names_the_extra(tmp_path, monkeypatch):
    import sys

    path = tmp_path / "some.spec"
    path.write_text("SWAN   1\n")
    monkeypatch.setitem(sys.modules, "wavespectra", None)
    with pytest.raises(UserError, match=r"pip install jaxocean\[spectra\]"):
        execute(load("measured_sea", [f"files=[{path}]"], output=str(tmp_path / "runs")))


DATA = Path(os.environ.get("JAXOCEAN_DATA", "../shared/data")) / "spectra"


@pytest.mark.skipif(not DATA.is_dir(), reason="the folder of measured spectra (JAXOCEAN_DATA) is absent")
def test_measured_sea_reads_every_kind_of_file(tmp_path):
    finished = execute(load("measured_sea", ["records=3"], output=str(tmp_path / "runs")))
    files = result_of(finished)["files"]
    assert set(files) == {"41010", "spotter_20210929", "swanfile", "triaxys", "ww3file"}
    heights = {name: values["significant_wave_height_m"] for name, values in files.items()}
    # As the buoy itself reported it.
    assert heights["triaxys"][0] == pytest.approx(3.41, rel=0.02)
    assert all(0.5 < height < 4.5 for each in heights.values() for height in each)
    assert len(heights["41010"]) == 3
