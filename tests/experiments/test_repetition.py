"""How sums of patterns repeat, on small grids: whether the numbers are right and the words say them."""

import itertools
import json

import numpy as np
import pytest
import xarray as xr
from PIL import Image

import jaxocean as jo
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

SMALL = (
    "patterns=[1,3]",
    "samples=8192",
    "spacing=0.5",
    "largest=400",
    "waves=4",
    "paper=[400,50,32]",
    "commensurate=[320,64,32]",
    "resolution=64",
    "others=2",
    "reach=1500",
    "step=0.5",
    "breaking_wavenumber=5",
    "threshold=0.7",
    "draws=200000",
)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return execute(load("repetition", list(SMALL), output=str(tmp_path_factory.mktemp("runs"))))


@pytest.fixture(scope="module")
def sums(finished):
    result = json.loads((finished.folder / "result.json").read_text())
    return {one["name"]: one for one in result["cascades"]}


def test_one_pattern_repeats_wholly_and_more_repeat_less(sums):
    one = sums["n = 1"]
    assert len(one["sizes"]) == 1
    assert one["height_peak"] == pytest.approx(1, abs=0.01)
    assert one["jacobian_peak"] == pytest.approx(1, abs=0.03)
    assert one["jacobian_peak_distance_m"] % one["sizes"][0] == pytest.approx(0, abs=0.5 * 40)
    assert one["foam_again"] > 0.8
    assert sums["n = 3"]["jacobian_peak"] < 0.9
    assert sums["n = 3"]["foam_again"] < 0.7 * one["foam_again"]
    assert one["period_m"] == one["sizes"][0]
    assert sums["n = 3"]["period_m"] > 1e6
    samples = [len(each["sizes"]) * each["resolution"] ** 2 for name, each in sums.items() if "n =" in name]
    assert max(samples) < 1.1 * min(samples)


def test_common_factors_make_everything_return_at_the_period(sums):
    one = sums["commensurate"]
    assert one["period_m"] == 320.0
    assert one["height_peak"] == pytest.approx(1, abs=1e-4)
    assert one["jacobian_peak"] == pytest.approx(1, abs=1e-4)
    assert one["jacobian_peak_distance_m"] % 320 == pytest.approx(0, abs=1e-6)
    assert one["foam_again"] == pytest.approx(1, abs=0.02)


def test_height_comes_again_with_the_pattern_that_holds_it_and_sharing_the_peak_mends_that(sums):
    paper, shared, recommended = (sums[name] for name in ("paper", "peak shared", "recommended"))
    assert paper["height_peak"] >= 0.98 * max(paper["height_shares"])
    assert max(shared["height_shares"]) < 0.65 < max(recommended["height_shares"])
    assert shared["height_peak"] < recommended["height_peak"] - 0.1
    for one in sums.values():
        assert sum(one["height_shares"]) == pytest.approx(1)
        edges = sorted(one["bands"])
        assert all(a[1] == pytest.approx(b[0]) for a, b in itertools.pairwise(edges))


def test_side_peaks_are_those_of_the_closed_form(sums):
    cascade = jo.surface.Cascade((400.0, 50.0, 32.0), 64)
    spectrum = jo.spectra.Elfouhaily(jo.Wind(12.0), 2.0)
    energy = jo.surface.cell_energy(spectrum, cascade)
    place = sums["paper"]["height_peak_distance_m"]
    curves = [
        np.asarray(jo.surface.autocovariance(energy, cascade, np.array([0.0, place]), axis=axis)).sum(0)
        for axis in (0, 1)
    ]
    highest = max(curve[1] / curve[0] for curve in curves)
    assert sums["paper"]["height_peak"] == pytest.approx(highest, rel=1e-4)


def test_words_data_and_picture_carry_the_numbers(finished, sums):
    text = " ".join((finished.folder / "report.md").read_text().split())
    assert f"{sums['n = 1']['jacobian_peak']:.2f}, {sums['n = 3']['jacobian_peak']:.2f}" in text
    assert "320, 64, 32 m repeat exactly after 320 m" in text
    with xr.open_dataset(finished.folder / "repetition.nc") as data:
        names = [str(name) for name in data["cascade_name"].values]
        assert names == list(sums)
        np.testing.assert_allclose(data["jacobian_peak"], [one["jacobian_peak"] for one in sums.values()])
        assert data["distance"].attrs["units"] == "m"
        assert float(data["height_curve"].max()) == pytest.approx(1)
    picture = Image.open(finished.folder / "repetition.png")
    assert min(picture.size) > 1000
    assert len(set(np.asarray(picture.convert("L")).ravel().tolist())) > 50


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("patterns=[2,1]", "`patterns` on the command line must increase"),
        ("patterns=[13]", "must hold numbers from 1 to 12, but one is 13"),
        ("resolution=33", "must be even, but is 33"),
        ("step=1e-5", "must be at least a millionth of `reach`"),
        ("paper=[0]", "must hold lengths greater than 0 m"),
        ("wind.speed=0", "must be greater than 0: a calm sea does not repeat"),
        ("spectrum.family=jonswap", "spectrum"),
    ],
)
def test_bad_input_is_one_sentence(override, says):
    with pytest.raises(UserError) as error:
        load("repetition", [override])
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_what_does_not_fit_together_is_refused_and_leaves_nothing(tmp_path):
    for overrides, says in (
        (["reach=50"], "`reach` must be more than 69"),
        (["patterns=[3]", "largest=20"], "`largest` must leave room for 3 patterns"),
    ):
        with pytest.raises(UserError, match=says):
            execute(load("repetition", [*SMALL, *overrides], output=str(tmp_path)))
    assert not list(tmp_path.iterdir())
