"""`sea_states` on few points, seas with swell in other experiments, and the options of `spectrum`."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from scipy import optimize

import jaxocean as jo
from experiments.common import _build
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load

K_B = np.pi * 256 / 11


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A finished run with few points."""
    overrides = ["points=9", "wind.speed=[8,12]", "swell.significant_wave_height=[1.5,3]", "threshold=0.6"]
    return execute(load("sea_states", overrides, output=str(tmp_path_factory.mktemp("runs"))))


@pytest.fixture(scope="module")
def data(run):
    with xr.open_dataset(run.folder / "sea_states.nc") as dataset:
        return dataset.load()


@jax.jit
def coverage(speed, omega, height, angle):
    sea = jo.spectra.Elfouhaily(jo.Wind(speed), omega)
    sea = sea + jo.spectra.Swell(significant_wave_height=height, peak_period=8.0, direction=angle)
    stats = jo.whitecaps.strain_statistics(sea, 1.0, band=(1e-3, 400.0), breaking_wavenumber=K_B)
    return jo.whitecaps.ExactClosure("projected")(stats, jnp.asarray(0.6))


def test_curves_agree_with_the_library(data):
    turned = data["coverage_swell_angle"].isel(swell_height=1, angle=3)
    np.testing.assert_allclose(turned, coverage(10.0, 0.84, 3.0, float(turned["angle"])), rtol=1e-4)
    aged = data["coverage_wave_age"].isel(wind_speed=1, inverse_wave_age=5)
    np.testing.assert_allclose(aged, coverage(12.0, float(aged["inverse_wave_age"]), 0.0, 0.0), rtol=1e-4)
    blown = data["coverage_fetch"].isel(wind_speed=0, fetch=2)
    age = jo.Wind(8.0, fetch=float(blown["fetch"])).inverse_wave_age()
    np.testing.assert_allclose(blown, coverage(8.0, float(age), 0.0, 0.0), rtol=1e-4)


def test_swell_from_opposite_sides_breaks_alike(data):
    turned = data["coverage_swell_angle"].values
    np.testing.assert_allclose(turned, turned[:, ::-1], rtol=1e-6)
    assert (turned > float(data["coverage_wind_sea_alone"])).all()
    assert (turned.argmin(axis=1) == 4).all()  # across the wind


def test_whitecaps_fade_as_the_wind_sea_gets_younger(data):
    assert (np.diff(data["coverage_wave_age"].values, axis=1) < 0).all()
    assert (np.diff(data["coverage_fetch"].values, axis=1) > 0).all()
    law = jo.whitecaps.laws.ZhaoToba2001(inverse_wave_age=5.0)(jo.Wind(8.0))
    np.testing.assert_allclose(data["law_wave_age"].values[0, -1], law)


def test_the_report_tells_what_the_swell_does(run):
    values = json.loads((run.folder / "result.json").read_text())
    assert 0 < values["swell_3_m_across_percent"] < values["swell_3_m_along_percent"]
    text = (run.folder / "report.md").read_text()
    assert f"by {values['swell_3_m_along_percent']:.3g} % along the wind" in text
    assert (run.folder / "sea_states.png").stat().st_size > 50_000


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("wind.speed=[10,8]", "`wind.speed` .* must increase from one to the next, but 8 follows 10"),
        ("inverse_wave_age=[0.5,3]", "must hold numbers from 0.84 to 5, but one is 0.5"),
        ("swell.peak_period=1", "must be at least 2 s, but is 1"),
    ],
)
def test_bad_states_are_one_sentence(override, says):
    with pytest.raises(UserError, match=says):
        load("sea_states", [override])


def test_a_sea_without_breaking_says_what_to_raise(tmp_path):
    overrides = ["points=9", "choppiness=0", "wind.speed=[8]"]
    with pytest.raises(UserError, match="Nothing breaks in the wind sea of 10 m/s: raise"):
        execute(load("sea_states", overrides, output=str(tmp_path)))


def test_swell_is_a_section_of_every_spectrum():
    for family in ("elfouhaily", "pierson_moskowitz", "tma", "phillips"):
        plain = load("coverage", [f"spectrum.family={family}"]).config
        config = load(
            "coverage", [f"spectrum.family={family}", "spectrum.swell.significant_wave_height=3"]
        ).config
        wind = _build.wind(config.wind)
        k, phi = jnp.asarray(0.028), jnp.asarray(0.1)
        both, alone = (_build.spectrum(c.spectrum, wind).density(k, phi) for c in (config, plain))
        swell = _build.swell(config.spectrum.swell, wind, _build.dispersion(config.spectrum))
        assert float(both) > float(alone)
        np.testing.assert_allclose(both, alone + swell.density(k, phi), rtol=1e-6)


def test_shipped_seas_with_swell_and_of_any_age_are_what_they_say():
    swell = load("wind_sea_and_swell").config.spectrum.swell
    assert (swell.significant_wave_height, swell.peak_period, swell.direction) == (2.0, 8.0, 0.0)
    assert load("wave_age").config.spectrum.inverse_wave_age == 1.5
    fetch = load("wave_age", ["spectrum.inverse_wave_age=null", "wind.fetch=1e5"]).config
    sea = _build.spectrum(fetch.spectrum, _build.wind(fetch.wind))
    np.testing.assert_allclose(sea.age(), jo.Wind(10.0, fetch=1e5).inverse_wave_age(), rtol=1e-6)


@pytest.fixture(scope="module")
def shallow(tmp_path_factory):
    """Two moments of `spectrum` in shallow water, one period apart."""
    folder = tmp_path_factory.mktemp("shallow")
    overrides = [
        "cascade.resolution=32",
        "map.resolution=32",
        "depth=12",
        "surface_tension=7.2e-5",
        "repeat_period=40",
        "spectrum.family=jonswap",
        "spectrum.significant_wave_height=2",
        "spectrum.peak_period=9",
    ]
    return [execute(load("spectrum", [*overrides, f"time={t}"], output=str(folder))) for t in (3.0, 43.0)]


def test_spectrum_knows_depth_and_surface_tension(shallow):
    result = json.loads((shallow[0].folder / "result.json").read_text())
    omega = 2 * np.pi / 9

    def excess(k):
        return (9.81 * k + 7.2e-5 * k**3) * np.tanh(12 * k) - omega**2

    expected = optimize.brentq(excess, 1e-3, 1.0)
    assert result["peak_wavenumber_rad_per_m"] == pytest.approx(expected, rel=0.01)
    assert result["significant_wave_height_m"] == pytest.approx(2.0, rel=0.01)
    assert "water of 12 m" in (shallow[0].folder / "report.md").read_text()


def test_spectrum_repeats_after_its_period(shallow):
    heights = []
    for run in shallow:
        with xr.open_dataset(run.folder / "sea.nc") as data:
            heights.append(data["height"].values)
    np.testing.assert_allclose(heights[0], heights[1], atol=1e-4)
    assert np.std(heights[0]) > 0.2


def test_a_second_depth_is_refused():
    with pytest.raises(UserError, match=r"must be null, since the spectrum `tma` has a key `spectrum.depth`"):
        load("spectrum", ["depth=10", "spectrum.family=tma"])
