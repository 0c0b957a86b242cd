"""Closures against counts, on small seas: whether the counts can tell, and whether the report is true."""

import json

import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from PIL import Image
from scipy import stats

import jaxocean as jo
from experiments.closures import _gaussian_report, gaussian_vs_monte_carlo
from experiments.closures._gaussian_views import Comparison
from experiments.common import _counting
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

SMALL = (
    "wind.speed=[8,15]",
    "cascade.sizes=[200,37]",
    "cascade.resolution=64",
    "breaking_wavenumber=null",
    "choppiness=2",
    "thresholds=[0.1,0.3,0.5,0.7,0.9]",
    "draws=200000",
    "realisations=32",
)


def run(folder, *overrides):
    return execute(load("gaussian_vs_monte_carlo", [*SMALL, *overrides], output=str(folder)))


def result_of(finished) -> dict:
    return json.loads((finished.folder / "result.json").read_text())


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A finished run on the plane at rest."""
    return run(tmp_path_factory.mktemp("runs"))


@pytest.fixture(scope="module")
def projected(tmp_path_factory):
    """A finished run seen from above, on a single pattern and with a single wind."""
    one = ("cascade.sizes=[37]", "wind.speed=[15]", "measure=projected")
    return run(tmp_path_factory.mktemp("runs"), *one)


def test_exact_closure_agrees_with_draws_and_fft_seas_and_the_gaussian_one_does_not(finished):
    agreement = result_of(finished)["agreement"]
    for counted in ("monte_carlo", "fft"):
        exact, gaussian = agreement[f"exact_with_{counted}"], agreement[f"gaussian_with_{counted}"]
        assert exact["cases"] == gaussian["cases"] >= 6
        assert exact["agreeing"] == exact["cases"]
        assert gaussian["agreeing"] <= gaussian["cases"] / 2
        assert abs(gaussian["worst"]["standard_errors"]) > 15 > 3 > abs(exact["worst"]["standard_errors"])


def test_reported_numbers_are_those_of_the_library(finished):
    result = result_of(finished)
    sea = result["seas"][1]
    spectrum = jo.spectra.Elfouhaily(jo.Wind(15.0))
    cascade = jo.surface.Cascade(sizes=(200.0, 37.0), resolution=64)
    statistics = jo.whitecaps.strain_statistics(spectrum, 2.0, cascade=cascade)
    level = jnp.asarray(result["thresholds"])
    exact = np.asarray([jo.whitecaps.ExactClosure("rest")(statistics, each) for each in level])
    gaussian = np.asarray([jo.whitecaps.GaussianClosure("rest")(statistics, each) for each in level])
    np.testing.assert_allclose(sea["exact"], exact, rtol=1e-9)
    np.testing.assert_allclose(sea["gaussian_over_exact"], gaussian / exact, rtol=1e-9)
    assert sea["wind_speed_m_per_s"] == 15.0
    assert sea["jacobian_variance_monte_carlo"] == pytest.approx(sea["jacobian_variance"], rel=0.02)
    assert sea["skewness_monte_carlo"] == pytest.approx(sea["skewness"], rel=0.1)


def test_the_answer_in_words_carries_the_numbers(finished):
    summary, sea = " ".join(finished.summary().split()), result_of(finished)["seas"][0]
    assert f"{sea['gaussian_over_exact'][2]:.3g} times too high at 8 m/s" in summary
    assert f"skewness is {sea['skewness']:+.2f} at U10 = 8 m/s" in summary
    assert "The published formula (eqs 6-8 as printed) is undefined: its variance is negative" in summary
    assert sea["published_is_defined"] is False
    assert sea["published"] == [None] * 5
    assert sea["published_variance"] < 0


def test_report_states_the_answer_with_its_numbers_and_links_its_pictures(finished):
    report = (finished.folder / "report.md").read_text()
    sea = result_of(finished)["seas"][0]
    assert f"{sea['gaussian_over_exact'][2]:.3g} times too high at 8 m/s" in report
    assert "| undefined |" in report
    for picture in finished.folder.glob("*.png"):
        assert f"({picture.name})" in report


def test_published_formula_is_the_gaussian_one_where_it_is_defined():
    statistics = jo.whitecaps.strain_statistics(
        jo.spectra.Elfouhaily(jo.Wind(15.0)), 2.0, cascade=jo.surface.Cascade(sizes=(37.0,), resolution=64)
    )
    closed = gaussian_vs_monte_carlo._close(
        statistics, np.array([0.3, 0.6]), np.array([0.5, 1.0]), measure="rest"
    )
    sea = Comparison(15.0, closed, draws=None, realised=None)
    assert sea.published_is_defined
    np.testing.assert_allclose(closed.at.published, closed.at.gaussian, rtol=1e-9)
    config = load("gaussian_vs_monte_carlo").config
    assert "is defined here" in _gaussian_report._published_note([sea], config)


def test_coverage_seen_from_above_is_less_and_agrees_with_its_counts(projected):
    result = result_of(projected)
    (sea,) = result["seas"]
    assert result["agreement"]["exact_with_monte_carlo"]["cases"] >= 3
    for counted in ("monte_carlo", "fft"):
        verdict = result["agreement"][f"exact_with_{counted}"]
        assert verdict["agreeing"] == verdict["cases"]
    spectrum = jo.spectra.Elfouhaily(jo.Wind(15.0))
    cascade = jo.surface.Cascade(sizes=(37.0,), resolution=64)
    statistics = jo.whitecaps.strain_statistics(spectrum, 2.0, cascade=cascade)
    rest = float(jo.whitecaps.ExactClosure("rest")(statistics, 0.5))
    assert 0 < sea["exact"][2] < 0.6 * rest
    lower, upper = sea["monte_carlo_interval"]
    assert lower[2] < sea["monte_carlo"][2] < upper[2]
    assert sea["published"] is None
    assert "counts rest area only" in projected.summary()


def test_histogram_follows_the_exact_density_and_not_the_gaussian_one(finished):
    with xr.open_dataset(finished.folder / "densities.nc") as data:
        width = float(data["jacobian"][1] - data["jacobian"][0])
        assert data["jacobian"].attrs["units"] == "1"
        for wind in data["wind"].values:
            sea = data.sel(wind=wind)
            np.testing.assert_allclose(float(sea["exact"].sum()) * width, 1, rtol=1e-4)
            np.testing.assert_allclose(float(sea["monte_carlo"].sum()) * width, 1, rtol=1e-4)
            expected = 200_000 * width * sea["exact"].values
            counted, often = 200_000 * width * sea["monte_carlo"].values, expected > 20
            freedom = int(often.sum())
            fit = float(np.sum((counted - expected)[often] ** 2 / expected[often]))
            assert stats.chi2.sf(fit, freedom) > 1e-3
            gaussian = 200_000 * width * sea["gaussian"].values
            misfit = float(np.sum((counted - gaussian)[often] ** 2 / np.maximum(gaussian[often], 1)))
            assert misfit > 10 * fit


def test_data_files_say_what_the_numbers_depend_on(finished):
    result = result_of(finished)
    with xr.open_dataset(finished.folder / "coverage.nc") as data:
        assert data.attrs["measure"] == "rest"
        assert data.attrs["Conventions"].startswith("CF-")
        assert data.attrs["breaking_wavenumber_rad_per_m"] == "none"
        assert data["wind"].attrs["standard_name"] == "wind_speed"
        assert data["exact"].dims == ("wind", "threshold")
        np.testing.assert_allclose(data["exact"].values, [sea["exact"] for sea in result["seas"]])
        assert (data["monte_carlo_lower"] <= data["monte_carlo"]).all()
        assert (data["monte_carlo"] <= data["monte_carlo_upper"]).all()
        assert (data["monte_carlo_upper"] > 0).all()
        assert data["published"].isnull().all()


def test_pictures_are_large_enough_to_read(finished):
    pictures = {path.stem: Image.open(path) for path in finished.folder.glob("*.png")}
    assert set(pictures) == {"coverage", "densities"}
    for name, picture in pictures.items():
        assert min(picture.size) > 700, name
        assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 20, name


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("wind.speed=[]", "Key `wind.speed` on the command line must hold at least 1"),
        ("wind.speed=10", "must be a list, but is 10"),
        ("wind.speed=[10,5]", "`wind.speed` on the command line must increase from one to the next, but 5"),
        ("wind.speed=[5,-1]", "must hold speeds from 0.5 to 60 m/s, but one is -1"),
        (
            "thresholds=[0.5,0.4]",
            "`thresholds` on the command line must increase from one to the next, but 0.4",
        ),
        ("thresholds=[0.5]", "must hold at least 2"),
        ("thresholds=[0.5,1.5]", "must lie between -100 and 1, but one is 1.5"),
        ("draws=100", "`draws` on the command line must be at least 10000, but is 100"),
        ("realisations=2", "must be at least 8, but is 2"),
        ("confidence=99", "must be at most 0.99999, but is 99"),
        ("measure=above", "must be `rest` or `projected`, but is 'above'"),
        ("choppiness=0", "must be greater than 0: without displacement j = 1 everywhere"),
        ("spectrum.family=tma", "must hold one speed: this spectrum `tma` is the same in any wind"),
        ("wind.sped=[3]", "did you mean `wind.speed`?"),
    ],
)
def test_bad_input_is_one_sentence(override, says):
    with pytest.raises(UserError) as error:
        load("gaussian_vs_monte_carlo", [override])
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_a_sea_without_strain_is_refused_and_leaves_nothing(tmp_path):
    with pytest.raises(UserError, match="do not strain the surface"):
        run(tmp_path, "spectrum.scale=0")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("count", [0, 3, 40, 1000])
def test_intervals_are_wilsons(count):
    lower, upper = _counting.wilson_interval(np.array([count / 1000]), 1000, 0.99)
    expected = stats.binomtest(count, 1000).proportion_ci(0.99, method="wilson")
    np.testing.assert_allclose([lower[0], upper[0]], [expected.low, expected.high], rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("draws", [10_000, 10_000_000, 12_345_678])
def test_batches_hold_all_draws_and_hardly_more_and_stay_small(draws):
    count, size = _counting.batches(draws)
    assert draws <= count * size < draws + count
    assert size <= _counting.BATCH
    assert count >= _counting.BATCHES
