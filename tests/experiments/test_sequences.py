"""`animate` and `flyover` on tiny pictures: one compiled picture serves all tests here."""

import fnmatch
import json
import os
import shutil
import sys

import imageio.v3 as imageio
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr

from experiments.__main__ import main
from experiments.harness._errors import Interrupted, UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.harness._progress import Silent
from experiments.pictures import _scene, animate
from experiments.pictures._flicker import flicker, relative_flicker
from experiments.pictures._frames import Frames
from experiments.pictures._path import Path as CameraPath
from jaxocean import render
from jaxocean.io import read_exr, write_png

SCENE = """
wind: {speed: 12.0}
cascade: {sizes: [150, 13], resolution: 32}
breaking_wavenumber: 5.0
sky: {kind: even, radiance: [0.3, 0.4, 0.6], sun: [1.0, 0.9, 0.8], sun_elevation: 0.6, sun_azimuth: 1.0}
water: {colour: [0.02, 0.05, 0.08]}
image: {height: 18, width: 32}
threshold: 0.7
"""
MOVING = """
experiment: animate
start: 3.0
duration: 1.5
frames_per_second: 2.0
path:
  - {time: 3.0, position: [0, 0, 20], heading: 0.2, pitch: 0.3}
  - {time: 3.5, position: [4, 1, 15], heading: 0.3, pitch: 0.3}
  - {time: 4.0, position: [9, 2, 12], heading: 0.5, pitch: 0.4}
exr: true
"""
CLIMB = "experiment: flyover\nlowest: 10\nhighest: 1000\nheights: 3\nrepeats: 3\ncamera: {pitch: 0.5}\n"


class Watching(Silent):
    """Counts what is rendered, and stops after some frames."""

    def __init__(self, stop_after: int | None = None) -> None:
        self.stop_after, self.frames, self.compiled = stop_after, 0, []

    def count(self, what, total):
        def advance():
            self.frames += 1
            self.compiled.append(COMPILED["count"])
            if self.frames == self.stop_after:
                raise KeyboardInterrupt

        return advance


COMPILED = {"count": 0}


def _listen(event: str, seconds: float, **_: object) -> None:
    del seconds
    COMPILED["count"] += "backend_compile" in event


