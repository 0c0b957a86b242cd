"""`picture_recovery` and `joint_targets` around fits that are made up, and `wave_recovery` on a patch of few waves."""

import dataclasses
import json

import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr

import fitting
from experiments import schema
from experiments.harness._errors import Interrupted, UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.harness._progress import Silent
from experiments.pictures import _recovery_scenes, joint_targets, picture_recovery
from fitting import FitError
from fitting.pictures import PictureFit
from jaxocean.render import Raster, Rays

SMALL = ["truths.count=6", "height=18", "width=32", "cascade.sizes=[120.0,17.0]", "cascade.resolution=32"]
ERRORS = np.array([0.1, 0.01, 0.01, 0.005, 0.01, 0.02])


def errors_of(scene):
    """`ERRORS`, that of λ as often as the scene has one."""
    return np.repeat(ERRORS, [leaf.size for leaf in _recovery_scenes.free(scene)])


class Watching(Silent):
    """Stops after some seas."""

    def __init__(self, stop_after: int | None = None) -> None:
        self.seas, self.stop_after = 0, stop_after

    def count(self, what, total):
        def advance():
            self.seas += 1
            if self.seas == self.stop_after:
                raise KeyboardInterrupt

        return advance


class Fits(list):
    """Numbers of the fits that were asked for, and with what the last one was to finish."""

    finish = ()


@pytest.fixture
def made_up(monkeypatch):
    """Fits that are off by a tenth, one and two standard errors in turn; every fifth leads nowhere."""
    fits = Fits()

    def target(scene, size, detail, method):
        return jnp.full((*size, 3), 0.1 + 0.01 * scene.wind.speed)

    def fit(start, free, target, *, finish, **_):
        fits.finish = finish
        number = len(fits)
        fits.append(number)
        if number % 5 == 4:
            raise FitError("The fit did not come to rest", "a joke", "another")
        values = {str(i): np.asarray(each) for i, each in enumerate(free(start))}
        own = errors_of(start)
        covariance = np.diag(own**2)
        errors = dict(
            zip(values, np.split(own, np.cumsum([v.size for v in values.values()])[:-1]), strict=True)
        )
        return PictureFit(values, errors, tuple(values), covariance, 0 * covariance, 1.0, 0.5, (), 2.0, start)

    def draw(config, number):
        truth, _, coverage = whole(config, number)
        off = (0.1, 1.0, 2.0)[number % 3] * errors_of(truth)
        return truth, _recovery_scenes.with_numbers(truth, _recovery_scenes.values(truth) + off), coverage

    whole = _recovery_scenes.draw
    monkeypatch.setattr(picture_recovery, "fit_picture", fit)
    monkeypatch.setattr(_recovery_scenes, "target", target)
    monkeypatch.setattr(_recovery_scenes, "draw", draw)
    return fits


def test_seas_are_counted_as_they_are_found_and_an_interrupted_search_goes_on(tmp_path, made_up):
    loaded = load("picture_recovery", SMALL, output=str(tmp_path))
    with pytest.raises(Interrupted):
        execute(loaded, Watching(stop_after=2))
    finished = execute(loaded)
    assert made_up == list(range(6))
    values = json.loads((finished.folder / "result.json").read_text())
    assert (values["seas"], values["failed"]) == (6, 1)
    # Off by 0.1, 1, 2, 0.1 and 2 errors: sea 4 led nowhere; 1.645 errors hold three of five.
    assert values["interval_coverage"] == pytest.approx(0.6)
    assert values["recovered"] == 5
    assert (values["recovered_by_rays"], values["seas_by_rays"]) == (2, 3)
    assert {type(each) for each in made_up.finish} == {Raster, Rays}
    report = (finished.folder / "report.md").read_text()
    assert "**5 of 6 seas**" in report
    assert "Sea 4: The fit did not come to rest" in report
    with xr.open_dataset(finished.folder / "recovered.nc") as data:
        off = np.abs(data["wind_speed_found"] - data["wind_speed_truth"])
        np.testing.assert_allclose(off, [0.01, 0.1, 0.2, 0.01, np.nan, 0.2], atol=1e-5)
    assert {"recovered.png", "pictures.png"} <= set(finished.files())


