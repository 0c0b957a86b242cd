"""The experiment `render` on a small picture."""

import imageio.v3 as imageio
import numpy as np
import pytest

from experiments import schema
from experiments.harness._errors import UserError
from experiments.harness._execute import execute
from experiments.harness._loading import load
from experiments.pictures import _scene
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
