"""`measured_sea`: records by the thousand, whose winds count, and files that are none."""

import json
import os
import subprocess
import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr

import jaxocean as jo
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.harness._progress import Silent
from experiments.records import _measured_records
from jaxocean import io

K_B = np.pi * 256 / 11
DATA = Path(os.environ.get("JAXOCEAN_DATA", "../shared/data")) / "spectra"


def result_of(finished) -> dict:
    return json.loads((finished.folder / "result.json").read_text())


def many(records: int, *, wind: bool = True, source: str = "a model") -> xr.Dataset:
    """A sea that grows record by record, in wavespectra's convention."""
    one = io.dataset_from_spectrum(jo.spectra.JONSWAP(significant_wave_height=2.0, peak_period=7.0))
    growth = np.linspace(0.3, 1.5, records)
    dataset = one.isel(time=np.zeros(records, int)).copy(deep=True)
    dataset["efth"] = dataset["efth"] * xr.DataArray(growth, dims="time")
    dataset["efth"].attrs = one["efth"].attrs
    hours = np.arange(records) * np.timedelta64(3600, "s")
    dataset = dataset.assign_coords(time=np.datetime64("2020-06-01", "ns") + hours)
    if wind:
        dataset["wspd"] = ("time", np.linspace(4, 12, records))
        dataset["wdir"] = ("time", np.full(records, 200.0))
    dataset.attrs["source"] = source
    return dataset


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    """A file of 150 records with a wind; the eleventh has gaps."""
    path = tmp_path_factory.mktemp("sea") / "buoy.nc"
    dataset = many(150)
    dataset["efth"][10, 3] = np.nan
    dataset.to_netcdf(path)
    return path


@pytest.fixture(scope="module")
def run(file):
    """A finished run on it: three batches."""
    return execute(load("measured_sea", [f"files=[{file}]"], output=str(file.parent / "runs")))


@pytest.fixture(scope="module")
def data(run):
    with xr.open_dataset(run.folder / "buoy_records.nc") as dataset:
        return dataset.load()


def test_every_record_of_a_file_is_used_unless_it_has_gaps(run, data):
    assert data.sizes == {"time": 149}
    assert result_of(run)["records_left_out"] == 1
    assert np.datetime64("2020-06-01T10:00") not in data["time"].values
    assert (np.diff(data["significant_wave_height"].values) > 0).all()
    assert "missing values" in run.summary()


@pytest.mark.parametrize("i", [0, 70, 148])
def test_a_record_of_a_batch_agrees_with_the_record_alone(file, data, i):
    record = i if i < 10 else i + 1
    spectrum = io.read_spectrum(file, record=record, cut_off=0.4, tail_bins=4)
    stats = jo.whitecaps.strain_statistics(spectrum, 1.0, band=(1e-3, 400.0), breaking_wavenumber=K_B)
    expected = jo.whitecaps.ExactClosure("projected")(stats, jnp.asarray(0.65))
    one = data.isel(time=i)
    np.testing.assert_allclose(one["coverage_projected"], expected, rtol=1e-6)
    np.testing.assert_allclose(one["coverage_projected_tail_5"], expected, rtol=1e-6)
    assert float(one["coverage_projected_tail_4"]) > float(expected)
    assert float(one["coverage_projected_low"]) < float(expected) < float(one["coverage_projected_high"])


def test_laws_are_those_of_the_files_wind(data):
    speeds = np.delete(np.linspace(4, 12, 150), 10)
    np.testing.assert_allclose(data["wind_speed"], speeds)
    np.testing.assert_allclose(data["coverage_coare_3_6"], 7.3e-4 * (speeds - 2) ** 1.43)


def test_a_wind_that_the_waves_gave_is_held_against_nothing(tmp_path):
    path = tmp_path / "drifter.nc"
    many(4, source="Spotter wave buoy").to_netcdf(path)
    finished = execute(load("measured_sea", [f"files=[{path}]", "record=2"], output=str(tmp_path / "runs")))
    assert "derived from its waves, not measured: no law is held against it" in finished.summary()
    assert "derived from its waves" in (finished.folder / "report.md").read_text()
    with xr.open_dataset(finished.folder / "drifter_records.nc") as data:
        assert not [name for name in data.data_vars if "coare" in name or "callaghan" in name]
        assert data.attrs["wind"] == "derived"


