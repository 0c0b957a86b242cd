"""The horizon of pictures whose camera is known, and of photographs."""

import os
from pathlib import Path

import imageio.v3 as imageio
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from fitting import FitError
from fitting.pictures import find_horizon

SIZE = (90, 160)
CASCADE = jo.surface.Cascade((120.0, 17.0), 32)
PHOTOS = Path(os.environ.get("JAXOCEAN_DATA", Path(__file__).parents[3] / "shared" / "data")) / "photos"


@pytest.fixture(scope="module")
def draw():
    sea = jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(9.0)), CASCADE, key=jax.random.key(1))
    ocean = jo.Ocean(sea, breaking_wavenumber=4.0, sky=jo.optics.sky.HosekWilkie(2.5, sun_elevation=0.7))

    def picture(pitch, roll):
        camera = jo.render.Camera((0.0, 0.0, 12.0), heading=0.4, pitch=pitch, roll=roll, field_of_view=0.8)
        return jo.render.render(ocean, camera, 0.0, SIZE)

    program = jax.jit(picture)
    return lambda pitch, roll: np.array(program(pitch, roll))


@pytest.mark.parametrize(("pitch", "roll"), [(0.1, 0.0), (0.2, 0.3), (-0.1, -0.2), (0.25, -0.05)])
def test_pitch_and_roll_are_those_of_the_camera(draw, pitch, roll):
    found = find_horizon(draw(pitch, roll)).angles(0.8)
    # A pixel is 9 mrad.
    np.testing.assert_allclose(found, (pitch, roll), atol=0.015)


def test_what_is_masked_is_not_looked_at(draw):
    image = draw(0.1, 0.1)
    # A wall with a level top edge, and a mast.
    image[40:, :40] = 3.0
    image[:, 100:104] = 0.01
    mask = np.ones(SIZE)
    mask[:, :40] = mask[:, 100:104] = 0.0
    np.testing.assert_allclose(find_horizon(image, mask).angles(0.8), (0.1, 0.1), atol=0.015)


def test_where_there_is_no_horizon_none_is_found(draw):
    noise = np.random.default_rng(0).uniform(0.1, 1.0, (*SIZE, 3))
    for image in (draw(1.2, 0.0), noise, np.full((*SIZE, 3), 0.3)):
        with pytest.raises(FitError, match="shows no horizon"):
            find_horizon(image)
    with pytest.raises(FitError, match="shows no horizon"):
        find_horizon(draw(0.1, 0.0), np.zeros(SIZE))


def test_images_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="at least 16 pixels"):
        find_horizon(np.ones((8, 30, 3)))
    with pytest.raises(ValueError, match="90×160 pixels of the image"):
        find_horizon(np.ones((*SIZE, 3)), np.ones((3, 3)))


@pytest.mark.skipif(not PHOTOS.is_dir(), reason="the photographs are not there: see JAXOCEAN_DATA")
@pytest.mark.parametrize(
    ("name", "left", "right"),
    # Read off by eye at the left and right edges, as shares of the height.
    [
        ("W17A_2024_10_11_1810_2", 0.655, 0.385),
        ("W38A_2024_09_26_1810_1", 0.405, 0.50),
        ("W63A_2024_09_29_0910_5", 0.59, 0.56),
        ("W64A_2024_09_19_1710_0", 0.42, 0.495),
        ("W81A_2024_09_21_1910_3", 0.55, 0.515),
        ("W92A_2024_10_11_1410_0", 0.565, 0.575),
        ("Z10A_2024_09_28_1810_0", 0.355, 0.465),
        ("Z76A_2024_10_10_1510_4", 0.58, 0.615),
    ],
)
def test_horizons_of_photographs_are_where_the_eye_sees_them(name, left, right):
    code = imageio.imread(PHOTOS / f"{name}.png")[..., :3]
    found = find_horizon(np.asarray(jo.imagery.decode_srgb(jnp.asarray(code / 255.0))))
    rows, columns = found.size
    half = 0.5 * (columns - 1) * found.slope
    np.testing.assert_allclose(
        [(found.row - half) / rows, (found.row + half) / rows], [left, right], atol=0.03
    )
