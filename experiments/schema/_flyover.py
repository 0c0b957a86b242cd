"""The config of `flyover`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import key, wrong
from ._render import SceneConfig


class FlyoverConfig(SceneConfig):
    """`flyover`: the camera climbs; the time per frame, and the whitecaps seen, at every height."""

    experiment: Literal["flyover"] = key("flyover", meaning="which experiment this config runs")
    lowest: float = key(2.0, unit="m", meaning="first height above the water below the camera", gt=0, le=1e6)
    highest: float = key(5000.0, unit="m", meaning="last height", gt=0, le=1e6)
    heights: int = key(8, meaning="how many, each the same factor above the last", ge=2, le=64)
    repeats: int = key(
        7,
        meaning="frames at every height, each of other water: for the median time and the mean",
        ge=1,
        le=1000,
    )
    apart: float = key(
        700.0, unit="m", meaning="from where one of them is taken to the next, to the left", gt=0, le=1e6
    )
    start: float = key(0.0, unit="s", meaning="time of the first frame", ge=0, le=1e9)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.camera.target is not None:
            raise wrong("camera.target", "be null: a climb keeps its heading and its pitch")
        if not self.highest > self.lowest:
            raise wrong("highest", f"be above `lowest` = {self.lowest:g} m, but is {self.highest:g} m")
        return self