def test_one_record_gives_numbers_that_a_sweep_can_collect(file, tmp_path, data):
    overrides = [f"files=[{file}]", "record=70"]
    values = result_of(execute(load("measured_sea", overrides, output=str(tmp_path / "runs"))))
    expected = float(data["coverage_projected"].sel(time="2020-06-03T22:00").item())
    assert values["mean_coverage_projected"] == pytest.approx(expected, rel=1e-6)
    assert values["files"]["buoy"]["coverage_projected"] == pytest.approx(expected, rel=1e-6)
    assert values["records"] == 1


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (["record=3"], [3]),
        (["record=[147,160]"], [147, 148, 149]),
        (["records=3"], [0, 74, 149]),
        (["times=[2020-06-01T05:00,2020-06-01T07:30]"], [5, 6, 7]),
        (["times=[2020-06-01T05:00,2020-06-01T07:30]", "record=6"], [6]),
        (["times=[2020-06-01T07:00+02:00,2020-06-01T07:30+02:00]"], [5]),
        (["times=[1999-01-01,1999-02-01]"], []),
    ],
)
def test_records_are_chosen_by_number_and_by_time(overrides, expected):
    dataset = many(150)
    records = io.SpectrumRecords(dataset).records()
    assert _measured_records.choose(dataset, records, load("measured_sea", overrides).config) == expected


def test_memory_does_not_grow_with_the_records(file):
    """What is alive at any time: a batch of tables, not all of them."""
    config = load("measured_sea", [f"files=[{file}]"]).config
    alive = []
    original = _measured_records._integrate
    with pytest.MonkeyPatch.context() as patch, jax.enable_x64(True):
        patch.setattr(
            _measured_records, "_integrate", lambda found, c: alive.append(len(found)) or original(found, c)
        )
        _measured_records.describe("buoy", io.open_spectra(file), config, Silent().count)
    assert max(alive) <= _measured_records.BATCH
    assert sum(alive) == 149


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (
            ["record=150"],
            r"ask for: buoy has 150 records .0 to 149. from 2020-06-01T00:00 to 2020-06-07T05:00",
        ),
        (["times=[1999-01-01,1999-02-01]"], "No file has a record that `record` and `times` ask for"),
        (["cut_off=0.01"], "Only 0 frequencies of the dataset have energy below the cut-off"),
    ],
)
def test_records_that_are_not_there_are_one_sentence(file, tmp_path, overrides, says):
    with pytest.raises(UserError, match=says):
        execute(load("measured_sea", [f"files=[{file}]", *overrides], output=str(tmp_path / "runs")))


