"""GIF and MP4: as many pictures as were given, near to what they were, and bad ones are refused in words."""

import subprocess
import sys

import imageio.v3 as imageio
import numpy as np
import pytest

from jaxocean.io import write_gif, write_mp4

Y, X = np.mgrid[:21, :33]


@pytest.fixture
def pictures(tmp_path):
    """A bright spot that moves to the right over a blue slope, 33 by 21 pixels."""
    files = []
    for i in range(5):
        spot = 200 * np.exp(-((X - 4 - 6 * i) ** 2 + (Y - 10) ** 2) / 18)
        picture = np.stack([spot, spot + 2 * Y, 40 + spot / 2 + 3 * Y], axis=-1)
        files.append(tmp_path / f"frame_{i}.png")
        imageio.imwrite(files[-1], picture.astype(np.uint8))
    return files


def test_a_gif_holds_every_picture_at_its_rate_near_its_colours(tmp_path, pictures):
    path = write_gif(tmp_path / "spot.gif", pictures, 8.0)
    back = imageio.imread(path, index=None)
    assert back.shape == (5, 21, 33, 3)
    for i, file in enumerate(pictures):
        assert np.abs(back[i].astype(float) - imageio.imread(file)).mean() < 6
    assert imageio.immeta(path)["duration"] == 120
    assert not [file for file in tmp_path.iterdir() if "partial" in file.name]


def test_an_mp4_holds_every_picture_and_odd_sides_become_even(tmp_path, pictures):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    path = write_mp4(tmp_path / "spot.mp4", pictures, 8.0)
    raw = [ffmpeg.get_ffmpeg_exe(), "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    read = subprocess.run(raw, capture_output=True, check=True)
    assert "34x22" in read.stderr.decode()
    assert " 8 fps" in read.stderr.decode()
    back = np.frombuffer(read.stdout, np.uint8).reshape(5, 22, 34, 3)
    for i, file in enumerate(pictures):
        assert np.abs(back[i, :21, :33].astype(float) - imageio.imread(file)).mean() < 12


def test_sequences_without_pictures_of_two_sizes_or_without_rate_are_refused(tmp_path, pictures):
    with pytest.raises(ValueError, match="at least one file"):
        write_gif(tmp_path / "no.gif", [], 8)
    with pytest.raises(ValueError, match="must be greater than 0 and finite, but is 0"):
        write_gif(tmp_path / "no.gif", pictures, 0)
    with pytest.raises(FileNotFoundError, match="nowhere"):
        write_gif(tmp_path / "no.gif", [*pictures, tmp_path / "nowhere.png"], 8)
    imageio.imwrite(tmp_path / "small.png", np.zeros((4, 4, 3), np.uint8))
    with pytest.raises(ValueError, match=r"must be of one size, but .*small"):
        write_gif(tmp_path / "no.gif", [*pictures, tmp_path / "small.png"], 8)
    assert not list(tmp_path.glob("*.gif"))


def test_without_its_package_an_mp4_says_what_to_install(tmp_path, pictures, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ImportError, match=r"pip install jaxocean\[video\]"):
        write_mp4(tmp_path / "no.mp4", pictures, 8)
