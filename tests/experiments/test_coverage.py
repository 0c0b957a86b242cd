"""`coverage`: one sea in closed form, alone and swept."""

import json
import subprocess
import sys
from pathlib import Path

import jax
import numpy as np
import pytest
import xarray as xr
from _sweep_toys import compute
from PIL import Image

from experiments import schema, sweeps
from experiments.closures.coverage import QUANTITIES, _statistics
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.sweeps._batch import with_numbers

REFERENCE = {
    # U10: Hs, mss, A, B, S, Var j, W exact, W Gaussian; SciPy quadrature and 2e6 Monte Carlo draws.
    5: (0.6441, 0.02932, 0.01395, 0.00804, 0.00367, 0.02947, 0.000440, 0.00179),
    10: (2.606, 0.05164, 0.02399, 0.01474, 0.00646, 0.05212, 0.00665, 0.01426),
    15: (5.869, 0.06887, 0.03228, 0.01938, 0.00861, 0.06972, 0.01701, 0.02914),
    20: (10.42, 0.08130, 0.03877, 0.02221, 0.01016, 0.08247, 0.02653, 0.04083),
}


SEA = ("band=[1e-3,400]", "breaking_wavenumber=null")


def sweep(folder: Path, *values: str) -> sweeps.Sweep:
    return sweeps.plan("coverage", values, output=str(folder))


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A finished run of the reference sea at 10 m/s."""
    return execute(load("coverage", SEA, output=str(tmp_path_factory.mktemp("runs"))))


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """The folder and the data of a sweep over the reference winds and a calm."""
    plan = sweep(tmp_path_factory.mktemp("sweeps"), *SEA, "wind.speed=0:20:5", "threshold=0.5,0.3")
    return plan.folder, compute(plan)


def result_of(finished) -> dict:
    return json.loads((finished.folder / "result.json").read_text())


def test_a_run_leaves_a_figure_data_and_the_answer_in_words(run):
    assert {"coverage.nc", "coverage.png", "report.md"} <= set(run.files())
    values = result_of(run)
    report = (run.folder / "report.md").read_text()
    assert f"cover {100 * values['coverage_exact_projected']:.3g} % of this sea as seen from above" in report
    assert f"{values['coverage_gaussian_projected'] / values['coverage_exact_projected']:.3g} times" in report
    assert (
        f"| exact | {values['coverage_exact_projected']:.4g} | {values['coverage_exact_rest']:.4g} |"
        in report
    )
    picture = Image.open(run.folder / "coverage.png")
    assert min(picture.size) > 600
    assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 20


def test_the_curves_of_a_run_pass_through_its_numbers(run):
    values = result_of(run)
    with xr.open_dataset(run.folder / "coverage.nc") as data:
        for name in ("exact_projected", "exact_rest", "gaussian_projected", "gaussian_rest", "published"):
            log = data[f"log_coverage_{name}"].interp(threshold=0.5).item()
            assert np.exp(log) == pytest.approx(values[f"coverage_{name}"], rel=1e-3)
        assert data["significant_wave_height"].attrs["units"] == "m"
        assert data["significant_wave_height"].item() == values["significant_wave_height"]


def test_a_sweep_has_the_reference_seas(swept):
    _, data = swept
    seas = data.sel(threshold=0.5)
    names = (
        "significant_wave_height",
        "mean_square_slope",
        "strain_variance_a",
        "strain_variance_b",
        "strain_variance_c",
        "jacobian_variance",
        "coverage_exact_rest",
        "coverage_gaussian_rest",
    )
    for wind, expected in REFERENCE.items():
        found = [seas[name].sel(wind_speed=wind).item() for name in names]
        assert found == pytest.approx(expected, rel=2.5e-3)


def test_a_swept_point_is_the_run_of_its_config(swept, run):
    _, data = swept
    point, values = data.sel(wind_speed=10, threshold=0.5), result_of(run)
    for name in QUANTITIES:
        assert point[name].item() == pytest.approx(values[name], rel=1e-12, abs=1e-18), name


def test_a_calm_sea_has_no_whitecaps_and_is_no_failure(swept):
    _, data = swept
    assert data["done"].values.all()
    calm = data.sel(wind_speed=0)
    assert not calm["coverage_exact_projected"].any()
    assert not calm["significant_wave_height"].any()


def test_the_netcdf_files_pass_the_cf_checker(swept, run):
    folder, _ = swept
    checker = Path(sys.executable).parent / "compliance-checker"
    checked = subprocess.run(
        [checker, "-t", "cf:1.11", folder / "results.nc", run.folder / "coverage.nc"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert checked.stdout.count("All tests passed!") == 2


def test_a_run_of_a_calm_sea_is_refused(tmp_path, monkeypatch):
    calm = dict.fromkeys(QUANTITIES, 0.0)
    monkeypatch.setattr("experiments.closures.coverage._close", lambda config, levels: (calm, None))
    with pytest.raises(UserError, match="do not strain the surface"):
        execute(load("coverage", ["wind.speed=0"], output=str(tmp_path)))


SEAS = {
    "elfouhaily": {"spectrum.inverse_wave_age": (0.84, 1.3), "spectrum.scale": (0.5, 2.0)},
    "jonswap": {
        "spectrum.significant_wave_height": (1.0, 2.0),
        "spectrum.peak_period": (5.0, 8.0),
        "spectrum.peak_enhancement": (1.0, 5.0),
        "spectrum.spreading.law": "mitsuyasu",
        "spectrum.spreading.s_max": (5.0, 30.0),
    },
    "pierson_moskowitz": {
        "spectrum.spreading.law": "hasselmann",
        "spectrum.spreading.inverse_wave_age": (0.9, 1.5),
    },
    "tma": {
        "spectrum.depth": (5.0, 50.0),
        "spectrum.spreading.law": "cosine",
        "spectrum.spreading.s": (1.0, 20.0),
    },
    "phillips": {
        "spectrum.amplitude": (0.004, 0.01),
        "spectrum.exponent": (2.0, 4.0),
        "spectrum.smallest_wave": (0.0, 0.1),
        "spectrum.opposing": (0.0, 1.0),
    },
}
SWELL = {
    "spectrum.swell.significant_wave_height": (1.0, 2.0),
    "spectrum.swell.peak_period": (9.0, 12.0),
    "spectrum.swell.direction": (0.5, 2.0),
    "spectrum.swell.width": (0.05, 0.2),
    "spectrum.swell.spreading.s_max": (20.0, 75.0),
}
EVERYWHERE = {
    "wind.speed": (6.0, 14.0),
    "wind.direction": (-1.0, 2.0),
    "wind.sea_air_temperature_difference": (-2.0, 2.0),
    "choppiness": (0.7, 1.2),
    "threshold": (0.3, 0.6),
    "breaking_wavenumber": (20.0, 70.0),
}


def _covariance(config) -> jax.Array:
    return _statistics(config)[1].covariance


@pytest.mark.parametrize("family", [*SEAS, "swell", "fetch"])
def test_a_batch_of_seas_is_each_sea_alone(family):
    sea = SEAS.get(family, {})
    base = ["cascade.sizes=[200.0,20.0]", "cascade.resolution=64"]
    ends = {key: value for key, value in {**EVERYWHERE, **sea}.items() if isinstance(value, tuple)}
    if family == "swell":
        ends |= SWELL
        base.append("spectrum.swell.spreading.law=mitsuyasu")
    elif family == "fetch":
        ends |= {"wind.fetch": (1e4, 1e6), "choppiness": ([1.0, 0.5], [0.8, 1.5])}
    else:
        base.append(f"spectrum.family={family}")
    base += [f"{key}={value}" for key, value in sea.items() if isinstance(value, str)]

    def alone(i: int) -> jax.Array:
        given = [f"{key}={values[i]}".replace(" ", "") for key, values in ends.items()]
        return _covariance(load("coverage", [*base, *given]).config)

    config = load("coverage", [*base, *(f"{key}={v[0]}".replace(" ", "") for key, v in ends.items())]).config
    numbers = {key: np.asarray(values) for key, values in ends.items()}
    assert set(numbers) <= schema.CoverageConfig.varies()
    batch = jax.jit(jax.vmap(lambda numbers: _covariance(with_numbers(config, numbers))))(numbers)
    for i in range(2):
        np.testing.assert_allclose(batch[i], alone(i), rtol=1e-10, atol=1e-16)
    # They differ, or the test says nothing.
    assert abs(batch[1, 0, 0] / batch[0, 0, 0] - 1) > 0.01


def test_every_key_that_may_vary_within_a_batch_has_been_tried_there():
    tried = {key for sea in (*SEAS.values(), SWELL, EVERYWHERE) for key in sea} | {"wind.fetch"}
    # The spreading of a swell is built by the function that builds that of the wind sea.
    alike = {f"spectrum.swell.spreading.{name}" for name in ("s", "inverse_wave_age")}
    assert schema.CoverageConfig.varies() - tried == alike


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (["wind.speed=4:200:2"], "at most 100 m/s, but is 102"),
        (["threshold=0.5,1.5"], "at most 1, but is 1.5"),
        (["wind.sped=4,5"], "did you mean `wind.speed`?"),
        (["spectrum.peak_period=5:9:1"], "it belongs to another choice of `spectrum.family`"),
        (["choppiness=[1,1],[2,2]"], "one per pattern (4"),
        (["band=[1,2],[3,1]", "choppiness=[1,1,1,1]"], "be one number where `band` takes the place"),
    ],
)
def test_bad_points_are_refused_before_anything_starts(tmp_path, values, says):
    with pytest.raises(UserError) as error:
        sweep(tmp_path, *values)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
    assert not list(tmp_path.iterdir())


def test_a_key_that_only_some_families_have_is_refused_at_the_points_of_the_others(tmp_path):
    plan = sweep(
        tmp_path, "spectrum.family=elfouhaily,jonswap", "spectrum.peak_enhancement=1,5", "wind.fetch=1e5"
    )
    assert plan.base.config.spectrum.family == "jonswap"
    assert plan.points.load(plan.points.codes(3)).config.spectrum.peak_enhancement == 5
    with pytest.raises(UserError, match="belongs to another choice"):
        plan.points.load(plan.points.codes(0))


def test_choppinesses_that_do_not_fit_the_patterns_are_refused_at_their_points(tmp_path):
    plan = sweep(tmp_path, "choppiness=1,[1,1],[1.0,1.0,1.0,0.5]")
    assert plan.points.load(plan.points.codes(2)).config.choppiness == (1.0, 1.0, 1.0, 0.5)
    with pytest.raises(UserError, match=r"one per pattern \(4"):
        plan.points.load(plan.points.codes(1))
