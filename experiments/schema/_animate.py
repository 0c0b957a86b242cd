"""The config of `animate`."""

import itertools
from typing import Literal, Self

from pydantic import model_validator

from ._base import HALF_TURN, Section, key, wrong
from ._camera import Point, check_aim, heading_key, pitch_key, position_key, target_key
from ._render import RayImageConfig, SceneConfig

MOST = 100_000
"""Frames of a sequence."""


class KeyFrameConfig(Section):
    """One of `path`: where the camera is at one time, and where it looks."""

    time: float = key(unit="s", meaning="of the sea", ge=0, le=1e9)
    position: Point = position_key()
    heading: float | None = heading_key("given by target")
    pitch: float | None = pitch_key("given by target")
    target: Point | None = target_key()
    roll: float | None = key(
        None,
        unit="rad",
        meaning="turn around the direction of view; null: that of `camera`",
        within="-π to π",
        ge=-HALF_TURN,
        le=HALF_TURN,
    )
    field_of_view: float | None = key(
        None, unit="rad", meaning="from the lower to the upper edge; null: that of `camera`", gt=0, le=3
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_aim(self.position, self.heading, self.pitch, self.target)
        if self.target is None:
            for name, value in (("heading", self.heading), ("pitch", self.pitch)):
                if value is None:
                    raise wrong(name, "be given where there is no `target`")
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
        within="each {time, position, heading and pitch, or target; roll, field_of_view}, times increase",
        max_length=1000,
    )
    image: RayImageConfig = key(RayImageConfig(), meaning="the image")
    exr: bool = key(False, meaning="whether to keep each frame's light and layers too, as OpenEXR")
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
        if self.compare and self.image.method == "rays":
            raise wrong("compare", "be empty with the method rays: it compares ways to look up a mesh")
        if len(set(self.compare)) < len(self.compare):
            raise wrong("compare", "hold each name once")
        if self.compare and self.frames < 3:
            raise wrong("compare", f"be empty for fewer than 3 frames, but there are {self.frames}")
        return self
