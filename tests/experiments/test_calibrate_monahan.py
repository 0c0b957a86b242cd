"""`calibrate_monahan` from its config to its files, on a small cascade."""

import json
import typing

import jax
import numpy as np
import pytest
import xarray as xr

import fitting
import jaxocean as jo
from experiments import schema
from experiments.calibration import calibrate_monahan
from experiments.common import _build
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

SMALL = [
    "cascade.sizes=[400.0,37.0]",
    "cascade.resolution=64",
    "breaking_wavenumber=5.0",
    "breaking_wavenumbers=[2.5,5.0]",
    "wind.speed=[8.0,12.0,16.0]",
    "realisations=24",
]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    return execute(load("calibrate_monahan", [*SMALL, f"output={folder}"]))


@pytest.fixture(scope="module")
def values(run):
    return json.loads((run.folder / "result.json").read_text())


def test_realised_seas_reproduce_the_fitted_coverage(values):
    assert np.max(np.abs(values["check"]["deviations"])) < 3


def test_threshold_of_each_wind_meets_the_law_exactly(values):
    for closure in ("exact", "gaussian"):
        assert values[closure]["per_wind"]["targets"][0]["rms"] < 1e-6


def test_words_say_that_threshold_and_choppiness_cannot_be_separated(values):
    assert "cannot be separated" in values["exact"]["shared"]["identifiability"]


def test_projected_area_needs_a_higher_threshold_than_the_rest_area(values):
    table = values["threshold_by_breaking_wavenumber"]
    for projected, rest in zip(table["projected"], table["rest"], strict=True):
        assert projected[1] > rest[1]


def test_run_leaves_data_with_units_and_a_picture(run):
    with xr.open_dataset(run.folder / "calibration.nc") as data:
        assert data["wind_speed"].attrs["units"] == "m s-1"
        assert data.attrs["area_measure"] == "projected"
        assert np.all(np.isfinite(data["coverage_exact"]))
        assert data["monahan_1980"].dims == ("wind_speed",)
    assert (run.folder / "calibration.png").stat().st_size > 20_000


def test_table_of_thresholds_against_breaking_wavenumbers_is_in_the_data(run, values):
    with xr.open_dataset(run.folder / "calibration.nc") as data:
        assert data["breaking_wavenumber"].values.tolist() == [2.5, 5.0]
        for measure, rows in values["threshold_by_breaking_wavenumber"].items():
            columns = [data[f"{name}_of_limit{end}_{measure}"] for name, end in (
                ("threshold", ""), ("threshold", "_error"), ("rms", "")
            )]  # fmt: skip
            np.testing.assert_allclose(np.transpose(columns), np.asarray(rows)[:, 1:])


def test_error_of_the_fitted_coverage_is_that_of_draws_from_the_covariance(run, values):
    """Linear propagation against the model itself at other thresholds and choppinesses along the ridge."""
    shared = values["exact"]["shared"]
    at = {parameter["name"]: parameter["value"] for parameter in shared["parameters"]}
    config = load("calibrate_monahan", SMALL).config
    covariance = np.asarray(shared["covariance"])
    variances, axes = np.linalg.eigh(covariance)
    with jax.enable_x64(True):
        wind = _build.wind(config.wind, speed=12.0)

        def log_coverage(threshold, choppiness):
            stats = jo.whitecaps.strain_statistics(
                _build.spectrum(config.spectrum, wind),
                choppiness,
                cascade=_build.cascade(config.cascade),
                breaking_wavenumber=5.0,
            )
            return float(jo.whitecaps.ExactClosure("projected").log(stats, threshold))

        middle = np.array([at["threshold"], at["choppiness"]])
        steps = [0.1 * np.sqrt(v) * axis for v, axis in zip(variances, axes.T, strict=True)]
        halves = [5 * (log_coverage(*(middle + d)) - log_coverage(*(middle - d))) for d in steps]
    with xr.open_dataset(run.folder / "calibration.nc") as data:
        stated = float(data["coverage_exact_relative_error"].sel(wind_speed=12.0))
    assert stated == pytest.approx(float(np.hypot(*halves)), rel=0.02)


