"""Sequences of pictures as GIF and MP4."""

import contextlib
import os
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from ._files import existing, written_whole

COLOURS = 256
"""Most colours of a GIF."""

LOOKED_AT = 8
"""So many pictures, evenly spread over a sequence, decide on its colours."""

QUALITY = "18"
"""Constant rate factor of an MP4: nothing is seen to be lost."""

Pictures = Sequence[str | os.PathLike]
"""Files of pictures, in order."""


def write_gif(path: str | os.PathLike, pictures: Pictures, frames_per_second: float | int) -> Path:
    """Write a GIF that repeats forever. The file appears whole or not at all.

    All pictures share 256 colours, chosen over the sequence, so that nothing flickers that did not before. GIF counts
    time in hundredths of a second: each picture is shown for the nearest number of them, at least two.

    **Arguments:** `path`: of the GIF; `pictures`: files such as PNG, of one size, read one at a time;
    `frames_per_second` [1/s].

    **Returns:** the path.

    **Raises:** `ValueError` for no pictures, several sizes or a rate that is not positive; `FileNotFoundError` for a
    picture that is not there; `OSError` if the GIF cannot be written.
    """
    from PIL import Image

    _check(pictures, frames_per_second)
    colours = _shared_colours(pictures)
    frames = (Image.fromarray(pixels).quantize(palette=colours) for pixels in _pixels(pictures))
    first = next(frames)
    hundredths = max(2, round(100 / frames_per_second))

    def write(target: Path) -> None:
        first.save(
            target, format="GIF", save_all=True, append_images=frames, duration=10 * hundredths, loop=0
        )

    return written_whole(Path(path), write)


def write_mp4(path: str | os.PathLike, pictures: Pictures, frames_per_second: float | int) -> Path:
    """Write an MP4 (H.264) that every browser plays. The file appears whole or not at all.

    The format wants even sides: an odd one is made even by repeating the last row or column.

    **Arguments:** `path`: of the MP4; `pictures`: files such as PNG, of one size, read one at a time;
    `frames_per_second` [1/s].

    **Returns:** the path.

    **Raises:** `ImportError` without the package imageio-ffmpeg; `ValueError` for no pictures, several sizes or a rate
    that is not positive; `FileNotFoundError` for a picture that is not there; `OSError` if the MP4 cannot be written.
    """
    _check(pictures, frames_per_second)
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as problem:
        raise ImportError(
            "MP4 files need the package imageio-ffmpeg: `pip install jaxocean[video]`."
        ) from problem
    ffmpeg = get_ffmpeg_exe()

    def write(target: Path) -> None:
        frames = (
            np.pad(p, [(0, side % 2) for side in p.shape[:2]] + [(0, 0)], "edge") for p in _pixels(pictures)
        )
        first = next(frames)
        size = f"{first.shape[1]}x{first.shape[0]}"
        given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", f"{frames_per_second:g}", "-i", "-"]
        # The index first, so that a browser can play what it has not read to the end.
        wanted = ["-c:v", "libx264", "-crf", QUALITY, "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
        _feed([ffmpeg, "-y", "-loglevel", "error", *given, *wanted, str(target)], chain([first], frames))

    return written_whole(Path(path), write)


def _feed(command: list[str], frames: Iterable[np.ndarray]) -> None:
    """Run a program that reads pictures from its input."""
    # Not through the package's own writer: that forks the process, with all of JAX's threads.
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as program:
        assert program.stdin is not None
        assert program.stderr is not None
        with contextlib.suppress(BrokenPipeError), program.stdin as stream:
            for frame in frames:
                stream.write(np.ascontiguousarray(frame))
        said = program.stderr.read().decode(errors="replace")
    if program.returncode != 0:
        raise OSError(f"The MP4 cannot be written: {' '.join(said.split()) or 'ffmpeg failed'}.")


def _check(pictures: Pictures, frames_per_second: float | int) -> None:
    if not pictures:
        raise ValueError("Argument `pictures` must hold at least one file, but is empty.")
    if not 0 < frames_per_second < np.inf:
        raise ValueError(
            f"Argument `frames_per_second` must be greater than 0 and finite, but is {frames_per_second:g} /s."
        )


def _pixels(pictures: Pictures) -> Iterator[np.ndarray]:
    """One picture after the other, (height, width, 3) bytes."""
    from PIL import Image

    shape = None
    for picture in pictures:
        with Image.open(existing(picture)) as image:
            pixels = np.asarray(image.convert("RGB"))
        if shape is not None and pixels.shape != shape:
            raise ValueError(
                f"Argument `pictures` must be of one size, but `{picture}` is {pixels.shape[1]} by {pixels.shape[0]} "
                f"pixels after {shape[1]} by {shape[0]}."
            )
        shape = pixels.shape
        yield pixels


def _shared_colours(pictures: Pictures) -> Any:
    """A picture of few pixels with the palette of the whole sequence."""
    from PIL import Image

    some = np.unique(np.linspace(0, len(pictures) - 1, LOOKED_AT).round().astype(int))
    strip = np.concatenate(list(_pixels([pictures[i] for i in some])), axis=1)
    return Image.fromarray(strip).quantize(COLOURS, method=Image.Quantize.MEDIANCUT)
