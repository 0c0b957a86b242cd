"""`fit_image`, `unknown_seas` and `buoy_photographs` around fits that are made up, and what is no photograph."""

import csv
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from PIL import Image

from experiments import schema
from experiments.harness._errors import Interrupted, UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.harness._progress import Silent
from experiments.pictures import _image_views, _lessons, _photographs, _unknown_scenes, _winds
from fitting import FitError
from fitting.pictures import ImageStatistics, Lesson, Photograph, PhotographFit, PictureStep
from fitting.pictures._summaries import learn
from jaxocean import Wind
from jaxocean.io import write_exr
from jaxocean.render import Camera

SMALL = ["cascade.sizes=[40.0]", "cascade.resolution=32"]
NAMES = ("speed", "sun_elevation", "sun_azimuth", "cover")


def sea_and_sky(columns=160, rows=90, horizon=40, colour=True):
    """A rough sea below a bright sky, as code values."""
    random = np.random.default_rng(0)
    image = np.empty((rows, columns, 3))
    image[:horizon] = (200, 215, 240)
    image[horizon:] = np.array((40, 70, 110)) * np.exp(0.2 * random.normal(size=(rows - horizon, columns, 1)))
    if not colour:
        image[:] = image.mean(axis=-1, keepdims=True)
    return image.clip(0, 255).astype(np.uint8)


def save(folder, pixels, name="sea.png"):
    path = folder / name
    Image.fromarray(pixels).save(path)
    return path


class Watching(Silent):
    """Stops after some counts."""

    def __init__(self, stop_after=None):
        self.counted, self.stop_after = 0, stop_after

    def count(self, what, total):
        def advance():
            self.counted += 1
            if self.counted == self.stop_after:
                raise KeyboardInterrupt

        return advance


class Calls(list):
    """Fits that were asked for; `taught`: the scouts that each lesson began with."""

    def __init__(self):
        super().__init__()
        self.taught = []


@pytest.fixture
def made_up(monkeypatch):
    """Fits that find 9, 10, 11, … m/s within a tenth; pictures are even but for their horizon."""
    calls = Calls()

    def teach(photograph, free, size, *, mask, scouts_before, scouted, **more):
        calls.taught.append(scouts_before)
        names = ImageStatistics(photograph.scene.camera, size, mask).names
        for batch in range(len(scouts_before), 3):
            scouted(np.where(np.arange(len(names)) == 1, np.nan, np.full((2, 1), float(batch))))
        rows = np.random.default_rng(0).normal(size=(4, len(names)))
        plain = learn(rows, np.arange(12.0).reshape(4, 3), (True,) * len(names))
        return Lesson(plain.summaries, np.array([0.8, 0.5, 0.1]))

    def fit(photograph, free, image, *, mask, lesson, **more):
        begin, report = more.get("begin"), more.get("report")
        calls.append({"camera": photograph.scene.camera, "mask": mask, "lesson": lesson, "begin": begin})
        calls[-1]["steps"] = more["most_steps"]
        number = len(calls)
        values = {"speed": 8.0 + number, "sun_elevation": 0.5, "sun_azimuth": 0.1, "cover": 0.4}
        first = 5.0 if begin is None else begin["speed"]
        steps = tuple(PictureStep(i, 2, 3.0 - i, {**values, "speed": first + i}) for i in range(3))
        for step in steps:
            if report is not None:
                report(step)
        slots = tuple(slot for slot, _ in _slots(photograph, free))
        found = np.array([0.1, 0.2, 0.3])
        return PhotographFit(
            values,
            {"speed": 0.5, "sun_elevation": 0.1, "sun_azimuth": 0.1, "cover": 0.1},
            {**values, "speed": 7.0},
            NAMES,
            np.diag([0.06, 0.1, 0.1, 0.1]) ** 2,
            ("level in band 1", "foam in band 2", "relief"),
            found + np.array([0.0, 1.0, 0.1]),
            found,
            np.array([0.1, 0.2, 0.1]),
            1.5,
            steps,
            3.0,
            photograph,
            lesson,
            image.shape[:2],
            slots,
        )

    def _slots(photograph, free):
        from fitting._parameters import resolve

        return resolve(photograph, free, 1)

    def even(self, size, method=None, detail=1):
        up = self.scene.camera.rays(size)[..., 2:]
        sea = 0.1 + 0.01 * self.scene.wind.speed.astype(up.dtype)
        return jnp.where(up > 0, jnp.asarray([0.8, 0.9, 1.0], up.dtype), sea)

    monkeypatch.setattr(_lessons, "teach", teach)
    monkeypatch.setattr(_photographs, "fit_photograph", fit)
    monkeypatch.setattr(Photograph, "picture", even)
    return calls


