"""Pictures, OpenEXR files and panoramas: they come back as they were written, and bad files are refused in words."""

import sys

import imageio.v3 as imageio
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean.imagery import decode_srgb, encode_srgb
from jaxocean.io import layer, read_exr, read_image, read_panorama, write_exr, write_png

RANDOM = np.random.default_rng(0)


def test_a_picture_comes_back_to_within_its_steps(tmp_path):
    light = jnp.asarray(RANDOM.uniform(size=(8, 16, 3)))
    path = write_png(tmp_path / "picture.png", encode_srgb(light))
    assert [file.name for file in tmp_path.iterdir()] == ["picture.png"]
    back = read_image(path)
    assert back.dtype == np.float32
    np.testing.assert_allclose(encode_srgb(jnp.asarray(back)), encode_srgb(light), atol=0.502 / 255)


def test_code_values_beyond_black_and_white_are_clipped(tmp_path):
    path = write_png(tmp_path / "wild.png", np.array([[[-1.0, 2.0, np.nan]]]))
    np.testing.assert_array_equal(imageio.imread(path), [[[0, 255, 0]]])


def test_grey_and_transparent_pictures_become_three_channels(tmp_path):
    grey = np.arange(32, dtype=np.uint8).reshape(4, 8) * 8
    imageio.imwrite(tmp_path / "grey.png", grey)
    imageio.imwrite(tmp_path / "clear.png", np.stack([grey, grey, grey, 255 - grey], axis=-1))
    expected = np.repeat(np.asarray(decode_srgb(jnp.asarray(grey / 255.0)))[..., None], 3, axis=-1)
    np.testing.assert_allclose(read_image(tmp_path / "grey.png"), expected, atol=1e-6)
    np.testing.assert_allclose(read_image(tmp_path / "clear.png"), expected, atol=1e-6)


def test_named_channels_come_back_from_openexr_bit_by_bit(tmp_path):
    pytest.importorskip("OpenEXR")
    picture = RANDOM.normal(size=(6, 10, 3)).astype(np.float32) * 1e4
    normal = RANDOM.normal(size=(6, 10, 3)).astype(np.float32)
    depth = np.full((6, 10), np.inf, np.float32)
    channels = {**layer("", "RGB", picture), **layer("normal", "XYZ", normal), "depth.Z": jnp.asarray(depth)}
    path = write_exr(tmp_path / "frame.exr", channels)
    assert [file.name for file in tmp_path.iterdir()] == ["frame.exr"]
    back = read_exr(path)
    assert set(back) == {"R", "G", "B", "normal.X", "normal.Y", "normal.Z", "depth.Z"}
    np.testing.assert_array_equal(np.stack([back[f"normal.{part}"] for part in "XYZ"], axis=-1), normal)
    np.testing.assert_array_equal(back["depth.Z"], depth)
    np.testing.assert_array_equal(read_image(path), picture)


def test_a_panorama_becomes_a_sky(tmp_path):
    pytest.importorskip("OpenEXR")
    image = RANDOM.uniform(size=(8, 16, 3)).astype(np.float32)
    sky = read_panorama(write_exr(tmp_path / "sky.exr", layer("", "RGB", image)), scale=2.0)
    np.testing.assert_array_equal(sky.image, image)
    north = jnp.array([[0.0, 0.99, 0.141]])
    np.testing.assert_allclose(sky.radiance(north)[0], image[3, 7:9].sum(axis=0), rtol=0.2)


def test_images_that_are_not_there_or_damaged_are_refused_in_words(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"There is no image `.*missing\.png`"):
        read_panorama(tmp_path / "missing.png")
    (tmp_path / "text.png").write_text("hello")
    with pytest.raises(ValueError, match=r"text\.png` cannot be read"):
        read_image(tmp_path / "text.png")
    whole = write_png(tmp_path / "whole.png", RANDOM.uniform(size=(40, 40, 3))).read_bytes()
    (tmp_path / "half.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=r"half\.png` cannot be read"):
        read_image(tmp_path / "half.png")
    square = write_png(tmp_path / "square.png", np.zeros((8, 8, 3)))
    with pytest.raises(ValueError, match="must be twice as wide as it is high, but is 8 by 8"):
        read_panorama(square)
    with pytest.raises(ValueError, match="`code` must have pixels"):
        write_png(tmp_path / "none.png", np.zeros((0, 8, 3)))
    with pytest.raises(OSError):
        write_png(tmp_path / "no folder" / "picture.png", np.zeros((2, 2, 3)))


def test_damaged_openexr_files_and_channels_that_do_not_fit_are_refused_in_words(tmp_path):
    pytest.importorskip("OpenEXR")
    with pytest.raises(FileNotFoundError, match="There is no image"):
        read_exr(tmp_path / "missing.exr")
    (tmp_path / "text.exr").write_text("hello")
    with pytest.raises(ValueError, match="is damaged or no OpenEXR file"):
        read_exr(tmp_path / "text.exr")
    whole = write_exr(tmp_path / "whole.exr", layer("", "RGB", RANDOM.uniform(size=(8, 16, 3)))).read_bytes()
    (tmp_path / "half.exr").write_bytes(whole[:-100])
    with pytest.raises(ValueError, match="is damaged or no OpenEXR file"):
        read_exr(tmp_path / "half.exr")
    only = write_exr(tmp_path / "depth.exr", {"depth.Z": np.ones((4, 8))})
    with pytest.raises(ValueError, match=r"must have channels R, G and B, but has \['depth\.Z'\]"):
        read_image(only)
    with pytest.raises(ValueError, match="`channels` must hold planes of one size"):
        write_exr(tmp_path / "two.exr", {"a": np.ones((4, 8)), "b": np.ones((8, 4))})
    with pytest.raises(ValueError, match="`channels` must hold planes of one size"):
        write_exr(tmp_path / "none.exr", {})
    with pytest.raises(ValueError, match="`parts` must name 3 channels"):
        layer("normal", "XY", np.ones((4, 8, 3)))
    with pytest.raises(OSError, match="cannot be written"):
        write_exr(tmp_path / "no folder" / "depth.exr", {"depth.Z": np.ones((4, 8))})


def test_without_openexr_one_is_told_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    with pytest.raises(ImportError, match="pip install OpenEXR"):
        write_exr(tmp_path / "depth.exr", {"depth.Z": np.ones((4, 8))})


def test_pictures_of_phones_printers_and_masks_are_read_as_they_look(tmp_path):
    from PIL import Image

    colours = np.zeros((4, 6, 3), np.uint8)
    colours[:2] = (200, 40, 90)
    upright = read_image(_saved(tmp_path / "a.png", Image.fromarray(colours)))
    # Held on its side: the file says how to turn it.
    lying = Image.fromarray(np.rot90(colours).copy())
    exif = lying.getexif()
    exif[0x0112] = 6
    path = tmp_path / "b.png"
    lying.save(path, exif=exif)
    np.testing.assert_allclose(read_image(path), upright, atol=1e-6)
    inks = Image.fromarray(colours).convert("CMYK")
    path = tmp_path / "c.jpg"
    inks.save(path, quality=100, subsampling=0)
    np.testing.assert_allclose(read_image(path), upright, atol=0.05)
    bits = Image.fromarray((colours[..., 0] > 0).astype(np.uint8) * 255).convert("1")
    np.testing.assert_array_equal(read_image(_saved(tmp_path / "d.png", bits))[..., 0], colours[..., 0] > 0)


def _saved(path, image):
    image.save(path)
    return path
