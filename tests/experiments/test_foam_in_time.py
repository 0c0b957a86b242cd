"""Foam in time: events that are followed, what the config refuses, and a small run."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from PIL import Image

import jaxocean as jo
from experiments.foam._foam_events import follow, read_measured
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from jaxocean.whitecaps import foam

SMALL = (
    "wind.speed=[9,14]",
    "cascade.sizes=[32]",
    "cascade.resolution=32",
    "tile.size=32",
    "tile.resolution=32",
    "breaking_wavenumber=3",
    "breaking_wavenumbers=[3]",
    "threshold=0.7",
    "decay_time=0.8",
    "decay_times=[0.4]",
    "duration=12",
    "block=2",
    "step=0.1",
    "seas=3",
)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A finished run, without measured events."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JAXOCEAN_DATA", str(tmp_path_factory.mktemp("nothing")))
        return execute(load("foam_in_time", SMALL, output=str(tmp_path_factory.mktemp("runs"))))


def result_of(finished) -> dict:
    return json.loads((finished.folder / "result.json").read_text())


@pytest.mark.slow
def test_total_coverage_on_the_tile_is_what_the_closed_forms_say(finished):
    result = result_of(finished)
    tile = result["tile"]
    for measure in ("rest", "projected"):
        active, total = (np.array(tile[f"{kind}_{measure}"]["mean"]) for kind in ("active", "total"))
        assert np.all(total > 2 * active)
        error = np.array(tile[f"total_{measure}"]["standard_error"])
        place = int(np.argmin(np.abs(np.array(result["decay_times_s"]) - 0.8)))
        closed = np.array(result["closed"][f"renewal_{measure}"])[:, place]
        assert np.all(np.abs(closed - total) < 4 * error)
    for closure in ("renewal", "poisson"):
        assert np.max(np.abs(result["error_of_closure"][closure]["mean"])) < 0.06


@pytest.mark.slow
def test_reported_numbers_are_those_of_the_library(finished):
    result = result_of(finished)
    with jax.enable_x64(True):
        motion = foam.strain_motion(
            jo.spectra.Elfouhaily(jo.Wind(14.0)),
            1.0,
            cascade=jo.surface.Cascade((32.0,), 32),
            breaking_wavenumber=3.0,
        )
        point = foam.point_breaking(motion, 0.7, horizon=20.0)
        closed = foam.RenewalFoam()(point, jnp.asarray(result["decay_times_s"]))
    assert result["crossing_rate_per_s"][1] == pytest.approx(float(point.rate), rel=1e-4)
    np.testing.assert_allclose(result["closed"]["renewal_projected"][1], closed, rtol=2e-3)
    assert result["decay_time_s"] == 0.8
    # The wind's own τ makes its own total coverage that of the law, with the active one that of its law.
    assert len(result["decay_time_per_wind_s"]) == 2
    assert np.all(np.array(result["decay_time_per_wind_s"]) > 0)


@pytest.mark.slow
def test_the_report_answers_in_words_and_says_that_events_are_missing(finished):
    text, result = (finished.folder / "report.md").read_text(encoding="utf-8"), result_of(finished)
    fitted = result["decay_time_fitted"]["parameters"][0]
    assert f"one τ = {fitted['value']:.2f} ± {fitted['error']:.2f} s" in " ".join(text.split())
    assert "There are no measured events" in text
    assert result["measured_event_duration_s"] is None
    assert "rest area" in text
    assert "projected area" in text


@pytest.mark.slow
def test_data_and_pictures_are_complete(finished):
    with xr.open_dataset(finished.folder / "foam_in_time.nc") as data:
        assert data["total_projected"].dims == ("wind", "sea", "elapsed")
        assert data.attrs["threshold"] == pytest.approx(0.7)
        settled = data["elapsed"] > data.attrs["spin_up_s"]
        mean = data["total_rest"].where(settled).mean(("sea", "elapsed"))
        np.testing.assert_allclose(mean, result_of(finished)["tile"]["total_rest"]["mean"], rtol=1e-5)
        assert data.attrs["spin_up_s"] >= 5 * 0.8
        # The age counts the same foam as the state does.
        place = int(np.argmin(np.abs(data["decay_time"].values - 0.8)))
        np.testing.assert_allclose(data["tile_total_rest"][:, place], mean, rtol=0.05)
    with xr.open_dataset(finished.folder / "foam_map.nc") as data:
        assert data["coverage"].shape == (64, 64)
        white = data["coverage"].values > 0
        np.testing.assert_allclose(
            data["coverage"].values[white], np.exp(-data["age"].values[white] / 0.8), rtol=1e-4
        )
    for name in ("foam_in_time", "foam_map"):
        with Image.open(finished.folder / f"{name}.png") as picture:
            assert min(picture.size) > 700


def test_an_event_is_followed_through_space_time_and_across_the_edge():
    breaks = np.zeros((30, 8, 8), bool)
    for t in range(5):
        breaks[3 + t, 2, (6 + t) % 8] = True  # moves over the edge
    breaks[10:12, 7, 3] = breaks[12, 0, 4] = True  # over the other edge, and aside
    breaks[20, 4, 4] = True
    breaks[22, 4, 4] = True  # a gap of one frame parts two events
    breaks[28:, 5, 5] = True  # cut by the end
    breaks[:2, 1, 5] = True  # and by the beginning
    events = follow(breaks, 0.1)
    np.testing.assert_allclose(sorted(events.duration), [0.1, 0.1, 0.3, 0.5])
    mean, _ = events.mean(0.2)
    assert 0.39 < mean < 0.41
    assert follow(np.zeros((4, 8, 8), bool), 0.1).duration.size == 0
    assert np.isnan(follow(np.zeros((4, 8, 8), bool), 0.1).mean()[0])


def test_long_events_count_as_often_as_they_are_though_the_window_cuts_them():
    random = np.random.default_rng(0)
    durations = []
    weights = []
    for _ in range(1500):
        breaks = np.zeros((20, 5, 5), bool)
        start, length = random.integers(-12, 20), random.choice([2, 10])
        breaks[max(0, start) : max(0, start + length), 2, 2] = True
        events = follow(breaks, 1.0)
        durations.append(events.duration)
        weights.append(events.weight)
    duration, weight = np.concatenate(durations), np.concatenate(weights)
    assert np.average(duration, weights=weight) == pytest.approx(6.0, abs=0.5)
    assert duration.mean() < 5.4


def test_measured_events_are_read_by_wind(tmp_path):
    path = tmp_path / "events.csv"
    path.write_text("wave_breaking_duration,wind_speed,other\n0.5,8,1\n0.7,8,1\n1.0,12,1\n")
    wind, mean, error = read_measured(path).by_wind()
    np.testing.assert_allclose(wind, [8.0, 12.0])
    np.testing.assert_allclose(mean, [0.6, 1.0])
    assert error[0] == pytest.approx(0.1)
    assert np.isnan(error[1])
    path.write_text("duration\n1\n")
    with pytest.raises(UserError, match="wave_breaking_duration"):
        read_measured(path)


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("wind.speed=[10]", "must hold at least 2"),
        ("wind.speed=[10,8]", "increase from one to the next, but 8 follows 10"),
        ("choppiness=0", "must be greater than 0: without displacement j = 1 everywhere"),
        ("cascade.bands=[[0.1,1],[1,2]]", "must be null: they follow from the sizes"),
        ("spectrum.family=tma", "must follow the wind"),
        ("spin_up=3", "must be at least 5, but is 3"),
        ("duration=2", "must hold at least 2 blocks of 3 s, but is 2"),
        ("events.window=0.1", "must last at least 4 steps of 0.05 s, but is 0.1"),
        ("decay_times=[2,1]", "must increase from one to the next, but 1 follows 2"),
        ("drawn_wind=9", "must be one of `wind.speed` (8, 10, 12, 15), but is 9"),
        ("seas=1", "must be at least 2, but is 1"),
        ("tile.resolution=33", "must be even, but is 33"),
        ("breaking_wavenumbers=[0]", "hold wavenumbers greater than 0 rad/m"),
        ("events.windo=1", "did you mean `events.window`?"),
    ],
)
def test_bad_input_is_one_sentence(override, says):
    with pytest.raises(UserError) as error:
        load("foam_in_time", [override])
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_a_tile_that_is_too_coarse_for_what_foam_sees_is_refused(tmp_path):
    with pytest.raises(UserError, match="Argument `resolution` must be at least"):
        execute(
            load(
                "foam_in_time",
                [*SMALL, "breaking_wavenumber=50", "cascade.resolution=64"],
                output=str(tmp_path),
            )
        )
    assert not list(tmp_path.iterdir())