def result_of(finished):
    return json.loads((finished.folder / "result.json").read_text())


def test_an_image_is_fitted_with_the_camera_that_its_horizon_tells(tmp_path, made_up):
    path = save(tmp_path, sea_and_sky())
    finished = execute(load("fit_image", [f"image={path}", *SMALL], output=str(tmp_path / "runs")))
    values = result_of(finished)
    assert values["wind_speed"] == 9.0
    # Positive numbers are normal in their logarithm: a factor e^±(1.645 × 0.06).
    np.testing.assert_allclose(values["wind_speed_interval"], 9.0 * np.exp([-0.0987, 0.0987]), rtol=1e-3)
    camera = made_up[0]["camera"]
    # 60° from side to side; the horizon is 4.5 rows above the middle.
    focal = 80 / np.tan(np.pi / 6)
    np.testing.assert_allclose(float(camera.pitch), np.arctan2(4.5, focal), atol=0.01)
    np.testing.assert_allclose(float(camera.field_of_view), 2 * np.arctan(45 / focal), rtol=1e-6)
    files = set(finished.files())
    assert {"fitted.png", "filmstrip.png", "statistics.png", "statistics.nc", "report.md"} <= files
    report = (finished.folder / "report.md").read_text()
    assert "**U10 = 9.0 m/s**" in report
    assert "foam in band 2 (+5.0 chances)" in report
    with xr.open_dataset(finished.folder / "statistics.nc") as data:
        assert list(data["statistic"].values) == ["level in band 1", "foam in band 2", "relief"]
        assert float(data["speed"]) == 9.0


def test_the_camera_can_be_given_and_exr_and_masks_are_read(tmp_path, made_up):
    light = (sea_and_sky() / 255.0).astype(np.float32)
    path = write_exr(tmp_path / "sea.exr", dict(zip("RGB", np.moveaxis(light, -1, 0), strict=True)))
    hidden = np.full((90, 160), 255, np.uint8)
    hidden[:, :80] = 0
    mask = save(tmp_path, hidden, "mask.png")
    keys = [
        f"image={path}",
        f"mask={mask}",
        "camera.pitch=0.05",
        "camera.roll=-0.02",
        "camera.field_of_view=0.5",
    ]
    execute(load("fit_image", [*keys, *SMALL], output=str(tmp_path / "runs")))
    camera = made_up[0]["camera"]
    np.testing.assert_allclose(
        [camera.pitch, camera.roll, camera.field_of_view], [0.05, -0.02, 0.5], rtol=1e-6
    )
    np.testing.assert_allclose(made_up[0]["mask"].mean(axis=0)[[0, 70, 90, 159]], [0, 0, 1, 1])


def test_a_camera_that_is_not_known_is_drawn_with_its_horizon_where_the_image_shows_it():
    camera = Camera((0.0, 0.0, 4.0), pitch=0.1, field_of_view=0.6)
    patterns = schema.CascadeConfig(sizes=(50.0,), resolution=8)
    known = _photographs.start(camera, schema.PhotographCameraConfig(), patterns, 0)
    keys = jax.random.split(jax.random.key(0), 400)
    drawn = jax.vmap(lambda key: _photographs.varied(0.3, 0.2)(known, key).scene.camera)(keys)
    np.testing.assert_allclose(np.std(np.log(drawn.position[:, 2] / 4.0)), 0.3, rtol=0.1)
    half = np.tan(0.5 * np.asarray(drawn.field_of_view))
    np.testing.assert_allclose(np.std(np.log(half)), 0.2, rtol=0.1)
    # As a share of the image's height the horizon stays where it is.
    np.testing.assert_allclose(np.tan(drawn.pitch) / half, np.tan(0.1) / np.tan(0.3), rtol=1e-5)
    # The rest is what is drawn for a camera that is known.
    assert _photographs.varied(0.0, 0.0) is _photographs.vary
    plain = _photographs.vary(known, keys[0])
    other = _photographs.varied(0.3, 0.2)(known, keys[0])
    assert float(plain.scene.choppiness) == float(other.scene.choppiness)


