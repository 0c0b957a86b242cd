"""Where the camera is at every time."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

import jaxocean as jo
from jaxocean import render

from .. import schema
from ..harness._errors import UserError
from . import _scene


class Place(NamedTuple):
    """Where a camera is and how it looks: x, y and height [m], heading, pitch, roll and field of view [rad]."""

    x: float
    y: float
    height: float
    heading: float
    pitch: float
    roll: float
    field_of_view: float


class Path:
    """The camera of a config over time: smooth between key frames, and nowhere beyond the values of two neighbours.

    Before the first key frame and after the last it stands still; it turns the shorter way. If all key frames have a
    target, the target moves likewise and stays in the middle of the image; if only some do, they say no more than
    heading and pitch at their time.
    """

    def __init__(self, config: schema.AnimateConfig) -> None:
        cameras = [_camera(config.camera, frame) for frame in config.path] or [config.camera]
        directions = np.asarray([_scene.direction(camera) for camera in cameras])
        directions[:, 0] = np.unwrap(directions[:, 0])
        targets = [camera.target for camera in cameras if camera.target is not None]
        self._aimed = len(targets) == len(cameras)
        others = [(*camera.position, camera.roll, camera.field_of_view) for camera in cameras]
        self._values = np.concatenate([others, targets if self._aimed else directions], axis=1)
        self._times = [frame.time for frame in config.path]
        self._between = PchipInterpolator(self._times, self._values) if len(self._times) > 1 else None

    def __call__(self, time: float) -> render.Camera:
        """The camera at a time of the sea [s]."""
        x, y, height, heading, pitch, roll, field_of_view = self.place(time)
        return render.Camera(
            (x, y, height), heading=heading, pitch=pitch, field_of_view=field_of_view, roll=roll
        )

    def place(self, time: float) -> Place:
        """Where the camera is at a time of the sea [s]."""
        values = self._values[0]
        if self._between is not None:
            values = self._between(np.clip(time, self._times[0], self._times[-1]))
        x, y, height, roll, field_of_view, *aim = values.tolist()
        heading, pitch = _scene.towards((x, y, height), aim) if self._aimed else aim
        return Place(x, y, height, heading, pitch, roll, field_of_view)


def _camera(whole: schema.CameraConfig, frame: schema.KeyFrameConfig) -> schema.CameraConfig:
    """The camera of a key frame: what it does not say is as in `camera`."""
    return schema.CameraConfig(
        position=frame.position,
        heading=frame.heading,
        pitch=frame.pitch,
        target=frame.target,
        roll=whole.roll if frame.roll is None else frame.roll,
        field_of_view=whole.field_of_view if frame.field_of_view is None else frame.field_of_view,
    )


def check_above(ocean: jo.Ocean, path: Path, times: Sequence[float]) -> None:
    """Raise for the first time at which the camera is not above the water."""
    for time in times:
        try:
            render.check_above(path(time), ocean.sea, time, ocean.choppiness)
        except ValueError as problem:
            at = path.place(time)
            water = float(ocean.sea.height_at(np.asarray([at.x, at.y]), time, ocean.choppiness))
            raise UserError(
                f"At {time:g} s the camera is at a height of {at.height:g} m, but the water there at {water:.3g} m: "
                "raise `camera.position`, or the key frames of `path` around that time."
            ) from problem
