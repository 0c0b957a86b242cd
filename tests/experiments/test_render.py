"""The experiment `render` on a small picture."""

import equinox as eqx
import imageio.v3 as imageio
import jax.numpy as jnp
import numpy as np
import pytest

from experiments import schema
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.pictures import _scene
from jaxocean import imagery, optics, render
from jaxocean.io import read_exr

SMALL = [
    "image.height=36",
    "image.width=64",
    "cascade.resolution=32",
    "cascade.sizes=[200,20]",
    "breaking_wavenumber=5.0",
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return execute(load("render", SMALL, output=str(tmp_path_factory.mktemp("runs")))).folder


def test_a_picture_of_the_wanted_size_shows_sky_above_sea(folder):
    picture = imageio.imread(folder / "picture.png")
    assert picture.shape == (36, 64, 3)
    assert picture.std() > 5
    layers = read_exr(folder / "layers.exr")
    assert layers["sea.Y"][0].max() == 0
    assert layers["sea.Y"][-1].min() == 1


def test_the_layers_add_up_to_the_picture_and_are_numbers(folder):
    layers = read_exr(folder / "layers.exr")
    parts = ("sun", "sky", "water", "foam", "background")
    for colour in "RGB":
        np.testing.assert_allclose(
            sum(layers[f"{part}.{colour}"] for part in parts), layers[colour], rtol=1e-4, atol=1e-6
        )
    assert all(np.all(np.isfinite(plane)) for plane in layers.values())
    assert 0 <= layers["coverage.Y"].min() <= layers["coverage.Y"].max() <= 1
    assert "of that is foam" in (folder / "report.md").read_text()


@pytest.mark.slow
def test_rays_draw_the_picture_that_the_mesh_draws(folder, tmp_path):
    rays = ["image.method=rays", "image.samples=2"]
    other = execute(load("render", [*SMALL, *rays], output=str(tmp_path))).folder
    drawn, traced = (read_exr(each / "layers.exr") for each in (folder, other))
    assert all(np.all(np.isfinite(plane)) for plane in traced.values())
    np.testing.assert_allclose(traced["sea.Y"].mean(), drawn["sea.Y"].mean(), atol=0.01)
    sea = (drawn["sea.Y"] == 1) & (traced["sea.Y"] == 1)
    assert np.corrcoef(np.log(drawn["depth.Z"][sea]), np.log(traced["depth.Z"][sea]))[0, 1] > 0.99
    assert np.corrcoef(drawn["G"].ravel(), traced["G"].ravel())[0, 1] > 0.9


@pytest.mark.parametrize(("elevation", "darkest", "brightest"), [(-0.1, 25, 90), (-0.4, 0, 2)])
def test_dusk_is_dim_and_night_is_black(tmp_path, folder, elevation, darkest, brightest):
    done = execute(load("render", [*SMALL, f"sky.sun_elevation={elevation}"], output=str(tmp_path)))
    mean, by_day = (imageio.imread(each / "picture.png").mean() for each in (done.folder, folder))
    assert by_day > 110
    assert darkest <= mean <= brightest


def test_an_exposure_is_as_bright_as_the_picture_wants_unless_it_is_night():
    config = load("render").config
    assert isinstance(config, schema.RenderConfig)
    day, night = np.full((2, 2, 3), 0.1), np.full((2, 2, 3), 1e-9)
    assert _scene.exposure(config, day) == pytest.approx(1.8, rel=1e-3)
    # Ten candela per square metre: 683 lm/W and an observer of 106.9 nm.
    assert _scene.exposure(config, night) == pytest.approx(0.18 * 683 * 106.9 / 10, rel=1e-3)
    given = config.model_copy(update={"image": config.image.model_copy(update={"exposure": 3.0})})
    assert _scene.exposure(given, night) == 3.0


def scene(*overrides, name="render") -> schema.RenderConfig:
    config = load(name, [*SMALL, *overrides] if name == "render" else overrides).config
    assert isinstance(config, schema.RenderConfig)
    return config


@pytest.mark.parametrize(
    ("override", "part", "expected"),
    [
        ("shading.fresnel=schlick", "fresnel", optics.SchlickFresnel()),
        ("shading.refractive_index=1.5", "fresnel", optics.ExactFresnel(1.5)),
        ("shading.extinction=0.1", "fresnel", optics.ExactFresnel(1.34, 0.1)),
        ("shading.sky_reflection=facet", "sky_reflection", optics.FacetReflection()),
        ("shading.sky_reflection=bruneton", "sky_reflection", optics.BrunetonReflection()),
        ("shading.masking=independent", "masking", optics.IndependentMasking()),
        ("shading.masking=azimuth_correlated", "masking", optics.AzimuthCorrelatedMasking()),
        ("shading.mixing=additive", "mixing", optics.AdditiveMixing()),
        ("foam.view=flat", "foam_view", optics.FlatFoam()),
        ("foam.view=crest", "foam_view", optics.CrestFoam(11.0)),
    ],
)
def test_a_config_reaches_every_choice_of_the_shading(override, part, expected):
    shading, usual = _scene.ocean(scene(override)).shading, optics.Shading()
    assert eqx.tree_equal(getattr(shading, part), expected)
    assert not eqx.tree_equal(getattr(shading, part), getattr(usual, part))
    assert eqx.tree_equal(_scene.ocean(scene()).shading, usual)


def test_foam_may_be_red_shy_and_old():
    plain, coloured, old = (
        np.asarray(_scene.ocean(scene(*changes)).foam.reflectance())
        for changes in ([], ["foam.colour=frouin"], ["foam.reflectance=0.55", "foam.age=4.706"])
    )
    np.testing.assert_allclose(plain, 0.22)
    np.testing.assert_allclose(coloured, 0.22 * np.asarray(optics.frouin_colour()))
    # Two fading times of 2.353 s.
    np.testing.assert_allclose(old, 0.55 * np.exp(-2.0), rtol=1e-3)


def test_a_spectral_sky_is_nearly_the_clear_one():
    spectral = _scene.sky(scene("sky.kind=spectral").sky)
    clear = _scene.sky(scene("sky.turbidity=3.0", "sky.sun_elevation=0.7", "sky.sun_azimuth=0.0").sky)
    assert isinstance(spectral, optics.sky.SpectralHosekWilkie)
    np.testing.assert_allclose(spectral.irradiance(), clear.irradiance(), rtol=0.05)


def test_clouds_hide_their_share_of_the_sun():
    clear, cloudy = (_scene.sky(scene(f"sky.cover={cover}").sky) for cover in (0.0, 0.6))
    assert isinstance(clear, optics.sky.HosekWilkie)
    np.testing.assert_allclose(cloudy.sun_irradiance, 0.4 * clear.sun_irradiance, rtol=1e-5)


@pytest.mark.slow
def test_the_layer_of_coverage_is_the_foam_that_is_seen(folder, tmp_path):
    other = execute(load("render", [*SMALL, "foam.view=flat"], output=str(tmp_path))).folder
    even, flat = (read_exr(each / "layers.exr") for each in (folder, other))
    foamy = (even["sea.Y"] == 1) & (even["coverage.Y"] > 1e-4)
    seen = flat["coverage.Y"][foamy] / even["coverage.Y"][foamy]
    np.testing.assert_allclose(flat["foam.G"][foamy] / even["foam.G"][foamy], seen, rtol=1e-3)
    # It disappears towards the horizon, and straight below it is whole.
    far = even["depth.Z"][foamy] > 200
    assert np.median(seen[far]) < 0.8 * np.median(seen[~far])
    assert seen.max() <= 1 + 1e-6


def test_a_target_takes_the_place_of_heading_and_pitch():
    aimed = _scene.camera(
        scene("camera.heading=null", "camera.pitch=null", "camera.target=[30,-20,1]").camera
    )
    expected = render.Camera.look_at((0.0, 0.0, 10.0), (30.0, -20.0, 1.0), field_of_view=1.0)
    np.testing.assert_allclose(aimed.axes(), expected.axes(), atol=1e-12)
    with pytest.raises(
        UserError, match=r"`camera\.target` .* must be null where `heading` or `pitch` is given"
    ):
        scene("camera.target=[30,-20,1]")
    with pytest.raises(UserError, match=r"`camera\.target` .* must be apart from `position`"):
        scene("camera.heading=null", "camera.pitch=null", "camera.target=[0,0,10]")


@pytest.mark.parametrize("angle", ["camera.pitch=1.5708", "camera.pitch=-1.5708", "sky.sun_elevation=1.5708"])
def test_straight_up_and_down_may_be_rounded(angle):
    config = scene(angle)
    camera, sky = _scene.camera(config.camera), _scene.sky(config.sky)
    assert isinstance(sky, optics.sky.HosekWilkie)
    angles = {"camera.pitch": camera.pitch, "sky.sun_elevation": sky.sun_elevation}
    assert abs(float(angles[angle.partition("=")[0]])) == np.pi / 2
    assert np.all(np.isfinite(sky.irradiance()))
    with pytest.raises(UserError, match=r"at (most|least) -?1\.571 rad, but is -?1\.578"):
        scene(angle[:-2] + "8")


OWN = ["spectrum.family=elfouhaily"]


def test_the_waves_that_no_pattern_holds_have_a_factor_of_their_own():
    own, scaled, unscaled = (
        np.asarray(_scene.ocean(scene(*changes)).unresolved_slopes())
        for changes in (
            [],
            [*OWN, "spectrum.scale=4.0"],
            [*OWN, "spectrum.scale=4.0", "unresolved_scale=1.0"],
        )
    )
    np.testing.assert_allclose(scaled, 4 * own, rtol=1e-5)
    np.testing.assert_allclose(unscaled, own, rtol=1e-5)
    assert np.trace(own) > 0


@pytest.mark.parametrize("number", [1, 2, 4, 6])
def test_the_papers_amplitude_leaves_the_shortest_waves_as_they_are(number):
    """Cox & Munk: all slopes together have 0.003 + 0.00512 U10; the paper's amplitude of 4 would exceed it alone."""
    config = scene(name=f"dupuy_scene{number}")
    short = float(np.trace(_scene.ocean(config).unresolved_slopes()))
    assert 0 < short < 0.003 + 0.00512 * config.wind.speed


def test_a_white_plate_is_neutral_in_the_light_of_sun_and_sky():
    def light(config, plate):
        sky = _scene.sky(config.sky)
        beam, dome = np.asarray(sky.sun_irradiance), np.asarray(sky.irradiance())
        shone = beam * max(float(sky.sun_direction[2]), 0.0) + dome if plate else beam
        return np.asarray(imagery.white_balance(jnp.asarray(shone), jnp.asarray(_scene.white(config))))

    for elevation in (0.05, 0.9):
        usual = scene(f"sky.sun_elevation={elevation}")
        np.testing.assert_allclose(light(usual, plate=True) / light(usual, plate=True)[1], 1.0, atol=1e-5)
        raw = light(scene(f"sky.sun_elevation={elevation}", "image.white_balance=none"), plate=True)
        assert raw[0] > 1.02 * raw[1] > 1.05 * raw[2]
    # The low sun itself stays red.
    red, green, blue = light(scene("sky.sun_elevation=0.05"), plate=False)
    assert red > 2 * green > 10 * blue


def test_colours_that_are_given_stay_as_they_are_unless_it_is_wanted():
    even = ["sky.kind=even", "sky.radiance=[0.1,0.2,0.4]"]
    assert _scene.white(scene(*even)) == (1.0, 1.0, 1.0)
    np.testing.assert_allclose(
        _scene.white(scene(*even, "image.white_balance=sun_and_sky")), np.pi * np.array([0.1, 0.2, 0.4])
    )


def test_a_panorama_that_does_not_exist_is_named(tmp_path):
    config = tmp_path / "mine.yaml"
    config.write_text("experiment: render\nsky: {kind: panorama, file: nowhere.exr}\n")
    with pytest.raises(UserError, match=r"nowhere\.exr"):
        execute(load(str(config), SMALL, output=str(tmp_path)))


def test_a_camera_under_water_is_refused(tmp_path):
    with pytest.raises((UserError, ValueError), match="height"):
        execute(load("render", [*SMALL, "camera.position=[0,0,-1]"], output=str(tmp_path)))


def test_a_camera_inside_a_crest_is_refused_in_one_sentence(tmp_path):
    config = load("render", SMALL).config
    assert isinstance(config, schema.RenderConfig)
    fields = _scene.ocean(config).fields(config.time)
    row, column = np.unravel_index(np.argmax(fields.height[0]), (32, 32))
    x, y = np.array([column, row]) * 200 / 32 + np.asarray(fields.displacement[0, row, column])
    height = 0.4 * float(np.max(fields.height[0]))
    with pytest.raises((UserError, ValueError), match="must be above the water, but is at a height of"):
        execute(load("render", [*SMALL, f"camera.position=[{x},{y},{height}]"], output=str(tmp_path)))
