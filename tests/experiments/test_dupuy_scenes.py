"""The published scenes, on small grids: whether the table is what the library and the counts say."""

import json

import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from PIL import Image

import jaxocean as jo
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.patterns import _dupuy_report
from experiments.schema import SCENES

SMALL = ("scenes=[1,6]", "resolution=64", "realisations=16", "shifts=2")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return execute(load("dupuy_scenes", list(SMALL), output=str(tmp_path_factory.mktemp("runs"))))


@pytest.fixture(scope="module")
def result(finished):
    return json.loads((finished.folder / "result.json").read_text())


def of(result, scene: int, field: str) -> dict:
    return next(row for row in result["scenes"] if (row["scene"], row["field"]) == (scene, field))


def test_counts_agree_with_the_exact_closure_and_not_with_the_gaussian_ones(result):
    for field in ("foam", "jacobian", "spectrum"):
        row = of(result, 1, field)
        error = row["coverage_counted_standard_error"]
        assert 0 < error < 0.1 * row["coverage_counted"]
        assert abs(row["coverage_counted"] - row["coverage_exact"]) < max(
            5 * error, 0.03 * row["coverage_exact"]
        )
        for other in ("program", "gaussian"):
            assert abs(row["coverage_counted"] - row[f"coverage_{other}"]) > 8 * error
        error = row["projected_counted_standard_error"]
        assert row["projected_counted"] == pytest.approx(row["projected_exact"], abs=5 * error)
        assert row["projected_exact"] < 0.3 * row["coverage_exact"]


def test_a_negative_variance_is_called_undefined(finished, result):
    assert all(row["printed_is_defined"] is False for row in result["scenes"])
    assert all(row["coverage_printed"] is None for row in result["scenes"])
    for text in (finished.summary(), (finished.folder / "report.md").read_text()):
        assert text.count("undefined") >= len(result["scenes"])
        assert "nan" not in text.lower()
        assert "negative variance in 6 of 6 fields" in " ".join(text.split())


def test_numbers_are_those_of_the_library(result):
    scene = SCENES[1]
    spectrum = scene.amplitude * jo.spectra.Elfouhaily(jo.Wind(scene.wind), scene.inverse_wave_age)
    cascade = jo.surface.Cascade(scene.sizes, 64)
    ours = jo.whitecaps.strain_statistics(spectrum, scene.choppiness, cascade=cascade)
    row = of(result, 1, "spectrum")
    exact = jo.whitecaps.ExactClosure("rest")(ours, scene.threshold)
    assert row["coverage_exact"] == pytest.approx(float(exact), rel=1e-9)
    assert row["variance"] == pytest.approx(float(ours.jacobian_variance()), rel=1e-9)
    published = jo.whitecaps.PublishedClosure()
    assert row["printed_variance"] == pytest.approx(float(published.moments(ours)[1]), rel=1e-9)
    assert ours.patterns is not None
    program = float(jnp.sum(ours.patterns.jacobian_variance()))
    assert row["program_variance"] == pytest.approx(program, rel=1e-9)
    assert row["program_variance"] < row["variance"]


def test_the_foam_field_has_half_of_the_strain_and_the_scenes_differ_by_their_threshold(result):
    foam, whole = of(result, 1, "foam"), of(result, 1, "jacobian")
    assert foam["program_variance"] == pytest.approx(0.5 * whole["program_variance"], rel=0.03)
    assert foam["coverage_exact"] < 0.4 * whole["coverage_exact"]
    again = of(result, 6, "foam")
    assert again["variance"] == pytest.approx(foam["variance"])
    assert again["coverage_exact"] < 0.1 * foam["coverage_exact"]
    assert again["threshold"] == -0.068


@pytest.mark.slow
def test_the_known_figures_of_the_first_scene_come_out(tmp_path):
    finished = execute(load("dupuy_scenes", ["scenes=[1]", "realisations=8"], output=str(tmp_path)))
    result = json.loads((finished.folder / "result.json").read_text())
    known = {name: value for name, (_, value) in _dupuy_report.KNOWN.items()}
    program = result["known"]["ln Ω, squares"]
    for name, value in known.items():
        assert program[name] == pytest.approx(value, abs=0.003 if value < 0 else 0.0007)
    right = result["known"]["log10 Ω, annuli"]
    assert right["gaussian_foam"] == pytest.approx(of(result, 1, "spectrum")["coverage_program"], rel=1e-9)
    assert right["gaussian_foam"] < 0.9 * known["gaussian_foam"]
    for field, name in (("foam", "exact_foam"), ("jacobian", "exact")):
        row = of(result, 1, field)
        assert row["coverage_counted"] == pytest.approx(known[name], rel=0.04)
    assert "γ with ln Ω, squares" in " ".join(finished.summary().split())


def test_data_and_picture_are_there(finished, result):
    with xr.open_dataset(finished.folder / "scenes.nc") as data:
        assert data["coverage_counted"].dims == ("scene", "field")
        assert data["coverage_printed"].isnull().all()
        np.testing.assert_allclose(
            data["coverage_exact"].values.ravel(), [row["coverage_exact"] for row in result["scenes"]]
        )
        assert data["wind_speed"].attrs["standard_name"] == "wind_speed"
    picture = Image.open(finished.folder / "scenes.png")
    assert min(picture.size) > 700
    assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 20


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("scenes=[3]", "`scenes` on the command line must hold numbers of published scenes"),
        ("scenes=[]", "must hold at least 1"),
        ("scenes=[1,1]", "must hold each scene once"),
        ("resolution=65", "must be even, but is 65"),
        ("peak_enhancement=ln", "must be `program` or `published`"),
        ("realisations=1", "must be at least 8"),
    ],
)
def test_bad_input_is_one_sentence(override, says):
    with pytest.raises(UserError) as error:
        load("dupuy_scenes", [override])
    assert says in str(error.value)
    assert "\n" not in str(error.value)