@pytest.fixture(scope="module")
def made_sea(tmp_path_factory):
    """A finished run where no measured files are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JAXOCEAN_DATA", "/nowhere")
        return execute(load("measured_sea", ["wind.speed=12"], output=str(tmp_path_factory.mktemp("runs"))))


def test_a_file_is_made_where_there_is_none(made_sea):
    assert "made_here.nc" in made_sea.files()
    assert "No measured files were found" in made_sea.summary()
    made = result_of(made_sea)["files"]["made_here"]
    sea = jo.spectra.JONSWAP.from_fetch(jo.Wind(12.0), fetch=200e3)
    assert made["significant_wave_height_m"] == pytest.approx(float(sea.significant_wave_height), rel=0.02)
    assert made["peak_period_s"] == pytest.approx(float(sea.peak_period), rel=0.03)
    assert 0 < made["coverage_projected"] < made["coverage_rest"]


def test_the_tail_is_named_everywhere(made_sea):
    assert result_of(made_sea)["tail"] == {"law": "power", "exponent": -5.0}
    assert "tail f^-5" in made_sea.summary()
    assert "tail f^-5" in (made_sea.folder / "report.md").read_text()
    with xr.open_dataset(made_sea.folder / "made_here_records.nc") as data:
        assert data.attrs["tail"] == "f^-5"
        assert data.attrs["breaking_wavenumber_rad_per_m"] == pytest.approx(73.11, rel=1e-3)
        assert data["significant_wave_height"].attrs["standard_name"] == "sea_surface_wave_significant_height"


@pytest.fixture(scope="module")
def bad_files(file) -> dict[str, Path]:
    """Files that are no directional spectra, or none that can be trusted."""
    folder = file.parent
    paths = {name: folder / f"{name}.nc" for name in ("cut", "towards", "height", "empty", "none")}
    (folder / "text.txt").write_text("hello\n")
    paths["text"] = folder / "text.txt"
    paths["good"] = file
    paths["cut"].write_bytes(file.read_bytes()[:3000])
    (folder / "cut.csv").write_text("Battery Voltage (V) ,Epoch Time ,f_0\n4.0 ,16328")
    paths["csv"] = folder / "cut.csv"
    towards = many(2)
    towards["dir"].attrs["standard_name"] = "sea_surface_wave_to_direction"
    towards.to_netcdf(paths["towards"])
    xr.Dataset({"hs": ("time", [1.0])}).to_netcdf(paths["height"])
    paths["empty"].write_bytes(b"")
    return paths


BAD = {
    "none": ((), "There is no file"),
    "text": ((), "not a spectrum of a known format (ndbc, spotter,"),
    "empty": ((), "not a spectrum of a known format"),
    "height": ((), "is netCDF, but has no variable `efth`"),
    "towards": ((), "Coordinate `dir` holds directions that waves go to"),
    "cut": ((), "begins like netCDF, but cannot be opened as such: it is cut short or damaged"),
    "csv": ((), "could not be read as a spectrum of kind spotter"),
    "good": (("kind=triaxys",), "could not be read as a spectrum of kind triaxys"),
}


@pytest.mark.parametrize(
    ("name", "overrides", "says"), [(n, *rest) for n, rest in BAD.items()], ids=list(BAD)
)
def test_a_bad_file_is_one_sentence(bad_files, tmp_path, name, overrides, says):
    with pytest.raises(UserError) as error:
        execute(
            load("measured_sea", [f"files=[{bad_files[name]}]", *overrides], output=str(tmp_path / "runs"))
        )
    message = str(error.value)
    assert says in message
    assert "\n" not in message
    assert not list((tmp_path / "runs").iterdir())
    # Whatever a message says can be done in a config too.
    hinted = {"kind", "record", "cut_off"} & set(message.replace("`", " ").split())
    assert hinted <= set(load("measured_sea").config.model_dump())


@pytest.mark.parametrize(
    "arguments", [["files=[{cut}]"], ["files=[{none}]"], ["kind=foo"], ["files=[{towards}]"]], ids=str
)
def test_a_bad_file_on_the_command_line_ends_with_two(bad_files, tmp_path, arguments):
    filled = [a.format(**bad_files) for a in arguments]
    command = [
        sys.executable,
        "-m",
        "experiments",
        "run",
        "measured_sea",
        *filled,
        "--output",
        str(tmp_path / "runs"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert sum(line.startswith("Error: ") for line in done.stderr.splitlines()) == 1


def test_a_missing_wavespectra_is_one_sentence_that_names_the_extra(tmp_path, monkeypatch):
    path = tmp_path / "some.spec"
    path.write_text("SWAN   1\n")
    monkeypatch.setitem(sys.modules, "wavespectra", None)
    with pytest.raises(UserError, match=r"pip install jaxocean\[spectra\]"):
        execute(load("measured_sea", [f"files=[{path}]"], output=str(tmp_path / "runs")))


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="the folder of measured spectra (JAXOCEAN_DATA) is absent")
def test_every_kind_of_real_file_is_read(tmp_path):
    finished = execute(load("measured_sea", ["records=3"], output=str(tmp_path / "runs")))
    files = result_of(finished)["files"]
    assert set(files) == {"41010", "spotter_20210929", "swanfile", "triaxys", "ww3file"}
    # As the buoy itself reported it.
    assert files["triaxys"]["significant_wave_height_m"] == pytest.approx(3.41, rel=0.02)
    heights = np.concatenate([np.atleast_1d(each["significant_wave_height_m"]) for each in files.values()])
    assert ((heights > 0.5) & (heights < 4.5)).all()
    assert "coverage_coare_3_6" in files["ww3file"]
    assert "coverage_coare_3_6" not in files["spotter_20210929"]
