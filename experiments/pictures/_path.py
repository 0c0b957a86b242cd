"""Where the camera is at every time."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator

import jaxocean as jo
from jaxocean import render

from .. import schema
from ..harness._errors import UserError


class Path:
    """The camera of a config over time: smooth between key frames, and nowhere beyond the values of two neighbours.

    Before the first key frame and after the last it stands still; it turns the shorter way.
    """

    def __init__(self, config: schema.AnimateConfig) -> None:
        self._camera = config.camera
        self._frames = config.path
        if len(self._frames) > 1:
            heading = np.unwrap([frame.heading for frame in self._frames])
            values = [
                (*frame.position, turned, frame.pitch)
                for frame, turned in zip(self._frames, heading, strict=True)
            ]
            self._between = PchipInterpolator([frame.time for frame in self._frames], np.asarray(values))

    def __call__(self, time: float) -> render.Camera:
        """The camera at a time of the sea [s]."""
        x, y, z, heading, pitch = self.place(time)
        return render.Camera(
            (x, y, z),
            heading=heading,
            pitch=pitch,
            field_of_view=self._camera.field_of_view,
            roll=self._camera.roll,
        )

    def place(self, time: float) -> tuple[float, ...]:
        """x, y, height [m], heading and pitch [rad]."""
        if not self._frames:
            still = self._camera
            return (*still.position, still.heading, still.pitch)
        if len(self._frames) == 1:
            return (*self._frames[0].position, self._frames[0].heading, self._frames[0].pitch)
        held = np.clip(time, self._frames[0].time, self._frames[-1].time)
        return tuple(float(value) for value in self._between(held))


def check_above(ocean: jo.Ocean, path: Path, times: Sequence[float]) -> None:
    """Raise for the first time at which the camera is not above the water."""
    for time in times:
        try:
            render.check_above(path(time), ocean.sea, time, ocean.choppiness)
        except ValueError as problem:
            x, y, height, *_ = path.place(time)
            water = float(ocean.sea.height_at(np.asarray([x, y]), time, ocean.choppiness))
            raise UserError(
                f"At {time:g} s the camera is at a height of {height:g} m, but the water there at {water:.3g} m: "
                "raise `camera.position`, or the key frames of `path` around that time."
            ) from problem
