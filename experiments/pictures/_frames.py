"""Frames of a sequence on disk: each appears whole, and what is there is not rendered again."""

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jaxocean.io import write_png

from ..harness import _records

NUMBERS = "numbers.jsonl"


class Frames:
    """Pictures of one sequence in a folder, and a line of numbers for each.

    **Arguments:** `folder`: made if it is not there; `count`: how many frames there will be; `layered`: whether each
    has a file of its layers beside it.
    """

    def __init__(self, folder: Path, count: int, *, layered: bool = False) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.count, self.layered = folder, count, layered

    def file(self, frame: int) -> Path:
        """The picture of a frame."""
        return self.folder / f"frame_{frame:05d}.png"

    def layers_file(self, frame: int) -> Path:
        """The layers of a frame."""
        return self.file(frame).with_suffix(".exr")

    def files(self) -> list[Path]:
        """All pictures, in order."""
        return [self.file(frame) for frame in range(self.count)]

    def numbers(self) -> dict[int, dict[str, float]]:
        """The numbers of the frames that are there with their pictures."""
        found = {int(record["frame"]): record for record in _records.read(self.folder / NUMBERS)}
        return {frame: found[frame] for frame in sorted(found) if self._whole(frame)}

    def _whole(self, frame: int) -> bool:
        return self.file(frame).is_file() and (not self.layered or self.layers_file(frame).is_file())

    def keep(self, frame: int, code: np.ndarray, numbers: Mapping[str, float]) -> None:
        """Store a frame, after its layers if it has some: the numbers come last, so that they stand for a whole one."""
        write_png(self.file(frame), code)
        _records.append(self.folder / NUMBERS, {"frame": frame, **numbers})

    def copy_to(self, folder: Path) -> list[Path]:
        """Put the pictures, and their layers, into another folder too, as the same files where the disk can."""
        folder.mkdir(parents=True, exist_ok=True)
        layers = [self.layers_file(frame) for frame in range(self.count)] if self.layered else []
        for file in (*self.files(), *layers):
            try:
                os.link(file, folder / file.name)
            except OSError:
                shutil.copy2(file, folder / file.name)
        return [folder / file.name for file in self.files()]
