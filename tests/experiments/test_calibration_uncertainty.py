"""`calibration_uncertainty` from its config to its files, on a small cascade and with the cheaper closure."""

import json

import numpy as np
import pytest
import xarray as xr
from _cheap import gaussian_closure
from PIL import Image

from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

SMALL = [
    "cascade.sizes=[400.0,37.0]",
    "cascade.resolution=64",
    "breaking_wavenumber=5.0",
    "wind.speed=[8.0,12.0,16.0]",
    "chains=2",
    "draws=500",
    "warmup=200",
    "points=21",
    "sets=100",
    "sampled=3",
]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A finished run. The Gaussian closure compiles in a third of the time; everything else is the same."""
    with gaussian_closure():
        folder = tmp_path_factory.mktemp("runs")
        return execute(load("calibration_uncertainty", [*SMALL, f"output={folder}"]))


@pytest.fixture(scope="module")
def values(run):
    return json.loads((run.folder / "result.json").read_text())


def test_ninety_per_cent_intervals_contain_the_truth_in_85_to_95_of_100_data_sets(values):
    found = values["coverage_probability"]
    for method in ("laplace", "profile"):
        for name in ("threshold", "choppiness"):
            assert found[method][name]["total"] == 100
            assert 85 <= found[method][name]["hits"] <= 95
    assert found["posterior"]["threshold"]["total"] == 3


def test_with_a_prior_the_fits_errors_are_the_posteriors(values):
    found = values["posteriors"]["prior"]
    for parameter in found["parameters"]:
        assert parameter["deviation_over_laplace_error"] == pytest.approx(1.0, abs=0.15)
        assert parameter["r_hat"] < 1.05
    assert found["correlations"][0][1] == pytest.approx(found["laplace_correlations"][0][1], abs=0.1)


def test_a_free_scatter_has_a_longer_tail_than_its_error_says(values):
    scatter = values["posteriors"]["scatter"]["parameters"][-1]
    assert scatter["name"] == "scatter"
    assert scatter["skewness"] > 0.5
    assert scatter["deviation_over_laplace_error"] > 1.15
    # So few draws may also disagree too much to judge, which is said instead; that all is well is said in no case.
    verdict = values["posteriors"]["scatter"]["verdict"]
    assert "do not describe" in verdict or "cannot judge" in verdict


def test_profiles_agree_with_a_trusted_fit_and_stay_open_without_a_prior(values):
    trusted = values["profiles"]["prior"]["choppiness"]
    parameter = values["posteriors"]["prior"]["parameters"][1]
    half = 1.645 * parameter["laplace_error"]
    assert trusted["lower"] == pytest.approx(parameter["laplace_value"] - half, abs=0.03)
    assert trusted["upper"] == pytest.approx(parameter["laplace_value"] + half, abs=0.03)
    free = values["profiles"]["none"]["choppiness"]
    assert free["lower"] is None or free["upper"] is None
    assert "no " in free["interval"] or "not bounded" in free["interval"]


def test_report_answers_in_words_with_the_runs_numbers(run, values):
    text = (run.folder / "report.md").read_text()
    share = values["coverage_probability"]["laplace"]["threshold"]
    assert f"ε {share['hits']} of 100" in text
    ratio = values["posteriors"]["prior"]["parameters"][0]["deviation_over_laplace_error"]
    assert f"ε {ratio:.2f}" in text
    assert values["profiles"]["weak"]["threshold"]["interval"].replace("threshold", "ε") in text
    assert "k_b = 5 rad/m" in text


def test_data_hold_draws_profiles_and_repeated_fits(run, values):
    with xr.open_dataset(run.folder / "posterior.nc") as data:
        assert data["threshold"].dims == ("chain", "draw")
        assert data["threshold"].shape == (2, 500)
        mean = values["posteriors"]["prior"]["parameters"][0]["mean"]
        assert float(data["threshold"].mean()) == pytest.approx(mean)
        assert np.all(data["scatter_free_scatter"] > 0)
        assert data.attrs["breaking_wavenumber"] == "5 rad/m"
    with xr.open_dataset(run.folder / "profiles.nc") as data:
        assert float(data["excess_threshold"].min()) == 0.0
        assert data["excess_choppiness_no_prior"].dims == ("choppiness_no_prior",)
    with xr.open_dataset(run.folder / "coverage_probability.nc") as data:
        pull = (data["choppiness_truth"] - data["choppiness_fitted"]) / data["choppiness_error"]
        hits = values["coverage_probability"]["laplace"]["choppiness"]["hits"]
        assert int((np.abs(pull) <= 1.6448536).sum()) == hits


def test_picture_is_large_enough_to_read(run):
    with Image.open(run.folder / "calibration_uncertainty.png") as picture:
        assert min(picture.size) > 1000
        assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 50


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        ("wind.speed=[8.0,4.0]", "increase"),
        ("law=monahan", "law"),
        ("band=[5.0,1.0]", "lower < upper"),
        ("spectrum={family: phillips}", "follow the wind"),
        ("weak_deviation=0.1", "greater than `choppiness_prior.deviation`"),
        ("sampled=2000", "be at most `sets`"),
        ("chains=1", "at least 2"),
        ("level=90", "at most 0.999"),
        ("choppiness_prior.mean=4", "lie between 0 and 3"),
    ],
)
def test_bad_values_are_one_sentence(override, sentence):
    with pytest.raises(UserError, match=sentence) as caught:
        load("calibration_uncertainty", [override])
    assert "\n" not in str(caught.value)
