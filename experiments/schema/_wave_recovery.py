"""The config of `wave_recovery`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, key, wrong
from ._sea import WindConfig


class WaveRecoveryConfig(ExperimentConfig):
    """`wave_recovery`: the waves of a small patch from pictures of it, every random number free."""

    experiment: Literal["wave_recovery"] = key("wave_recovery", meaning="which experiment this config runs")
    wind: WindConfig = key(WindConfig(speed=8.0), meaning="the wind")
    side: float = key(24.0, unit="m", meaning="of the periodic patch", gt=0, le=1e4)
    resolution: int = key(64, meaning="waves along each side of it", ge=8, le=512)
    threshold: float = key(0.4, unit="-", meaning="ε: breaking where j < ε", ge=-10, le=2)
    views: tuple[int, ...] = key(
        (1, 3),
        meaning="from how many sides it is seen, one fit for each",
        within="1 to 12 each",
        min_length=1,
        max_length=6,
    )
    altitude: float = key(14.0, unit="m", meaning="of the camera, which looks at the middle", gt=0, le=1e4)
    pitch: float = key(1.05, unit="rad", meaning="of the camera, below the horizontal", gt=0.1, lt=1.5)
    field_of_view: float = key(0.95, unit="rad", meaning="vertical", gt=0.01, lt=3)
    sun_elevation: float = key(0.7, unit="rad", meaning="of the sun", gt=0, lt=1.571)
    scatter: float = key(
        0.05, unit="-", meaning="how far pictures are off from what the right waves give, in log light", gt=0
    )
    steps: int = key(200, meaning="of L-BFGS, at most", ge=1, le=100_000)
    detail: int = key(2, meaning="times as many rows and columns in the targets, averaged", ge=1, le=8)
    height: int = key(96, unit="px", meaning="rows", ge=16, le=2048)
    width: int = key(128, unit="px", meaning="columns", ge=16, le=2048)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for views in self.views:
            if not 1 <= views <= 12:
                raise wrong("views", f"be 1 to 12 each, but one is {views}")
        return self
