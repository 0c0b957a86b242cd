"""From a photograph of unknown waves to the state of the sea: statistics, what scouts teach, and the way down."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference
from scipy import ndimage

import jaxocean as jo
from fitting import LogNormal, Parameter
from fitting.pictures import (
    ImageStatistics,
    Lesson,
    Photograph,
    SceneModel,
    TiltedSpectrum,
    UncertainSea,
    fit_photograph,
    teach,
)
from fitting.pictures._summaries import learn
from fitting.pictures._teach import METHOD
from jaxocean.optics.sky import CloudySky, HosekWilkie
from jaxocean.render import Camera, Raster, Rays

SIZE = (90, 160)
CASCADE = jo.surface.Cascade((40.0,), 32)
CAMERA = Camera((0.0, 0.0, 4.0), pitch=0.1, roll=0.05, field_of_view=0.63)


def scene(speed=8.0, camera=CAMERA, seed=0, cascade=CASCADE, **more):
    noise = jo.surface.draw_noise(cascade, key=jax.random.key(seed)).astype(jnp.complex64)
    return SceneModel(
        jo.Wind(speed),
        camera,
        cascade=cascade,
        noise=noise,
        sky=CloudySky(HosekWilkie(3.0), 0.3),
        breaking_wavenumber=2.5,
        **more,
    )


@pytest.fixture(scope="module")
def statistics():
    return ImageStatistics(CAMERA, SIZE)


def noise(seed, sigma=1.0):
    """A rough image of the mean 1."""
    own = ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=SIZE), sigma)
    return np.exp(0.2 * own / own.std())[..., None] * np.array([0.6, 0.8, 1.0])


def named(statistics, image):
    return dict(
        zip(statistics.names, np.asarray(eqx.filter_jit(statistics)(jnp.asarray(image))), strict=True)
    )


def test_exposure_does_not_matter_and_the_white_balance_only_for_what_is_not_steady(statistics):
    image = noise(0)
    first, second = (np.array(list(named(statistics, factor * image).values())) for factor in (1.0, 37.0))
    np.testing.assert_allclose(first, second, atol=1e-6)
    grey = np.repeat(image[..., 1:2], 3, axis=-1)
    tinted = np.array(list(named(statistics, grey * np.array([1.4, 1.0, 0.7])).values()))
    plain = np.array(list(named(statistics, grey).values()))
    steady = np.array(statistics.steady)
    np.testing.assert_allclose(tinted[steady], plain[steady], atol=1e-6)
    assert 0 < (~steady).sum() < steady.sum()


def test_rougher_and_coarser_images_say_so(statistics):
    fine, coarse = (named(statistics, noise(1, sigma)) for sigma in (0.7, 4.0))
    # Of the same variance: differences of single pixels shrink where waves are longer, those of wide squares grow.
    assert coarse["along 1 px in band 3"] < fine["along 1 px in band 3"] - 0.5
    assert coarse["along 8 px in band 6"] > fine["along 8 px in band 6"] + 0.1
    rough = named(statistics, noise(1) ** 2)
    assert rough["spread in band 3"] > named(statistics, noise(1))["spread in band 3"] + 0.5
    # White noise of deviation s: neighbours differ by s√2.
    white = np.exp(0.1 * np.random.default_rng(2).normal(size=(*SIZE, 1))) * np.ones(3)
    normal = np.random.default_rng(3).normal(size=100_000)
    limited = np.std(2 * np.tanh(normal / 2))
    for direction in ("along", "across"):
        found = named(statistics, white)[f"{direction} 1 px in band 4"]
        # The logarithm of 1 + 0.05 shrinks it, and so does the limit of two deviations.
        np.testing.assert_allclose(found, np.log(0.1 * limited * np.sqrt(2) / 1.05), atol=0.05)


def test_the_share_of_foam_is_counted_whatever_it_is(statistics):
    """Against shares that are known, and with a threshold that the foam itself does not lift."""
    random = np.random.default_rng(3)
    image = noise(4)
    for share in (0.003, 0.03):
        foam = random.uniform(size=SIZE) < share
        found = named(statistics, np.where(foam[..., None], 6.0, image))
        for band in (4, 5, 6):
            weight = np.asarray(statistics.bands[band - 1])
            true = np.sum(weight * foam) / np.sum(weight)
            np.testing.assert_allclose(
                np.exp(found[f"foam in band {band}"]) - 3e-4, true, rtol=0.25, atol=2e-3
            )
            np.testing.assert_allclose(np.exp(found[f"bright in band {band}"]), true, rtol=0.3, atol=0.012)


def test_a_wider_glitter_is_wider(statistics):
    aside = np.asarray(statistics.sideways)
    widths = []
    for sigma in (0.03, 0.1):
        image = 0.02 * noise(5) + np.exp(-0.5 * (aside / sigma) ** 2)[..., None]
        widths.append(np.exp(named(statistics, image)["glitter width near"]))
    np.testing.assert_allclose(widths, (0.03, 0.1), rtol=0.4)


def test_a_mask_hides_what_is_there(statistics):
    mask = np.ones(SIZE)
    mask[60:, 40:80] = 0
    masked = ImageStatistics(CAMERA, SIZE, mask)
    image, spoilt = noise(6), noise(6)
    spoilt[60:, 40:80] = 100.0
    first, second = (named(masked, each) for each in (image, spoilt))
    for name, value in first.items():
        np.testing.assert_allclose(second[name], value, atol=1e-6, err_msg=name)


def test_derivatives_match_differences_and_are_finite_where_nothing_is_seen(statistics):
    image, direction = jnp.asarray(noise(7)), jnp.asarray(noise(8)) - 0.8
    value, found = jax.jit(lambda x: jax.jvp(statistics, (x,), (direction,)))(image)
    expected = finite_difference(eqx.filter_jit(statistics), image, direction, 1e-4)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-5)
    for dull in (jnp.ones((*SIZE, 3)), jnp.zeros((*SIZE, 3))):
        value, found = jax.jvp(statistics, (dull,), (direction,))
        assert np.all(np.isfinite(value))
        assert np.all(np.isfinite(found))


@pytest.mark.parametrize(
    ("camera", "mask", "words"),
    [
        (Camera((0.0, 0.0, 4.0), pitch=-0.6, field_of_view=0.6), None, "hardly a pixel"),
        (CAMERA, np.ones((4, 4)), "Argument `mask`"),
        (CAMERA, np.zeros(SIZE), "hides it"),
    ],
)
def test_a_view_of_no_sea_is_refused(camera, mask, words):
    with pytest.raises(ValueError, match=words):
        ImageStatistics(camera, SIZE, mask)


def test_a_tilted_spectrum_has_more_or_fewer_short_waves():
    plain = jo.spectra.Elfouhaily(jo.Wind(9.0))
    k, angle = jnp.array([1e-2, 40.0, 3e3]), jnp.zeros(3)
    tilted = TiltedSpectrum(plain, 0.1, -0.3)
    ratio = np.asarray(tilted.density(k, angle) / plain.density(k, angle))
    np.testing.assert_allclose(ratio, np.exp(0.1) * (1 + (np.asarray(k) / 3) ** 2) ** -0.15, rtol=1e-9)
    slick = TiltedSpectrum(plain, 0.1, -0.3, ripples=-1.2)
    damped = np.asarray(slick.density(k, angle)) / np.asarray(tilted.density(k, angle))
    np.testing.assert_allclose(damped, [1.0, np.exp(-0.6), np.exp(-1.2)], rtol=1e-3)
    for own, other in zip(tilted.harmonics(k), plain.harmonics(k), strict=True):
        np.testing.assert_allclose(own, ratio * other, rtol=1e-9)


def test_an_uncertain_sea_has_its_swell_where_it_is_said():
    sea = UncertainSea(swell_height=2.0, swell_period=12.0, swell_turn=1.0)(jo.Wind(5.0, 0.3))
    plain = UncertainSea()(jo.Wind(5.0, 0.3))
    heights = [float(jo.spectra.significant_wave_height(each, band=(1e-3, 100.0))) for each in (sea, plain)]
    np.testing.assert_allclose(heights[0] ** 2 - heights[1] ** 2, 4.0, rtol=1e-3)
    peak = jnp.asarray([(2 * np.pi / 12.0) ** 2 / 9.81])
    towards, across = (sea.density(peak, jnp.asarray([turn]))[0] for turn in (1.3, 1.3 + np.pi / 2))
    assert towards > 10 * across


@pytest.mark.slow
def test_pictures_of_a_fit_have_the_texture_of_finer_ones():
    cascade, size = jo.surface.Cascade((300.0, 40.0, 7.0), 64), (45, 80)
    statistics = ImageStatistics(CAMERA, size)
    of = eqx.filter_jit(lambda seen, method, detail: statistics(seen.picture(size, method, detail)))
    textures = [number for number, name in enumerate(statistics.names) if "px" in name]
    off = []
    for speed in (5.0, 14.0):
        state = Photograph(scene(speed, cascade=cascade))
        off.append(of(state, METHOD, 1) - of(state, Rays(), 4))
    # Half as many rays in a square are off by 0.08, and as many above each other by 0.09.
    assert np.sqrt(np.mean(np.square(off)[:, textures])) < 0.04


NUMBERS = ("speed", "sun elevation", "sun azimuth", "cover", "excess", "contrast", "blur", "chlorophyll")


@pytest.fixture(scope="module")
def differentiate():
    """Statistics of a picture, drawn in doubles, and their derivatives in `NUMBERS`, all in one program."""
    size, camera = (48, 64), Camera((0.0, 0.0, 12.0), pitch=0.15, roll=0.05, field_of_view=0.5)
    cascade = jo.surface.Cascade((60.0, 9.0), 32)
    noise = jo.surface.draw_noise(cascade, key=jax.random.key(2))
    statistics = ImageStatistics(camera, size)

    def of(x):
        speed, elevation, azimuth, cover, excess, contrast, blur, chlorophyll = x
        state = SceneModel(
            jo.Wind(speed, 0.3),
            camera,
            cascade=cascade,
            noise=noise,
            spectrum=UncertainSea(),
            sky=CloudySky(HosekWilkie(3.0, sun_elevation=elevation, sun_azimuth=azimuth), cover),
            water=jo.optics.Water(chlorophyll),
            breaking_wavenumber=2.5,
        )
        seen = Photograph(state, excess=excess, contrast=contrast, blur=blur)
        return statistics(seen.picture(size, Raster(1.0)))

    @jax.jit
    def along_all(x):
        values, changes = jax.lax.map(lambda way: jax.jvp(of, (x,), (way,)), jnp.eye(len(NUMBERS)))
        return values[0], changes

    return along_all


USUAL = (10.0, 0.6, 0.2, 0.3, 0.2, 1.1, 0.05, 0.2)


@pytest.mark.slow
def test_statistics_of_a_picture_follow_wind_light_foam_and_camera(differentiate):
    x = jnp.array(USUAL)
    _, found = differentiate(x)
    # Scaled so that each number changes them about as much, in two directions so that none hides another.
    scale = np.array([1.0, 0.2, 0.1, 2.0, 5.0, 0.5, 0.2, 5.0])
    for way in (scale, scale * np.array([1, -1, 1, -1, -1, 1, -1, 1])):
        expected = (differentiate(x + 1e-5 * way)[0] - differentiate(x - 1e-5 * way)[0]) / 2e-5
        off = np.linalg.norm(expected - way @ np.asarray(found)) / np.linalg.norm(expected)
        assert off < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    "changed",
    [{0: 1e-3, 2: np.pi}, {1: np.pi / 2, 3: 1.0}, {1: -0.4, 3: 0.0, 4: -9.0}],
    ids=["calm sea, sun behind", "sun at the zenith, overcast", "clear night, no foam"],
)
def test_statistics_of_a_picture_are_finite_in_extreme_scenes(differentiate, changed):
    x = np.array(USUAL)
    x[list(changed)] = list(changed.values())
    values, changes = differentiate(jnp.asarray(x))
    assert np.all(np.isfinite(values))
    assert np.all(np.isfinite(changes))


def test_a_photograph_breaks_as_the_law_says():
    photograph = Photograph(scene(11.0), excess=0.3)
    broken = jax.jit(lambda p: p.breaking().ocean().coverage())(photograph)
    expected = 10**0.3 * float(photograph.law.coverage(jo.Wind(11.0)))
    np.testing.assert_allclose(broken, expected, rtol=1e-2)


def test_the_camera_has_a_response():
    light = jnp.asarray(noise(9), jnp.float32)
    plain = Photograph(scene())
    np.testing.assert_allclose(plain.seen(light), light, rtol=1e-6)
    np.testing.assert_allclose(Photograph(scene(), contrast=1.2).seen(light), light**1.2, rtol=1e-5)
    kernel = np.array([0.1, 0.8, 0.1])
    blurred = light
    for axis in (0, 1):
        blurred = ndimage.convolve1d(np.asarray(blurred), kernel, axis=axis, mode="nearest")
    np.testing.assert_allclose(Photograph(scene(), blur=0.1).seen(light), blurred, rtol=1e-5)


def test_a_camera_afloat_is_as_high_above_the_water_below_it_as_it_says(monkeypatch):
    from fitting.pictures import _scene_model

    afloat = scene(12.0, afloat=True)
    seen = []
    monkeypatch.setattr(
        _scene_model,
        "render",
        lambda ocean, camera, *a, **k: seen.append(camera) or jnp.zeros((4, 4, 3), jnp.float32),
    )
    afloat.picture((4, 4))
    place, height = np.asarray(seen[0].position[:2]), float(seen[0].position[2])
    water = float(afloat.ocean().sea.height_at(place, 0.0, afloat.choppiness))
    np.testing.assert_allclose(height - water, 4.0, atol=2e-3)
    assert np.hypot(*place) > 0.01


class Blotches(Photograph):
    """Quick pictures whose roughness and bright spots follow from the wind, and whose glitter is where the sun is."""

    def pictures(self, noises, size, method=None, detail=1):
        speed, azimuth = self.scene.wind.speed.astype(jnp.float32), self.scene.sky.clear.sun_azimuth

        def of(noise):
            rough = jax.image.resize(noise[0].real, size, "linear")
            rough = rough / jnp.std(rough)
            spots = jax.nn.sigmoid((rough - 3.2 + 0.12 * speed) / 0.05)
            across = jnp.linspace(-0.5, 0.5, size[1], dtype=jnp.float32)
            glitter = jnp.exp(4 * jnp.cos(azimuth.astype(jnp.float32) - across))
            grey = jnp.exp(0.03 * speed * rough) * (1 + 0.02 * glitter) + 3 * spots
            return grey[..., None] * jnp.asarray([0.6, 0.8, 1.0], jnp.float32)

        return jax.lax.map(of, noises)


FREE = (
    Parameter(lambda m: m.scene.wind.speed, prior=LogNormal(8.0, 0.6)),
    Parameter(lambda m: m.scene.sky.clear.sun_azimuth),
)


def toy(speed=8.0, azimuth=0.0):
    sky = CloudySky(HosekWilkie(3.0, sun_azimuth=azimuth), 0.3)
    return Blotches(eqx.tree_at(lambda s: (s.wind.speed, s.sky), scene(speed), (jnp.asarray(speed), sky)))


@pytest.fixture(scope="module")
def fitted():
    """A fit to a picture of waves that the model does not hold, and what it told on its way."""
    truth = toy(12.0, 0.4)
    image = truth.pictures(truth.noises(1, 77), SIZE)[0]
    told = {"steps": [], "scouts": []}
    lesson = teach(toy(), FREE, SIZE, scouts=256, scouted=told["scouts"].append)
    found = fit_photograph(toy(), FREE, np.asarray(image), lesson=lesson, seas=4, report=told["steps"].append)
    return image, found, told


def test_the_state_is_found_within_its_interval_and_the_way_is_told(fitted):
    _, found, told = fitted
    low, high = found.interval("speed", 0.99)
    assert low < 12.0 < high
    assert found.values["speed"] == pytest.approx(12.0, rel=0.15)
    assert abs(found.values["sun_azimuth"] - 0.4) < 0.6
    assert [len(each) for each in told["scouts"]] == [32] * 8
    assert told["steps"] == list(found.steps)
    assert found.model.scene.wind.speed == pytest.approx(found.values["speed"])
    assert found.misfit < 2.5
    assert found.errors["speed"] > 0


def test_a_lesson_and_a_beginning_lead_to_the_same_place(fitted):
    image, found, _ = fitted
    again = Lesson.of(found.lesson.arrays)
    found_again = fit_photograph(toy(), FREE, np.asarray(image), seas=4, lesson=again, begin=found.values)
    assert found_again.values["speed"] == pytest.approx(found.values["speed"], rel=0.05)
    with pytest.raises(ValueError, match="Argument `begin`"):
        fit_photograph(toy(), FREE, np.asarray(image), lesson=again, begin={"speed": 3.0})


def test_scouts_drawn_before_teach_the_same(fitted):
    _, found, told = fitted
    drawn = []
    again = teach(toy(), FREE, SIZE, scouts=256, scouts_before=told["scouts"][:7], scouted=drawn.append)
    assert len(drawn) == 1
    np.testing.assert_allclose(drawn[0], told["scouts"][7], rtol=1e-6)
    np.testing.assert_allclose(again.summaries.weights, found.lesson.summaries.weights, rtol=1e-6, atol=1e-9)
    for wrong in (told["scouts"][0][:5], told["scouts"][0][:, 1:]):
        with pytest.raises(ValueError, match="Argument `scouts_before`"):
            teach(toy(), FREE, SIZE, scouts=256, scouts_before=[wrong])


def test_scouts_whose_pictures_are_not_finite_teach_nothing_and_are_counted(fitted):
    _, found, told = fitted
    some = [each.copy() for each in told["scouts"]]
    some[3][5:8, 0] = np.nan
    with pytest.warns(UserWarning, match="3 of 256 random states teach nothing"):
        lesson = teach(toy(), FREE, SIZE, scouts=256, scouts_before=some)
    assert len(lesson.summaries.known) == len(found.lesson.summaries.known) - 3


def test_a_step_can_be_looked_at(fitted):
    _, found, _ = fitted
    state = found.at({"speed": 3.0, "sun_azimuth": -1.0})
    assert float(state.scene.wind.speed) == 3.0
    assert float(state.scene.sky.clear.sun_azimuth) == -1.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"scouts": 3}, "Argument `scouts`"),
        ({"image": np.full((*SIZE, 3), np.nan)}, "must be finite"),
        ({"image": np.zeros((*SIZE, 3))}, "must hold light"),
        ({"begin": {"speed": -3.0, "sun_azimuth": 0.0}}, "`speed` is -3"),
        ({"lesson": learn(np.eye(4), np.eye(4)[:, :3], (True,) * 4)}, "Argument `lesson`"),
        ({"detail": 0}, "Argument `detail`"),
        ({"seas": 0}, "Argument `seas`"),
        ({"seas": 33}, "Argument `seas`"),
        ({"mask": np.zeros(SIZE)}, "Argument `mask`"),
        ({"free": Parameter(lambda m: m.scene.camera.position)}, "single numbers"),
    ],
)
def test_what_makes_no_sense_is_named(change, words):
    arguments = {"photograph": toy(), "free": FREE, "image": noise(0), **change}
    with pytest.raises(ValueError, match=words):
        fit_photograph(**arguments)


def test_levels_and_names_of_intervals_are_checked(fitted):
    _, found, _ = fitted
    with pytest.raises(ValueError, match="Argument `name`"):
        found.interval("height")
    with pytest.raises(ValueError, match="Argument `level`"):
        found.interval("speed", 1.0)


def test_summaries_follow_what_is_not_a_straight_line_and_say_how_well():
    random = np.random.default_rng(2)
    rows = random.uniform(-2, 2, (300, 2))
    goals = np.stack([rows[:, 0] ** 2, np.sin(2 * rows[:, 1])], axis=1) + 0.05 * random.normal(size=(300, 2))
    new = random.uniform(-2, 2, (200, 2))
    lesson = learn(rows, goals, (True, True))
    assert np.all(lesson.told > 0.95)
    found = np.asarray(lesson.summaries(jnp.asarray(new)))
    # What is told of scenes left out is what new ones show.
    missed = found - np.stack([new[:, 0] ** 2, np.sin(2 * new[:, 1])], axis=1)
    off = 1 - (missed.var(axis=0) + 0.05**2) / goals.var(axis=0)
    np.testing.assert_allclose(lesson.told, off, atol=0.01)
    again = Lesson.of(lesson.arrays)
    np.testing.assert_array_equal(np.asarray(again.summaries(jnp.asarray(new))), found)


def test_summaries_tell_what_statistics_tell_and_nothing_of_what_does_not_count():
    random = np.random.default_rng(0)
    goals = random.normal(size=(600, 2))
    rows = np.stack(
        [goals[:, 0] + 0.1 * random.normal(size=600), goals[:, 1], random.normal(size=600)], axis=1
    )
    lesson = learn(rows, goals, (True, False, True))
    np.testing.assert_allclose(lesson.told, [0.99, 0.0], atol=0.02)
    found = np.asarray(lesson.summaries(jnp.asarray(rows)))
    assert np.corrcoef(found[:, 0], goals[:, 0])[0, 1] > 0.99
    # The second statistic is not steady, and so nothing tells the second goal.
    np.testing.assert_allclose(found[:, 1], 0.0, atol=0.5)
