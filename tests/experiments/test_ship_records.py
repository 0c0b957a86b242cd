"""`ship_records` on a small table: what it leaves, whether its numbers are right, and bad files."""

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
from scipy import stats

import jaxocean as jo
from experiments.common._bootstrap import block_interval
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

HEADER = "jd u zu ta tsnk lat lon cp sigH\n"
DATA = Path(os.environ.get("JAXOCEAN_DATA", "../shared/data")) / "meteorology" / "test_36_data.txt"


def table(folder: Path, rows: int = 40) -> Path:
    """Records of all kinds: swell, young seas, winds too strong for their waves, gaps, two anemometers."""
    rng = np.random.default_rng(0)
    wind = rng.uniform(3, 13, rows)
    lines = [
        f"{10 + i / 10} {u:.6f} {18 if i % 2 else 10} 25 26 14 -52 {rng.uniform(6, 20):.6f} {rng.uniform(1, 4):.6f}"
        for i, u in enumerate(wind)
    ]
    lines[5] = "10.5 8 18 25 26 14 -52 15 nan"
    path = folder / "ship.txt"
    path.write_text(HEADER + "\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A finished run on the small table."""
    folder = tmp_path_factory.mktemp("ship")
    overrides = [f"file={table(folder)}", "resamples=100", "block=0.5", "threshold=0.6"]
    return execute(load("ship_records", overrides, output=str(folder / "runs")))


@pytest.fixture(scope="module")
def data(run):
    with xr.open_dataset(run.folder / "ship_records.nc") as dataset:
        return dataset.load()


def values_of(run) -> dict:
    return json.loads((run.folder / "result.json").read_text())


def test_every_complete_record_has_the_height_that_was_measured(run, data):
    assert values_of(run)["records"] == data.sizes["record"] == 39
    assert values_of(run)["records_left_out"] == 1
    both = np.hypot(data["wind_sea_height"], data["swell_height"])
    np.testing.assert_allclose(both, data["significant_wave_height"], rtol=1e-3)
    assert 0 < values_of(run)["records_younger"] < 39
    assert (data["swell_height"].values[data["younger"] == 1] == 0).all()
    assert float(data["inverse_wave_age"].min()) == pytest.approx(0.84)


def test_winds_are_brought_to_ten_metres_from_their_own_heights(data):
    ship = jo.io.read_ship_records(Path(data.encoding["source"]).parents[2] / "ship.txt")
    where = ship.complete()
    ratio = data["wind_speed"].values / ship.wind_speed[where]
    high = ship.wind_height[where] == 18
    np.testing.assert_allclose(ratio[~high], 1.0)
    assert ((ratio[high] > 0.93) & (ratio[high] < 0.97)).all()


def test_a_record_agrees_with_the_library(data):
    i = int(np.argmax(data["swell_height"].values))
    one = data.isel(record=i)

    @jax.jit
    def coverage(wind, height, peak_speed):
        parts = jo.spectra.wind_sea_and_swell(
            jo.Wind(wind), significant_wave_height=height, peak_speed=peak_speed
        )
        sea = jo.whitecaps.strain_statistics(
            parts.spectrum(), 1.0, band=(1e-3, 400.0), breaking_wavenumber=np.pi * 256 / 11
        )
        return jo.whitecaps.ExactClosure("projected")(sea, jnp.asarray(0.6))

    expected = coverage(
        float(one["wind_speed"]),
        float(one["significant_wave_height"]),
        float(one["swell_period"]) * 9.81 / (2 * np.pi),
    )
    np.testing.assert_allclose(one["coverage_projected"], expected, rtol=1e-3)
    assert float(one["coverage_without_swell"]) < float(one["coverage_projected"])
    assert float(one["coverage_swell_across"]) < float(
        one["coverage_projected"]
    )  # crossing seas are less skewed


def test_the_comparison_with_laws_is_that_of_scipy(run, data):
    values = values_of(run)
    for name in ("coare_3_6", "callaghan_2008"):
        law = data[f"coverage_{name}"].values
        expected = stats.spearmanr(law, data["coverage_projected"].values).statistic
        assert values[f"rank_correlation_{name}"] == pytest.approx(expected)
        assert values[f"rank_correlation_{name}_low"] <= expected <= values[f"rank_correlation_{name}_high"]
        seen = (law >= 1e-5) & (data["coverage_projected"].values >= 1e-5)
        ratio = np.log10(data["coverage_projected"].values[seen] / law[seen])
        assert values[f"bias_log10_{name}"] == pytest.approx(ratio.mean())


def test_the_error_of_the_threshold_makes_a_band(data):
    assert (data["coverage_projected_low"] < data["coverage_projected"]).all()
    assert (data["coverage_projected"] < data["coverage_projected_high"]).all()


def test_the_report_tells_the_numbers(run):
    text, values = (run.folder / "report.md").read_text(), values_of(run)
    assert f"{values['rank_correlation_coare_3_6']:.3f}" in text
    assert f"{values['swell_effect_percent']:+.1f} %" in text
    assert "nan" not in text
    assert (run.folder / "ship_records.png").stat().st_size > 50_000


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (["file=nowhere.txt"], "There is no file `nowhere.txt`"),
        (["file={bad}"], "lacks `sigH` .Hs"),
        (["file={good}", "record=99"], "asks for 99, but .* has 40 records .0 to 39"),
        (["file={good}", "record=5"], "None of the 1 records asked for has wind, height and phase speed"),
    ],
)
def test_bad_records_are_one_sentence(tmp_path, overrides, says):
    (tmp_path / "bad.txt").write_text("u zu cp\n1 2 3\n")
    names = {"good": table(tmp_path), "bad": tmp_path / "bad.txt"}
    with pytest.raises(UserError, match=says) as error:
        execute(load("ship_records", [o.format(**names) for o in overrides], output=str(tmp_path / "runs")))
    assert "\n" not in str(error.value)


def test_without_data_the_command_says_how_to_give_them(tmp_path):
    command = [sys.executable, "-m", "experiments", "run", "ship_records", "--output", str(tmp_path / "runs")]
    done = subprocess.run(
        command,
        env={**os.environ, "JAXOCEAN_DATA": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("Error: There are no ship records at")
    assert "file=…" in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_file(), reason=f"no ship records in {DATA} (set JAXOCEAN_DATA)")
def test_the_cruise_is_mostly_swell_and_ranks_like_the_wind(tmp_path):
    run = execute(load("ship_records", ["resamples=100"], output=str(tmp_path / "runs")))
    values = values_of(run)
    assert values["records"] == 2159
    assert values["swell_share"] == pytest.approx(0.963, abs=0.001)
    assert values["rank_correlation_coare_3_6"] > 0.95


def test_blocks_widen_the_interval_of_records_that_are_alike():
    rng = np.random.default_rng(1)
    series = np.repeat(rng.standard_normal(40), 25)  # 40 independent numbers, each 25 times

    def mean(places):
        return np.mean(series[places])

    options = {"resamples": 1000, "confidence": 0.95, "seed": 0}
    low, high = block_interval(mean, np.arange(1000) // 25, **options)
    narrow_low, narrow_high = block_interval(mean, np.arange(1000), **options)
    expected = 2 * 1.96 * np.std(series) / np.sqrt(40)
    assert float(high - low) == pytest.approx(expected, rel=0.1)
    assert float(narrow_high - narrow_low) == pytest.approx(expected / 5, rel=0.1)
    assert np.isnan(block_interval(mean, np.zeros(1000), **options)).all()