def test_each_pattern_may_have_its_own_choppiness(tmp_path, made_up):
    finished = execute(load("picture_recovery", [*SMALL, "truths.own_choppiness=true"], output=str(tmp_path)))
    values = json.loads((finished.folder / "result.json").read_text())
    assert values["interval_coverage"] == pytest.approx(0.6)
    found = [name for name in values["median_error_of"] if "choppiness" in name]
    with xr.open_dataset(finished.folder / "recovered.nc") as data:
        each = [data[f"{name.replace(' ', '_')}_truth"].values for name in found]
    assert len(found) == 2
    assert np.all(np.abs(np.subtract(*each)) > 1e-3)
    # One that is a tenth off is not recovered, whichever it is.
    config = load("picture_recovery", [*SMALL, "truths.own_choppiness=true"]).config
    truth, *_ = _recovery_scenes.draw(config, 0)
    numbers = np.array(_recovery_scenes.values(truth))
    wrong = numbers * np.where(np.arange(numbers.size) == 3, 1.1, 1.0)
    inside = _recovery_scenes.recovered(_recovery_scenes.numbers(config), numbers, wrong)
    assert list(np.flatnonzero(~inside)) == [3]


def test_fits_that_are_to_know_no_rays_finish_with_a_mesh(tmp_path, made_up):
    finished = execute(
        load("picture_recovery", [*SMALL, "finish=raster", "truths.count=1"], output=str(tmp_path))
    )
    assert {type(each) for each in made_up.finish} == {Raster}
    assert "nothing but meshes" in (finished.folder / "report.md").read_text()


def test_limits_that_no_sea_meets_are_named(tmp_path, monkeypatch):
    monkeypatch.setattr(_recovery_scenes, "DRAWS", 2)
    limits = ["truths.least_coverage=0.98", "truths.most_coverage=0.99"]
    with pytest.raises(UserError, match=r"truths\.least_coverage"):
        execute(load("picture_recovery", [*SMALL, *limits], output=str(tmp_path)))


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("wave_recovery", "views=[3,0]", "`views` .* be 1 to 12 each, but one is 0"),
        (
            "picture_recovery",
            "truths.lowest_wind=20",
            r"`truths\.highest_wind` .* be above `lowest_wind` = 20",
        ),
        ("render", "image.samples=4", r"`image\.samples` .* be 1 unless `method` is rays, but is 4"),
    ],
)
def test_configs_that_make_no_sense_are_refused_before_anything_runs(name, value, words):
    with pytest.raises(UserError, match=words):
        load(name, [value])


def test_starts_are_as_far_off_as_is_asked():
    config = load("picture_recovery", SMALL).config
    # Of these some have an ε that could not be a third larger.
    for number in range(6):
        truth, start, coverage = _recovery_scenes.draw(config, number)
        true, begun = (np.array(_recovery_scenes.values(s)) for s in (truth, start))
        assert 0.004 < coverage < 0.06
        off = np.abs(begun - true)
        share = off / np.array([true[0], 1.0, true[2], true[3], true[4], 2.0])
        assert begun[3] <= 0.95 + 1e-6
        assert np.all((share > 0.3 - 1e-5) & (share < 0.4 + 1e-5))


def test_recoveries_are_told_apart_by_their_bounds():
    sought = _recovery_scenes.numbers(load("picture_recovery", SMALL).config)
    each = picture_recovery.Recovery(
        sought, 0, True, 0.01, np.ones(6), np.ones(6), np.ones(6), np.full(6, 0.01), 3, 1.0, False, ""
    )
    assert np.all(each.inside)
    off = dataclasses.replace(each, found=np.array([1.06, 1.06, 1.06, 1.04, 9.0, 1.11]))
    np.testing.assert_array_equal(off.inside, [False, False, False, False, True, False])
    np.testing.assert_array_equal(off.holds(0.9), np.zeros(6, bool))


def test_joint_targets_go_on_after_an_interruption(tmp_path, monkeypatch):
    """Each fit is done once, by a process that has forgotten it too."""
    calls = []

    def fit(start, free, target, *, beside, priors, **_):
        calls.append(float(priors[0].mean))
        if len(calls) == 4:
            raise KeyboardInterrupt
        values = dict(zip(joint_targets.NAMES, map(float, free(start)), strict=True))
        covariance = np.diag(np.array([0.004, 0.01, 0.02]) ** 2)
        errors, doubted = dict.fromkeys(values, 0.01), 0.5 * covariance
        # The free fits come to rest at 1.1, above the bottom.
        cost = 1.0 + 50.0 * (values["choppiness"] - 1.06) ** 2
        return PictureFit(values, errors, (), covariance, doubted, 3.0, cost, (), 1.0, start)

    monkeypatch.setattr(joint_targets, "fit_picture", fit)
    monkeypatch.setattr(joint_targets, "target", lambda scene, size, detail, method: jnp.ones((*size, 3)))
    law = fitting.CoveragePoints([8.0, 12.0], [0.01, 0.02], 0.1)
    monkeypatch.setattr(joint_targets, "_targets", lambda *_: (law, law))
    without = joint_targets.Objective("law", np.ones(2), np.eye(2))
    monkeypatch.setattr(joint_targets, "_without_picture", lambda *_: without)
    monkeypatch.setattr(joint_targets._joint_views, "plot", lambda *_: None)
    monkeypatch.setattr(joint_targets._joint_views, "save", lambda *_: None)
    values = ["height=18", "width=32", "cascade.sizes=[120.0,17.0]", "cascade.resolution=32"]
    loaded = load("joint_targets", [*values, "breaking_wavenumber=4.0"], output=str(tmp_path))
    with pytest.raises(Interrupted, match="each finished fit"):
        execute(loaded)
    finished = execute(loaded)
    # Three were kept, and that at which it was stopped is done again.
    assert len(calls) == 2 + loaded.config.points + 1
    assert calls[3] == calls[4]
    found = json.loads((finished.folder / "result.json").read_text())
    np.testing.assert_allclose(found["values"][2:], [[0.585, 1.06], [0.585, 1.1]], rtol=1e-6)


