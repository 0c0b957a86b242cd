"""The config of `joint_targets`."""

from typing import Literal

from ._base import ExperimentConfig, key
from ._calibration import WindsConfig
from ._camera import CameraConfig
from ._sea import CascadeConfig, WindConfig, breaking_wavenumber_key, threshold_key


class JointTargetsConfig(ExperimentConfig):
    """`joint_targets`: what a coverage law, slopes and a picture say of ε and λ, each with those before it."""

    experiment: Literal["joint_targets"] = key("joint_targets", meaning="which experiment this config runs")
    wind: WindConfig = key(WindConfig(speed=12.0), meaning="the wind of the picture")
    threshold: float = threshold_key(0.65)
    choppiness: float = key(1.0, unit="-", meaning="λ of the truth", gt=0, le=3)
    inverse_wave_age: float = key(0.84, unit="-", meaning="Ω of the truth, free in every fit", ge=0.3, le=5)
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns")
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    winds: WindsConfig = key(WindsConfig(), meaning="where the law and the slopes are known")
    law_scatter: float = key(0.1, unit="-", meaning="of the coverage law, in log10 W", gt=0)
    slope_scatter: float = key(0.1, unit="-", meaning="of the slope variance, relative", gt=0)
    prior_deviation: float = key(0.5, unit="-", meaning="of a wide prior on λ around its truth", gt=0)
    away: float = key(
        0.1,
        unit="-",
        meaning="how far from the truth fits begin: ε times one less, λ and Ω times one more than this",
        ge=0,
        lt=0.5,
    )
    camera: CameraConfig = key(
        CameraConfig(position=(0.0, 0.0, 12.0), heading=0.6, pitch=0.35), meaning="the camera"
    )
    detail: int = key(4, meaning="times as many rows and columns in the target, averaged", ge=1, le=8)
    points: int = key(7, meaning="of the profile with the picture", ge=5, le=99)
    height: int = key(180, unit="px", meaning="rows", ge=16, le=2048)
    width: int = key(320, unit="px", meaning="columns", ge=16, le=2048)