def test_without_an_image_one_is_made_whose_wind_is_told(tmp_path, made_up):
    finished = execute(load("fit_image", SMALL, output=str(tmp_path)))
    truth = result_of(finished)["true_wind_speed"]
    assert 4.0 < truth < 20.0
    assert f"made here with {truth:.1f} m/s" in (finished.folder / "report.md").read_text()


def test_an_interrupted_fit_goes_on_from_its_last_step(tmp_path, made_up, monkeypatch):
    path = save(tmp_path, sea_and_sky())
    loaded = load("fit_image", [f"image={path}", *SMALL], output=str(tmp_path / "runs"))
    whole = _photographs.fit_photograph

    def stopped(*args, report, **more):
        def once(step):
            report(step)
            if step.number == 1:
                raise KeyboardInterrupt

        return whole(*args, report=once, **more)

    monkeypatch.setattr(_photographs, "fit_photograph", stopped)
    with pytest.raises(Interrupted, match="goes on from there"):
        execute(loaded)
    monkeypatch.setattr(_photographs, "fit_photograph", whole)
    strip, shown = _image_views.strip, []
    monkeypatch.setattr(_image_views, "strip", lambda *a: shown.extend(a[2]) or strip(*a))
    execute(loaded)
    assert made_up[0]["begin"] is None
    assert made_up[1]["begin"]["speed"] == 6.0
    # One step had been taken.
    assert made_up[1]["steps"] == made_up[0]["steps"] - 1
    # Steps from before the interruption are shown too, and the one from which it went on once.
    titles = [title for title, _ in shown]
    assert titles == ["expected: 8.5 m/s", *(f"step {number}: {5 + number}.0 m/s" for number in range(4))]
    np.testing.assert_allclose(made_up[1]["lesson"].told, [0.8, 0.5, 0.1])


def test_scouts_of_an_interrupted_fit_are_not_drawn_again(tmp_path, made_up):
    path = save(tmp_path, sea_and_sky())
    loaded = load("fit_image", [f"image={path}", *SMALL], output=str(tmp_path / "runs"))
    with pytest.raises(Interrupted, match="what is drawn of the random states"):
        execute(loaded, progress=Watching(stop_after=2))
    execute(loaded)
    assert [len(before) for before in made_up.taught] == [0, 2]
    # Pictures that are not finite teach nothing, but count.
    np.testing.assert_array_equal(made_up.taught[1][1][:, :3], [[1, np.nan, 1]] * 2)


@pytest.mark.parametrize("kept", ["lesson.scouts.jsonl", "lesson.npz"])
def test_what_another_version_has_kept_is_named(tmp_path, made_up, kept):
    loaded = load("unknown_seas", ["count=1", *SMALL], output=str(tmp_path))
    with pytest.raises(Interrupted):
        execute(loaded, progress=Watching(stop_after=2))
    unfinished = next(tmp_path.glob(".*.unfinished"))
    if kept == "lesson.npz":
        other = learn(np.arange(8.0).reshape(4, 2), np.arange(4.0)[:, None], (True, True))
        np.savez(unfinished / kept, **other.arrays)
    else:
        lines = (unfinished / kept).read_text().splitlines()
        (unfinished / kept).write_text("\n".join(line.replace("NaN, ", "") for line in lines))
    with pytest.raises(UserError, match="another version of jaxocean: repeat the run with --force"):
        execute(loaded)
    assert not made_up
    execute(loaded, anew=True)
    assert len(made_up.taught[-1]) == 0


def noisy(rows, columns):
    return np.random.default_rng(1).integers(0, 255, (rows, columns, 3)).astype(np.uint8)