def test_report_states_the_fitted_values_in_words(run, values):
    report = (run.folder / "report.md").read_text()
    threshold, choppiness = values["exact"]["shared"]["parameters"]
    assert f"ε = {threshold['value']:.3f} ± {threshold['error']:.3f}" in report
    assert f"λ = {choppiness['value']:.3f} ± {choppiness['error']:.3f}" in report
    assert "standard errors" in report
    assert "![" in report
    assert "…" not in run.summary()


def test_every_law_and_solver_of_the_schema_can_be_built():
    assert set(_build.LAWS) == set(schema.LawName.__args__)
    named = schema.CalibrationConfig.model_fields["solver"].annotation
    assert set(_build.SOLVERS) == set(typing.get_args(named))
    assert {type(_build.solver(name)) for name in _build.SOLVERS} == set(
        fitting.AbstractSolver.__subclasses__()
    )


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        ("wind.speed=[8.0,4.0]", "increase"),
        ("laws=[monahan]", "laws"),
        ("band=[5.0,1.0]", "lower < upper"),
        ("spectrum={family: phillips}", "follow the wind"),
        ("choppiness_prior.deviation=-1", "choppiness_prior.deviation"),
    ],
)
def test_bad_values_are_one_sentence(override, sentence):
    with pytest.raises(UserError, match=sentence):
        load("calibrate_monahan", [override])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("speed,coverage\n8,0.01\n", "must have a column `wind`"),
        ("wind,coverage\n8,much\n", "Line 2 of .* must hold a number"),
        ("", "is empty"),
        ("wind,coverage\n", "without rows"),
        ("wind,coverage\n8,1.5\n", r"Line 2 of .*fractions .* holds 1\.5"),
        ("wind,coverage\n8,0.01\n-4,0.02\n", "Line 3 of .*points.csv must hold a wind speed .* holds -4"),
    ],
)
def test_bad_measured_points_are_one_sentence_and_leave_nothing(tmp_path, text, sentence):
    path = tmp_path / "points.csv"
    path.write_text(text)
    loaded = load("calibrate_monahan", [*SMALL, f"points.file={path}", f"output={tmp_path / 'runs'}"])
    with pytest.raises(UserError, match=sentence):
        execute(loaded)
    assert not any((tmp_path / "runs").glob("calibrate*"))


def test_measured_points_are_fitted_beside_the_law(tmp_path, monkeypatch):
    # The Gaussian closure compiles in a third of the time; everything else is the same.
    monkeypatch.setitem(calibrate_monahan.CLOSURES, "exact", jo.whitecaps.GaussianClosure)
    path = tmp_path / "points.csv"
    path.write_text("wind,coverage\n8,0.5\n12,1.9\n16,5.0\n")
    overrides = [
        *SMALL,
        f"points.file={path}",
        "points.percent=true",
        "realisations=0",
        "breaking_wavenumbers=[]",
    ]
    found = execute(load("calibrate_monahan", [*overrides, f"output={tmp_path / 'runs'}"]))
    fit = json.loads((found.folder / "result.json").read_text())["exact"]["shared"]
    assert [target["name"] for target in fit["targets"]][1] == "measured coverage"
    np.testing.assert_allclose(fit["targets"][1]["observed"], np.log10([0.005, 0.019, 0.05]), rtol=1e-6)


def test_result_says_when_the_cascade_does_not_resolve_the_breaking_wavenumber():
    cascade = _build.cascade(load("calibrate_monahan", SMALL).config.cascade)
    assert _build.unresolved_breaking(cascade, cascade.wavenumber_limit) == []
    (note,) = _build.unresolved_breaking(cascade, 2 * cascade.wavenumber_limit)
    assert "depends on the grid" in note


def test_fit_that_fails_is_one_sentence_and_leaves_nothing(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise fitting.FitError("The fit did not move", "its gradient is zero", "try a smooth indicator")

    monkeypatch.setattr(fitting, "fit", refuse)
    loaded = load("calibrate_monahan", [*SMALL, f"output={tmp_path / 'runs'}"])
    with pytest.raises(UserError, match=r"did not move.*smooth indicator"):
        execute(loaded)
    assert not any((tmp_path / "runs").glob("calibrate*"))