def config(folder, content: str, *overrides: str):
    file = folder / "mine.yaml"
    file.write_text(content + SCENE)
    return load(str(file), overrides, output=str(folder / "runs"))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A sequence that was interrupted after two of three frames, lost the first of them, and was gone on with."""
    folder = tmp_path_factory.mktemp("sequence")
    loaded = config(folder, MOVING)
    first, second = Watching(stop_after=2), Watching()
    jax.monitoring.register_event_duration_secs_listener(_listen)
    try:
        with pytest.raises(Interrupted, match="2 of 3 frames are kept"):
            execute(loaded, first)
        left = next((folder / "runs").glob(".*.unfinished")) / "filtered"
        kept = {file.name: file.stat().st_mtime_ns for file in left.glob("*.png")}
        (left / "frame_00000.png").unlink()
        finished = execute(loaded, second)
    finally:
        jax.monitoring.unregister_event_duration_listener(_listen)
    return loaded, finished, kept, first, second


def test_an_interrupted_sequence_goes_on_with_the_frames_that_are_missing(made):
    _, finished, kept, _, second = made
    assert set(kept) == {"frame_00000.png", "frame_00001.png"}
    assert second.frames == 2
    files = {file.name: file.stat().st_mtime_ns for file in (finished.folder / "frames").iterdir()}
    assert set(files) == {f"frame_0000{i}.{kind}" for i in range(3) for kind in ("png", "exr")}
    assert files["frame_00001.png"] == kept["frame_00001.png"]
    assert files["frame_00000.png"] > kept["frame_00000.png"]
    assert not list(finished.folder.parent.glob(".*.unfinished"))
    with xr.open_dataset(finished.folder / "sequence.nc") as data:
        assert data.exposure.values.tolist() == [data.exposure.values[0]] * 3
        np.testing.assert_allclose(data.time, [3.0, 3.5, 4.0])
        np.testing.assert_allclose(data.camera_height, [20, 15, 12])


def test_no_frame_after_the_first_compiles_anything(made):
    *_, first, second = made
    assert first.compiled[0] > 0
    assert first.compiled[1] == first.compiled[0]
    assert second.compiled[1] == second.compiled[0]


def test_a_frame_is_the_picture_of_its_time_from_its_place(made):
    loaded, finished, *_ = made
    settings = loaded.config
    exposure = json.loads((finished.folder / "result.json").read_text())["exposure"]
    camera = render.Camera((9.0, 2.0, 12.0), heading=0.5, pitch=0.4, field_of_view=1.0, roll=0.0)
    layers = render.render_layers(
        _scene.ocean(settings), camera, 4.0, (18, 32), method=render.Raster(4.0), curvature=0.0
    )
    code = _scene.code(settings, exposure, np.asarray(layers.radiance))
    frame = imageio.imread(finished.folder / "frames" / "frame_00002.png")
    assert np.abs(frame - np.round(255 * code)).max() <= 1
    assert np.abs(frame.astype(float) - imageio.imread(finished.folder / "frames/frame_00000.png")).mean() > 2


def test_a_frame_keeps_its_light_and_layers_too(made):
    loaded, finished, *_ = made
    exposure = json.loads((finished.folder / "result.json").read_text())["exposure"]
    layers = read_exr(finished.folder / "frames" / "frame_00001.exr")
    radiance = np.stack([layers[name] for name in "RGB"], axis=-1)
    frame = imageio.imread(finished.folder / "frames" / "frame_00001.png")
    code = _scene.code(loaded.config, exposure, radiance)
    assert np.abs(frame - 255 * code).max() < 1.0
    assert {"sun.R", "sky.G", "foam.B", "coverage.Y", "depth.Z"} <= set(layers)


def test_gif_and_report_hold_the_whole_sequence(made):
    _, finished, *_ = made
    assert imageio.imread(finished.folder / "animation.gif", index=None).shape == (3, 18, 32, 3)
    assert "3 frames at 2 per second" in (finished.folder / "report.md").read_text()
    assert "frames/ (6 files)" in finished.contents()
    assert (finished.folder / "sequence.png").is_file()


def test_an_mp4_is_made_where_ffmpeg_is_there_and_said_to_be_missing_where_not(made, tmp_path, monkeypatch):
    _, finished, *_ = made
    if (finished.folder / "animation.mp4").is_file():
        assert (finished.folder / "animation.mp4").stat().st_size > 500
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    without = execute(config(tmp_path, MOVING))
    assert not (without.folder / "animation.mp4").exists()
    assert (without.folder / "animation.gif").is_file()
    assert "pip install jaxocean[video]" in " ".join(without.summary().split())


def test_what_an_interrupted_run_left_is_thrown_away_when_all_shall_be_new(tmp_path):
    loaded = config(tmp_path, MOVING)
    with pytest.raises(Interrupted):
        execute(loaded, Watching(stop_after=1))
    again = Watching()
    execute(loaded, again, anew=True)
    assert again.frames == 3


def test_a_camera_under_water_is_refused_with_the_time_before_anything_is_rendered(tmp_path):
    loaded = config(tmp_path, MOVING)
    ocean = _scene.ocean(loaded.config)
    places = [np.array([x, 0.0]) for x in np.arange(0.0, 150.0, 10.0)]
    water = [float(ocean.sea.height_at(place, 3.5, 1.0)) for place in places]
    x, level = places[int(np.argmax(water))][0], max(water)
    assert level > 0.3
    low = MOVING.replace("[4, 1, 15]", f"[{x}, 0, {0.5 * level}]")
    watching = Watching()
    with pytest.raises(UserError, match=r"At 3\.5 s the camera is at a height of"):
        execute(config(tmp_path, low), watching)
    assert watching.frames == 0


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("frames_per_second: 2.0", "frames_per_second: 0", "`frames_per_second` in * must be greater than 0"),
        ("duration: 1.5", "duration: -1.0", "`duration` in * must be greater than 0"),
        ("duration: 1.5", "duration: 90000.0", "`duration` in * must be such that * at most 100000 frames"),
        ("time: 4.0", "time: 3.2", "`path` in * must hold times that increase, but 3.2 s follows 3.5 s"),
        ("[0, 0, 20]", "[0, 0, -1]", "must have a height greater than 0 m, but it is -1"),
        (", pitch: 0.4", "", "`path.2.pitch` in * must be given where there is no `target`"),
        (
            "pitch: 0.4",
            "pitch: 0.4, target: [1, 2, 3]",
            "`path.2.target` in * must be null where `heading` or",
        ),
        ("start:", "compare: [unfiltered, unfiltered]\nstart:", "`compare` in * must hold each name once"),
    ],
)
def test_bad_sequences_are_refused_in_one_sentence_with_exit_code_2(
    tmp_path, monkeypatch, capsys, old, new, says
):
    file = tmp_path / "mine.yaml"
    file.write_text(MOVING.replace(old, new) + SCENE)
    monkeypatch.setattr(sys, "argv", ["jaxocean", "run", str(file), "--output", str(tmp_path / "runs")])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    said = capsys.readouterr().err
    assert fnmatch.fnmatch(said, f"*{says}*")
    assert len(said.strip().splitlines()) == 1


def test_a_path_passes_its_key_frames_turns_the_shorter_way_and_stays_between_them(tmp_path):
    turning = MOVING.replace("heading: 0.3", "heading: -6.0").replace("heading: 0.5", "heading: -5.8")
    path = CameraPath(config(tmp_path, turning).config)
    np.testing.assert_allclose(path.place(3.5)[:3], [4, 1, 15])
    heading = np.array([path.place(t)[3] for t in np.linspace(2, 5, 61)])
    np.testing.assert_allclose(heading[[0, -1]], [0.2, 2 * np.pi - 5.8], atol=1e-12)
    assert np.all(np.diff(heading) >= -1e-12)
    height = np.array([path.place(t)[2] for t in np.linspace(3, 4, 61)])
    assert np.all(np.diff(height) < 0)
    # The direction of flight does not jump at the key frame in between.
    before, at, after = (np.array(path.place(t)[:3]) for t in (3.499, 3.5, 3.501))
    np.testing.assert_allclose((at - before) / 1e-3, (after - at) / 1e-3, rtol=0.02)


def test_key_frames_may_give_a_target_roll_and_field_of_view(tmp_path):
    whole = "heading: 0.2, pitch: 0.3", "heading: 0.3, pitch: 0.3", "heading: 0.5, pitch: 0.4"
    aims = "target: [50, 0, 0]", "target: [50, 0, 0], roll: 0.2", "target: [50, 0, 0], field_of_view: 0.5"
    aimed = MOVING
    for old, new in zip(whole, aims, strict=True):
        aimed = aimed.replace(old, new)
    path = CameraPath(config(tmp_path, aimed).config)
    for time in np.linspace(2.5, 4.5, 21):
        pixel, ahead = path(time).project(jnp.array([50.0, 0.0, 0.0]), (18, 32))
        np.testing.assert_allclose(pixel, [16, 9], atol=1e-6)
        assert ahead > 0
    np.testing.assert_allclose(path.place(3.5)[5:], [0.2, 1.0])
    np.testing.assert_allclose(path.place(4.0)[5:], [0.0, 0.5])
    # One target among headings says where to look at its own time.
    mixed = CameraPath(config(tmp_path, MOVING.replace(whole[1], aims[0])).config)
    np.testing.assert_allclose(mixed.place(3.5)[3:5], [np.arctan2(-1, 46), np.arctan2(15, np.hypot(46, 1))])
    np.testing.assert_allclose(mixed.place(3.0)[3:5], [0.2, 0.3])


def test_frames_survive_a_line_that_was_cut_off(tmp_path):
    frames = Frames(tmp_path, 3)
    frames.keep(0, np.zeros((2, 2, 3)), {"coverage": 0.1})
    with (tmp_path / "numbers.jsonl").open("a") as file:
        file.write('{"frame": 1, "cov')
    frames.keep(2, np.zeros((2, 2, 3)), {"coverage": float("nan")})
    assert list(frames.numbers()) == [0, 2]
    os.unlink(frames.file(0))
    assert list(frames.numbers()) == [2]


def test_flicker_is_the_second_difference_in_time(tmp_path):
    def sequence(name, levels):
        return [
            write_png(tmp_path / f"{name}{i}.png", np.full((2, 3, 3), level / 255))
            for i, level in enumerate(levels)
        ]

    fade, blink = sequence("fade", [10, 20, 30, 40]), sequence("blink", [10, 20, 10, 20])
    np.testing.assert_allclose(flicker(fade), [0, 0], atol=1e-6)
    np.testing.assert_allclose(flicker(blink), [20, 20], rtol=1e-6)
    np.testing.assert_allclose(flicker(blink, blink), [0, 0], atol=1e-6)
    np.testing.assert_allclose(flicker(fade, blink), [20, 20], rtol=1e-6)
    assert relative_flicker(np.array([1.0, 3.0, 1.0, 3.0])) == pytest.approx(2.0)


def test_a_climb_sees_larger_footprints_and_in_the_end_the_coverage_of_the_sea(tmp_path):
    loaded = config(tmp_path, CLIMB)
    finished = execute(loaded)
    found = json.loads((finished.folder / "result.json").read_text())
    np.testing.assert_allclose(found["height"], [10, 100, 1000])
    growth = np.array(found["footprint"][1:]) / found["footprint"][:-1]
    np.testing.assert_allclose(growth, [10, 10], rtol=0.35)
    # The coverage of this very sea, by throwing points on it; seen from above, so weighted by j.
    ocean = _scene.ocean(loaded.config)
    places = jnp.asarray(np.random.default_rng(0).uniform(0, 1e4, (20_000, 2)))
    j = np.asarray(ocean.jacobian(places, 1.0))
    counted = float(np.mean(np.where((j > 0) & (j < 0.7), j, 0)))
    assert found["coverage_seen"][-1] == pytest.approx(counted, rel=0.15)
    assert found["coverage_plane"] == pytest.approx(float(ocean.coverage()))
    with xr.open_dataset(finished.folder / "flyover.nc") as data:
        assert data.render_time.shape == (3, 3)
        assert float(data.render_time.min()) > 0
    assert {"flyover.png", "heights.png", "report.md"} <= set(finished.files())


def test_a_sequence_may_follow_rays_but_not_compare_them(tmp_path):
    rays = "image.method=rays", "image.samples=2"
    image = config(tmp_path, MOVING, *rays).config.image
    assert animate._method(image, animate.LOOKS["filtered"]) == render.Rays(2)
    with pytest.raises(UserError, match=r"`compare` .* must be empty with the method rays"):
        config(tmp_path, MOVING, *rays, "compare=[unfiltered]")


def test_a_climb_has_no_target(tmp_path):
    with pytest.raises(UserError, match=r"`camera\.target` .* must be null: a climb keeps its heading"):
        config(tmp_path, CLIMB.replace("pitch: 0.5", "target: [9, 9, 0]"))


def test_a_climb_that_goes_down_is_refused(tmp_path):
    with pytest.raises(UserError, match="must be above `lowest` = 10 m, but is 5 m"):
        config(tmp_path, CLIMB, "highest=5.0")


@pytest.mark.slow
def test_a_filtered_sequence_flickers_less_than_an_unfiltered_one(tmp_path):
    far = MOVING.replace("path:", "compare: [unfiltered, supersampled]\npath:").replace(
        "pitch: 0.3", "pitch: 0.1"
    )
    finished = execute(config(tmp_path, far))
    found = json.loads((finished.folder / "result.json").read_text())
    assert found["flicker"]["filtered"] < found["flicker"]["unfiltered"]
    assert found["flicker_of_error"]["filtered"] < 0.7 * found["flicker_of_error"]["unfiltered"]
    assert "unfiltered/ (3 files)" in finished.contents()
    shutil.rmtree(finished.folder)