def test_joint_fits_begin_away_from_the_truth():
    config = schema.JointTargetsConfig(
        cascade=schema.CascadeConfig(sizes=(50.0,), resolution=8), breaking_wavenumber=0.3, away=0.2
    )
    truth = joint_targets._truth(config)
    start = joint_targets._away(config, truth)
    ratios = np.array(joint_targets._free(start)) / np.array(joint_targets._free(truth))
    np.testing.assert_allclose(ratios, [0.8, 1.2, 1.2], rtol=1e-6)
    assert start.threshold.dtype == truth.threshold.dtype


def test_a_picture_beside_a_law_and_slopes_narrows_the_region_of_both_numbers(tmp_path, monkeypatch):
    seen = []

    def fit(start, free, target, *, beside, priors, **_):
        threshold, choppiness, age = (float(each) for each in free(start))
        held = priors[0].deviation < 1e-3
        says = all(float(each.scatter.value) < 1 for each in beside.targets)
        seen.append((held, says, float(target.scatter)))
        # Uncorrelated, and twice as wide as the picture alone would be.
        covariance = np.diag(np.array([0.004, 0.01, 0.02]) ** 2)
        values = {"threshold": threshold, "choppiness": choppiness, "inverse_wave_age": age}
        errors = dict(zip(values, np.sqrt(np.diag(covariance)), strict=True))
        cost = 7.0 + 0.5 * ((choppiness - 1.0) / 0.01) ** 2
        # Half of the variances is doubt.
        doubted = 0.5 * covariance
        return PictureFit(values, errors, tuple(values), covariance, doubted, 3.0, cost, (), 1.0, start)

    def profile(model, free, targets, *, parameter, grid, priors):
        del model, free, targets, priors
        excess, values = ((grid - 1) / 0.4) ** 2, np.ones((len(grid), 3))
        return fitting.Profile(parameter, "-", joint_targets.NAMES, grid, excess, values, 1.0, None, ())

    monkeypatch.setattr(joint_targets, "fit_picture", fit)
    monkeypatch.setattr(joint_targets.fitting, "profile", profile)
    monkeypatch.setattr(joint_targets, "target", lambda scene, size, detail, method: jnp.ones((*size, 3)))
    values = ["height=18", "width=32", "cascade.sizes=[120.0,17.0]", "cascade.resolution=32", "away=0"]
    finished = execute(load("joint_targets", [*values, "breaking_wavenumber=4.0"], output=str(tmp_path)))
    # The picture alone sets the weight; then all three, free and with λ held.
    assert seen == [(False, False, 1.0), (False, True, 3.0), *[(True, True, 3.0)] * 7]
    found = json.loads((finished.folder / "result.json").read_text())
    law, _, joint, picture = found["correlations"]
    assert abs(law) > 0.5
    assert joint == picture == 0.0
    assert found["errors"][2][1] < found["errors"][1][1] <= 1.01 * found["errors"][0][1]
    with xr.open_dataset(finished.folder / "joint.nc") as data:
        # 90 % of a Gaussian of width 0.01.
        grid, excess = data["choppiness_2"].values, data["excess_2"].values
        np.testing.assert_allclose(excess, ((grid - 1) / 0.01) ** 2, rtol=1e-2, atol=1e-2)
    assert "0.984 to 1.016" in (finished.folder / "report.md").read_text()


@pytest.mark.slow
def test_the_waves_of_a_patch_are_found_in_one_picture(tmp_path):
    values = [
        "resolution=16",
        "side=12.0",
        "views=[1]",
        "steps=60",
        "height=24",
        "width=32",
        "wind.speed=6.0",
    ]
    finished = execute(load("wave_recovery", values, output=str(tmp_path)))
    with xr.open_dataset(finished.folder / "waves.nc") as data:
        assert np.corrcoef(data["found"].values.ravel(), data["height"].values.ravel())[0, 1] > 0.95
    assert "correlation" in (finished.folder / "report.md").read_text()
    assert {"waves.png", "pictures.png"} <= set(finished.files())