@pytest.mark.parametrize(
    ("prepare", "words"),
    [
        (lambda folder: [f"image={folder / 'none.png'}"], "there is no file"),
        (lambda folder: [f"image={save(folder, sea_and_sky(80, 60, 18))}"], "at least 90×90 pixels"),
        (lambda folder: [f"image={save(folder, sea_and_sky(colour=False))}"], "is grey"),
        (lambda folder: [f"image={save(folder, noisy(90, 160))}"], "shows no horizon"),
        (
            lambda folder: [
                f"image={save(folder, sea_and_sky())}",
                f"mask={save(folder, np.full((45, 80), 255, np.uint8), 'mask.png')}",
            ],
            "must have the 160×90 pixels",
        ),
        (
            lambda folder: [
                f"image={save(folder, sea_and_sky())}",
                f"mask={save(folder, np.zeros((90, 160), np.uint8), 'mask.png')}",
            ],
            "hides the whole image",
        ),
        (
            lambda folder: [
                f"image={save(folder, sea_and_sky())}",
                f"mask={save(folder, np.repeat(np.arange(90)[:, None] < 38, 160, 1).astype(np.uint8) * 255, 'm.png')}",
                "camera.pitch=0.03",
                "camera.roll=0.0",
            ],
            "m.png` hides the sea",
        ),
        (
            lambda folder: [f"image={save(folder, sea_and_sky())}", "camera.pitch=-1.0", "camera.roll=0.0"],
            "Key `camera.pitch`: .* sees no sea",
        ),
        (lambda folder: [f"image={save(folder, np.zeros((90, 160, 3), np.uint8))}"], "shows nothing"),
        (lambda folder: [f"image={save(folder, np.full((90, 160, 3), 255, np.uint8))}"], "shows nothing"),
    ],
)
def test_what_is_no_photograph_of_the_sea_ends_in_one_sentence(tmp_path, prepare, words):
    loaded = load("fit_image", [*prepare(tmp_path), *SMALL], output=str(tmp_path / "runs"))
    with pytest.raises(UserError, match=words) as problem:
        execute(loaded)
    assert "\n" not in str(problem.value)
    assert not list((tmp_path / "runs").iterdir())


def test_a_corrupt_file_is_named(tmp_path):
    path = tmp_path / "sea.jpg"
    path.write_bytes(b"\xff\xd8\xff\xe0 no picture")
    with pytest.raises(UserError, match="cannot be read"):
        execute(load("fit_image", [f"image={path}", *SMALL], output=str(tmp_path / "runs")))
    light = np.full((90, 160), np.nan, np.float32)
    dark = write_exr(tmp_path / "sea.exr", dict.fromkeys("RGB", light))
    with pytest.raises(UserError, match="not finite"):
        execute(load("fit_image", [f"image={dark}", *SMALL], output=str(tmp_path / "runs")))


def test_a_mask_needs_an_image():
    with pytest.raises(UserError, match="mask"):
        load("fit_image", ["mask=a.png"])


def test_a_fit_that_leads_nowhere_is_told_and_counts_for_nothing(tmp_path, made_up, monkeypatch):
    whole = _photographs.fit_photograph

    def second_fails(*args, **more):
        found = whole(*args, **more)
        if len(made_up) == 2:
            raise FitError("It does not come to rest", "a joke", "another")
        return found

    monkeypatch.setattr(_photographs, "fit_photograph", second_fails)
    finished = execute(load("unknown_seas", ["count=3", *SMALL], output=str(tmp_path)))
    values = result_of(finished)
    assert values["failed"] == 1
    assert values["seconds_median"] == 3.0
    assert "It does not come to rest" in " ".join((finished.folder / "summary.txt").read_text().split())


def test_pitch_and_roll_are_given_together():
    with pytest.raises(UserError, match=r"camera\.roll"):
        load("fit_image", ["camera.pitch=0.1"])


def test_unknown_seas_are_counted_and_share_a_lesson(tmp_path, made_up):
    loaded = load("unknown_seas", ["count=4", *SMALL], output=str(tmp_path))
    with pytest.raises(Interrupted):
        execute(loaded, Watching(stop_after=5))
    finished = execute(loaded)
    assert len(made_up) == 4
    assert len(made_up.taught) == 1
    # The tilt is from the horizon, and so nearly that of the camera which is drawn.
    for call in made_up:
        np.testing.assert_allclose([call["camera"].pitch, call["camera"].roll], [0.08, 0.03], atol=2e-3)
        assert float(call["camera"].pitch) != float(np.float32(0.08))
    values = result_of(finished)
    true = [float(_unknown_scenes.draw(loaded.config, i).scene.wind.speed) for i in range(4)]
    off = np.abs(np.log(np.array([9.0, 10.0, 11.0, 12.0]) / true))
    assert values["median_error"] == pytest.approx(np.expm1(np.median(off)), rel=1e-6)
    assert values["interval_coverage"] == pytest.approx(np.mean(off < 1.645 * 0.06))
    assert {"winds.png", "pictures.png", "winds.nc", "report.md"} <= set(finished.files())


