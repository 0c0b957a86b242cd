"""Closures in footprints of a small tile: whether the counts are right, and whether the report is true."""

import json

import jax
import numpy as np
import pytest
import xarray as xr
from PIL import Image
from scipy import stats

import jaxocean as jo
from experiments.common import _tiles
from experiments.footprints import _footprint_errors, _normality
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

SMALL = (
    "wind.speed=[14]",
    "cascade.sizes=[200,37]",
    "cascade.resolution=64",
    "breaking_wavenumber=null",
    "choppiness=2",
    "thresholds=[0.4,0.6]",
    "tile.points=128",
    "tile.spacing=0.4",
    "realisations=3",
)
TILE = _tiles.Tile(128, 0.4)


def run(folder, *overrides):
    return execute(load("footprint_bias", [*SMALL, *overrides], output=str(folder)))


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return run(tmp_path_factory.mktemp("runs"))


@pytest.fixture(scope="module")
def sea():
    """The first sea of the run, its fields, and its footprints."""
    spectrum = jo.spectra.Elfouhaily(jo.Wind(14.0))
    cascade = jo.surface.Cascade((200.0, 37.0), 64)
    one = jo.surface.realise(spectrum, cascade, key=jax.random.fold_in(jax.random.key(0), 0))
    fields = one.fields(0.0, 2.0)
    return one, fields, _tiles.gather(fields.strain, cascade, TILE)


def result_of(finished) -> dict:
    return json.loads((finished.folder / "result.json").read_text())


def test_the_tile_is_the_sea_itself(sea):
    one, _, footprints = sea
    points = np.stack(np.meshgrid(TILE.along[:5], TILE.along[40:47]), axis=-1)
    np.testing.assert_allclose(footprints.strain[40:47, :5], one.strain(points, 0.0, 2.0), atol=1e-9)


