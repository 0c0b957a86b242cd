"""Where a camera stands and where it looks, in the section `camera` and in key frames."""

from typing import Self

from pydantic import model_validator

from ._base import HALF_TURN, QUARTER_TURN, TURN, Section, key, wrong

Point = tuple[float, float, float]

HEADING, PITCH = 0.0, 0.2
"""Where a camera looks to [rad] of which nothing is said."""


def position_key(default: Point | None = None):
    """The key `position`."""
    return key(
        *(() if default is None else (default,)),
        unit="m",
        meaning="x, y and height above the resting water",
        within="height > 0",
    )


def heading_key(default: str):
    """The key `heading`; `default`: what null is, in words."""
    meaning = f"looks to, counter-clockwise from +x (east); null: {default}"
    return key(None, unit="rad", meaning=meaning, within="-2π to 2π", ge=-TURN, le=TURN)


def pitch_key(default: str):
    """The key `pitch`; `default`: what null is, in words."""
    meaning = f"how far below the horizontal it looks; null: {default}"
    return key(None, unit="rad", meaning=meaning, within="-π/2 to π/2", ge=-QUARTER_TURN, le=QUARTER_TURN)


def target_key():
    """The key `target`."""
    return key(
        None,
        unit="m",
        meaning="x, y and height of what is in the middle of the image; null: heading and pitch say it",
        within="not with heading or pitch, apart from position",
    )


def check_aim(position: Point, heading: float | None, pitch: float | None, target: Point | None) -> None:
    """For validators: a camera above the water, whose direction is said once."""
    if not position[2] > 0:
        raise wrong("position", f"have a height greater than 0 m, but it is {position[2]:g}")
    if target is None:
        return
    if heading is not None or pitch is not None:
        raise wrong(
            "target", "be null where `heading` or `pitch` is given: set those to null, or leave `target` out"
        )
    if target == position:
        raise wrong("target", "be apart from `position`, but both are the same point")


class CameraConfig(Section):
    """`camera`: where it stands and where it looks."""

    position: Point = position_key((0.0, 0.0, 10.0))
    heading: float | None = heading_key(f"{HEADING:g}")
    pitch: float | None = pitch_key(f"{PITCH:g}")
    target: Point | None = target_key()
    field_of_view: float = key(1.0, unit="rad", meaning="from the lower to the upper edge", gt=0, le=3)
    roll: float = key(
        0.0,
        unit="rad",
        meaning="turn around the direction of view",
        within="-π to π",
        ge=-HALF_TURN,
        le=HALF_TURN,
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_aim(self.position, self.heading, self.pitch, self.target)
        return self