def test_buoys_are_compared_with_what_they_measured(tmp_path, made_up):
    folder = tmp_path / "photos"
    folder.mkdir()
    for name in ("A_1.png", "B_2.png"):
        save(folder, sea_and_sky(), name)
    save(folder, noisy(90, 160), "C_3.png")
    with (folder / "labels.csv").open("w", newline="") as lines:
        rows = csv.writer(lines)
        rows.writerows([("file", "wind_speed_m_s"), ("A_1.png", 5), ("B_2.png", 9), ("C_3.png", 7)])
    finished = execute(load("buoy_photographs", [f"folder={folder}", *SMALL], output=str(tmp_path / "runs")))
    values = result_of(finished)
    assert (values["photographs"], values["failed"]) == (3, 1)
    true = [float(Wind.from_meteorological(u, from_degrees=0.0, height=4.0).speed) for u in (5.0, 9.0)]
    np.testing.assert_allclose(values["bias"]["fit"], np.mean(np.array([9.0, 10.0]) - true), rtol=1e-6)
    assert values["rank"]["fit"] == pytest.approx(1.0)
    np.testing.assert_allclose(values["rms"]["constant median wind"], 0.5 * (true[1] - true[0]), rtol=1e-6)
    assert values["rank"]["constant median wind"] is None
    report = (finished.folder / "report.md").read_text()
    assert "shows no horizon" in " ".join((finished.folder / "summary.txt").read_text().split())
    assert "| A | 5.4" in report


def test_a_folder_without_labels_is_named(tmp_path):
    with pytest.raises(UserError, match=r"labels\.csv"):
        execute(load("buoy_photographs", [f"folder={tmp_path}"], output=str(tmp_path / "runs")))
    (tmp_path / "labels.csv").write_text("file,wind\na.png,3\n")
    with pytest.raises(UserError, match="must have the columns"):
        execute(load("buoy_photographs", [f"folder={tmp_path}"], output=str(tmp_path / "runs")))


def test_bright_pixels_are_counted_below_the_horizon():
    random = np.random.default_rng(4)
    light = np.repeat(1 + 0.05 * random.normal(size=(90, 160, 1)), 3, axis=-1)
    light[:45] = 20.0
    foam = random.uniform(size=(90, 160)) < 0.02
    light[45:][foam[45:]] = 3.0
    camera = Camera((0.0, 0.0, 4.0), pitch=0.0, field_of_view=0.6)
    share = _winds.bright_share(light, camera, None)
    assert share == pytest.approx(foam[51:].mean() + 0.00135, abs=2e-3)
    inferred = _winds.Inferred("a", 8.0, 8.0, 7.0, 9.0, 8.0, 1.0, 3.84e-6 * 10**3.41, 1.0)
    assert inferred.from_foam == pytest.approx(10.0)


def test_the_pictures_are_of_jonswap_seas():
    import scipy.integrate

    from fitting._spectral_model import ElfouhailySea

    spectrum = _unknown_scenes.JonswapSea(0.84)(Wind(10.0))
    # A developed one is Pierson & Moskowitz's: Hs = 4 √(α g²/(5 ω_p⁴)), ω_p = 0.84 g/U.
    height = 4 * np.sqrt(0.0081 * 9.81**2 / 5) / (0.84 * 9.81 / 10) ** 2
    assert float(spectrum.significant_wave_height) == pytest.approx(height, rel=0.01)
    k = np.geomspace(1e-3, 50, 4000)
    level = np.asarray(spectrum.harmonics(jnp.asarray(k)).mean)
    assert 4 * np.sqrt(scipy.integrate.trapezoid(level, k)) == pytest.approx(height, rel=0.02)
    other = np.asarray(ElfouhailySea(0.84)(Wind(10.0)).harmonics(jnp.asarray(k)).mean)
    assert np.max(np.abs(np.log(level[k > 0.05] / other[k > 0.05]))) > 0.3
