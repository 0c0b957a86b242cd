"""The config of `animate`."""

import itertools
import math
from typing import Literal, Self

from pydantic import model_validator

from ._base import Section, key, wrong
from ._render import SceneConfig

MOST = 100_000
"""Frames of a sequence."""


class KeyFrameConfig(Section):
    """One of `path`: where the camera is at one time."""

    time: float = key(unit="s", meaning="of the sea", ge=0, le=1e9)
    position: tuple[float, float, float] = key(
        unit="m", meaning="x, y and height above the resting water", within="height > 0"
    )
    heading: float = key(
        unit="rad", meaning="counter-clockwise from +x (east)", ge=-2 * math.pi, le=2 * math.pi
    )
    pitch: float = key(unit="rad", meaning="below the horizontal", ge=-math.pi / 2, le=math.pi / 2)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.position[2] > 0:
            raise wrong("position", f"have a height greater than 0 m, but it is {self.position[2]:g}")
        return self


class AnimateConfig(SceneConfig):
    """`animate`: a sequence of pictures, as PNG, GIF and MP4."""

    experiment: Literal["animate"] = key("animate", meaning="which experiment this config runs")
    start: float = key(0.0, unit="s", meaning="time of the first frame", ge=0, le=1e9)
    duration: float = key(2.0, unit="s", meaning="of the sequence", gt=0, le=1e5)
    frames_per_second: float = key(12.0, unit="1/s", meaning="as they are shown", gt=0, le=240)
    path: tuple[KeyFrameConfig, ...] = key(
        (),
        meaning="key frames of the camera, smoothly joined; none: it stands still",
        within="each {time, position, heading, pitch}, times increase",
        max_length=1000,
    )
    compare: tuple[Literal["unfiltered", "supersampled"], ...] = key(
        (),
        meaning="render these as well, and say how much each flickers: looked up at the pixels' centres alone, or "
        "4 by 4 times a pixel",
        within="unfiltered, supersampled",
        max_length=2,
    )

    @property
    def frames(self) -> int:
        """How many there are, at least one."""
        return max(1, round(self.duration * self.frames_per_second))

    @model_validator(mode="after")
    def _check(self) -> Self:
        for before, after in itertools.pairwise(frame.time for frame in self.path):
            if not after > before:
                raise wrong("path", f"hold times that increase, but {after:g} s follows {before:g} s")
        if self.frames > MOST:
            raise wrong(
                "duration",
                f"be such that it times `frames_per_second` is at most {MOST} frames, but that is {self.frames}",
            )
        if len(set(self.compare)) < len(self.compare):
            raise wrong("compare", "hold each name once")
        if self.compare and self.frames < 3:
            raise wrong("compare", f"be empty for fewer than 3 frames, but there are {self.frames}")
        return self