def test_moments_and_truth_of_a_footprint_are_those_of_its_samples(sea):
    _, _, footprints = sea
    strain = np.asarray(footprints.strain)
    level = TILE.sides.index(16)
    part = TILE.segments()[level]
    box = strain[16:32, 48:64].reshape(-1, 3)
    i = part.start + 1 * (128 // 16) + 3
    np.testing.assert_allclose(footprints.summed.mean[i], box.mean(axis=0), atol=1e-12)
    covariance = np.cov(box, rowvar=False, bias=True)
    np.testing.assert_allclose(footprints.summed.covariance[i] - 1e-7 * np.eye(3), covariance, atol=1e-12)
    covered = np.asarray(_tiles.covered(footprints.strain, 0.5, TILE))
    assert covered[i] == np.mean((1 + box[:, 0]) * (1 + box[:, 1]) - box[:, 2] ** 2 < 0.5)
    centre = np.asarray(TILE.footprints().centre[i])
    np.testing.assert_allclose(centre, [(48 + 7.5) * 0.4, (16 + 7.5) * 0.4])
    # Covariances that are added miss those between the patterns, which average out.
    whole = TILE.segments()[-1]
    summed, independent = (np.asarray(each.covariance[whole][0]) for each in footprints[:2])
    assert 0 < np.max(np.abs(summed - independent)) < 0.1 * np.trace(summed)


def test_more_footprints_than_are_wanted_are_thinned_evenly():
    tile = _tiles.Tile(1024, 1.0)
    assert tile.stride(1) == 4
    assert tile.stride(4) == 1
    centres = np.asarray(tile.footprints().centre)
    assert len(centres) == tile.segments()[-1].stop
    np.testing.assert_array_equal(np.unique(centres[tile.segments()[0]][:, 0]), np.arange(0, 1024, 4))


def test_leaving_out_negligible_footprints_changes_nothing_that_matters(sea):
    _, _, footprints = sea
    summed = footprints.summed
    quick = _footprint_errors.exact(summed, 0.5)
    full = np.asarray(jo.whitecaps.ExactClosure("rest")(summed, 0.5))
    assert np.any(quick == 0)
    np.testing.assert_allclose(quick, full, atol=1e-6)


def test_reported_biases_are_closures_minus_counts(finished, sea):
    _, _, footprints = sea
    with xr.open_dataset(finished.folder / "footprint_bias.nc") as data:
        first = data.isel(wind=0, realisation=0)
        assert data["bias"].attrs["units"] == "1"
        assert data.attrs["measure"] == "rest"
        for threshold in (0.4, 0.6):
            true = np.asarray(_tiles.covered(footprints.strain, threshold, TILE))
            at = first.sel(threshold=threshold)
            assert float(at["coverage"]) == pytest.approx(true[-1])
            exact = np.asarray(jo.whitecaps.ExactClosure("rest")(footprints.summed, threshold))
            for s, part in enumerate(TILE.segments()):
                error = (exact - true)[part]
                one = at.isel(size=s, closure=data["closure"].attrs["flag_meanings"].split().index("exact"))
                np.testing.assert_allclose(float(one["bias"]), error.mean(), atol=3e-5)
                np.testing.assert_allclose(
                    float(one["root_mean_square_error"]), np.sqrt(np.mean(error**2)), rtol=0.03, atol=3e-5
                )


def test_the_exact_closure_wins_and_the_answer_says_so(finished):
    result, report = result_of(finished), (finished.folder / "report.md").read_text()
    claim = result["claim"]
    assert claim["cases"] == 2 * (len(TILE.sides) - 1)
    (sea,) = result["seas"]
    assert f"{claim['several_times']} of {claim['cases']} cases" in report
    ratio = claim["least"]["ratio"]
    assert f"{ratio:.3g} times in the worst" in report
    # On the whole tile the exact closure beats Gaussian j, and both beat nothing by chance alone.
    exact, gaussian = (np.abs(sea["bias"][name])[:, -2] for name in ("exact", "gaussian"))
    assert np.all(exact < 0.5 * gaussian)
    # A single sample is its own footprint.
    np.testing.assert_allclose(np.asarray(sea["bias"]["exact"])[:, 0], 0, atol=1e-4)
    assert np.max(sea["printed_defined"]) < 0.1
    assert "undefined (σ² < 0)" in report
    assert "| U10 (m/s) |" in report


def test_storage_is_reported_with_its_price(finished):
    forms = {form["name"]: form for form in result_of(finished)["storage"]}
    texels = 2 * (4**7 - 1) // 3
    assert forms["products, float32"]["bytes"] == texels * 14 * 4
    assert forms["covariances, float16"]["bytes"] < 0.6 * forms["products, float16"]["bytes"]
    assert max(forms["products, float32"]["worst"]) == 0
    assert 0 < max(forms["covariances, float16"]["worst"]) < max(forms["covariances, bfloat16"]["worst"])


def test_normality_of_known_samples():
    rng = np.random.default_rng(0)
    tile = _tiles.Tile(64, 1.0)
    slope = rng.normal(size=(64, 64, 2))
    slope[..., 1] = rng.exponential(size=(64, 64))
    strain = np.zeros((64, 64, 3))
    strain[..., 0] = rng.uniform(size=(64, 64))
    values = _normality.measure(*(jax.numpy.asarray(each) for each in (slope, strain)), tile)
    assert values.shape == (3, 3, len(_normality.sizes(tile)))
    for q, samples in enumerate((slope[..., 0], slope[..., 1], strain[..., 0])):
        whole = samples.ravel()
        np.testing.assert_allclose(values[q, 0, -1], stats.skew(whole), atol=1e-9)
        np.testing.assert_allclose(values[q, 1, -1], stats.kurtosis(whole), atol=1e-8)
        distance = stats.kstest((whole - whole.mean()) / whole.std(), "norm").statistic
        np.testing.assert_allclose(values[q, 2, -1], distance, atol=1.01 / whole.size)


def test_pictures_and_data_are_there(finished):
    for name in ("footprint_bias", "normality"):
        with Image.open(finished.folder / f"{name}.png") as picture:
            assert np.ptp(np.asarray(picture.convert("L"))) > 200
    with xr.open_dataset(finished.folder / "normality.nc") as data:
        assert data["skewness"].dims == ("wind", "realisation", "quantity", "size")


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("tile.points=100", "a power of two"),
        ("thresholds=[0.5,0.5]", "increase from one to the next"),
        ("thresholds=[1.5]", "lie between -100 and 1"),
        ("choppiness=0", "without displacement"),
        ("realisations=2", "3"),
    ],
)
def test_keys_that_make_no_sense_are_refused(override, message):
    with pytest.raises(UserError, match=message):
        load("footprint_bias", [*SMALL, override])


def test_a_sea_without_waves_is_refused_in_one_sentence(tmp_path):
    with pytest.raises(UserError, match="do not strain the surface"):
        run(tmp_path, "spectrum.scale=0")
