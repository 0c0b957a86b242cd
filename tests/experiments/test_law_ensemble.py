"""`law_ensemble` from its config to its files, on a small cascade and with the cheaper closure."""

import json

import numpy as np
import pytest
import xarray as xr
from _cheap import gaussian_closure
from PIL import Image

import jaxocean as jo
from experiments.common import _build
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

SMALL = [
    "cascade.sizes=[400.0,37.0]",
    "cascade.resolution=64",
    "breaking_wavenumber=5.0",
    "wind.speed=[6.0,10.0,14.0,18.0]",
    "draws=50",
]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A finished run with all laws. The Gaussian closure compiles in a third of the time."""
    with gaussian_closure():
        folder = tmp_path_factory.mktemp("runs")
        return execute(load("law_ensemble", [*SMALL, f"output={folder}"]))


@pytest.fixture(scope="module")
def values(run):
    return json.loads((run.folder / "result.json").read_text())


def test_every_law_is_obeyed_where_it_has_data(values):
    assert len(values["laws"]) == len(jo.whitecaps.laws.ALL) == len(_build.LAWS)
    by_name = {law["name"]: law for law in values["laws"]}
    assert by_name["Monahan & O'Muircheartaigh 1980 (robust)"]["winds_m_per_s"] == [6.0, 10.0, 14.0]
    assert by_name["Stramska & Petelski 2003 (undeveloped)"]["winds_m_per_s"] == [10.0, 14.0, 18.0]
    assert by_name["COARE 3.6"]["winds_m_per_s"] == [6.0, 10.0, 14.0, 18.0]


def test_a_law_with_more_foam_needs_a_higher_threshold(values):
    foam = {law["name"]: law for law in values["laws"]}
    active, decaying = (foam[f"Monahan & Lu 1990 (stage {stage})"] for stage in "AB")
    assert active["foam"] == "active"
    key = "threshold_at_fixed_choppiness"
    assert active[key] + 2 * active[f"{key}_error"] < decaying[key]
    ratio = np.asarray(decaying["coverage_sea"]) / np.asarray(active["coverage_sea"])
    assert np.all(ratio > 3)


def test_the_band_holds_the_seas_of_whole_foam_and_leaves_active_breaking_out(values):
    whole = np.asarray([law["coverage_sea"] for law in values["laws"] if law["foam"] != "active"])
    lower, median, upper = (np.asarray(values["band"][name]) for name in ("lower", "median", "upper"))
    assert np.all(lower < np.median(whole, axis=0))
    assert np.all(np.median(whole, axis=0) < upper)
    np.testing.assert_allclose(median, np.median(whole, axis=0), rtol=0.4)
    (active,) = [law["coverage_sea"] for law in values["laws"] if law["foam"] == "active"]
    assert np.all(np.asarray(active) < lower)
    between = np.std(np.log10(whole), axis=0, ddof=1)
    np.testing.assert_allclose(values["band"]["between_laws_log10"], between, rtol=1e-9)


def test_report_answers_in_words_with_the_runs_numbers(run, values):
    text = (run.folder / "report.md").read_text()
    key = "threshold_at_fixed_choppiness"
    whole = [law for law in values["laws"] if law["foam"] != "active"]
    least = min(whole, key=lambda law: law[key])
    assert f"between {least[key]:.3f} ({least['name']})" in text
    spread = np.std([law[key] for law in whole], ddof=1)
    assert f"± {spread:.3f} from law to law" in text
    assert "active breaking only" in text
    i = values["wind_m_per_s"].index(10.0)
    assert f"W = {values['band']['median'][i]:.2g}" in text


def test_data_hold_laws_seas_and_their_band(run, values):
    with xr.open_dataset(run.folder / "law_ensemble.nc") as data:
        assert data["coverage_law"].dims == ("law", "wind_speed")
        assert data["wind_speed"].attrs["units"] == "m s-1"
        assert "3: Callaghan" in data.attrs["laws"]
        np.testing.assert_allclose(data["threshold"], [law["threshold"] for law in values["laws"]])
        assert np.isnan(data["coverage_law"].sel(wind_speed=18.0).values[0])
        assert np.all(data["coverage_lower"] < data["coverage_upper"])


def test_picture_is_large_enough_to_read(run):
    with Image.open(run.folder / "law_ensemble.png") as picture:
        assert min(picture.size) > 900
        assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 50


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        ("laws=[monahan_1980,monahan_1980]", "name each law once"),
        ("laws=[monahan_1980]", "at least two laws"),
        ("laws=[monahan]", "laws"),
        ("wind.speed=[8.0]", "at least 2"),
        ("least=0", "greater than 0"),
        ("draws=5", "at least 20"),
    ],
)
def test_bad_values_are_one_sentence(override, sentence):
    with pytest.raises(UserError, match=sentence) as caught:
        load("law_ensemble", [override])
    assert "\n" not in str(caught.value)


def test_winds_that_no_law_knows_are_one_sentence(tmp_path):
    calm = [*SMALL[:-2], "wind.speed=[0.5,0.6]", f"output={tmp_path}"]
    with pytest.raises(UserError, match="in the range of some law"):
        execute(load("law_ensemble", calm))
    assert not any(tmp_path.glob("law*"))
