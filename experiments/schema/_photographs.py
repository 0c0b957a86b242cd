"""The configs of `fit_image`, `unknown_seas` and `buoy_photographs`: what is inferred from photographs."""

import math
from pathlib import Path
from typing import Literal, Self

from pydantic import model_validator

from ._base import HALF_TURN, QUARTER_TURN, ExperimentConfig, Section, key, wrong
from ._data import data_folder
from ._sea import CascadeConfig

PATTERNS = CascadeConfig(sizes=(893.0, 101.0, 11.0), resolution=256)
"""What pictures of some 160 by 90 pixels can show: with half as many waves winds come out wrong by a fifth."""


class PhotographCameraConfig(Section):
    """`camera`: how the photograph was taken."""

    height: float = key(4.0, unit="m", meaning="of the lens above the water below it", gt=0, le=1e4)
    height_spread: float = key(
        0.0, unit="-", meaning="standard deviation of the height's logarithm, if it is not known", ge=0, le=1
    )
    afloat: bool = key(True, meaning="whether it rides on the waves, as on a buoy")
    field_of_view: float | None = key(
        None, unit="rad", meaning="from the lower to the upper edge; null: 60° from side to side", gt=0, le=3
    )
    view_spread: float = key(
        0.0,
        unit="-",
        meaning="standard deviation of the logarithm of the tangent of half the field of view, if it is not known",
        ge=0,
        le=1,
    )
    pitch: float | None = key(
        None,
        unit="rad",
        meaning="how far below the horizontal it looks; null: from the horizon",
        within="-π/2 to π/2, with roll",
        ge=-QUARTER_TURN,
        le=QUARTER_TURN,
    )
    roll: float | None = key(
        None,
        unit="rad",
        meaning="turn around the direction of view; null: from the horizon",
        within="-π to π, with pitch",
        ge=-HALF_TURN,
        le=HALF_TURN,
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.pitch is None) != (self.roll is None):
            given, missing = ("roll", "pitch") if self.pitch is None else ("pitch", "roll")
            raise wrong(missing, f"be given where `{given}` is, or both be left to the horizon")
        return self

    def vertical(self, rows: int, columns: int) -> float:
        """The vertical field of view [rad] of an image."""
        if self.field_of_view is not None:
            return self.field_of_view
        return 2 * math.atan(math.tan(math.pi / 6) * rows / columns)


class InferenceConfig(Section):
    """`inference`: how closely it is looked at, and for how long."""

    rows: int = key(90, unit="px", meaning="to which the image is reduced", ge=48, le=512)
    scouts: int = key(640, meaning="random states whose pictures teach what statistics tell", ge=100, le=5000)
    seas: int = key(16, meaning="seas whose pictures make a derivative", ge=1, le=32)
    steps: int = key(2, meaning="of the way down, at most", ge=1, le=100)
    level: float = key(0.9, unit="-", meaning="probability of the intervals", gt=0, lt=1)
    median_wind: float = key(8.5, unit="m/s", meaning="median of the prior of U10", gt=0, le=60)
    wind_spread: float = key(0.6, unit="-", meaning="standard deviation of ln U10 in the prior", gt=0, le=3)


class FitImageConfig(ExperimentConfig):
    """`fit_image`: the wind and the light from one photograph of the sea."""

    experiment: Literal["fit_image"] = key("fit_image", meaning="which experiment this config runs")
    image: str | None = key(None, meaning="PNG, JPEG or EXR; null: a picture that is made here", min_length=1)
    mask: str | None = key(
        None, meaning="picture of the same size, black where the image shows something else", min_length=1
    )
    camera: PhotographCameraConfig = key(PhotographCameraConfig(), meaning="how it was taken")
    inference: InferenceConfig = key(InferenceConfig(), meaning="how closely it is looked at")
    cascade: CascadeConfig = key(PATTERNS, meaning="the periodic patterns")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.mask is not None and self.image is None:
            raise wrong("mask", "be null where `image` is: what is made here hides nothing")
        return self

    def inputs(self) -> tuple[str, ...]:
        return tuple(path for path in (self.image, self.mask) if path is not None)


class UnknownSeasConfig(ExperimentConfig):
    """`unknown_seas`: winds from pictures of seas whose waves are not known, and whether intervals hold them."""

    experiment: Literal["unknown_seas"] = key("unknown_seas", meaning="which experiment this config runs")
    count: int = key(40, meaning="how many seas", ge=1, le=1000)
    lowest_wind: float = key(4.0, unit="m/s", meaning="least U10", gt=0, le=60)
    highest_wind: float = key(20.0, unit="m/s", meaning="greatest U10", gt=0, le=60)
    targets: Literal["raster", "rays"] = key(
        "raster", meaning="what draws the pictures: a fine mesh, or rays as the fit does"
    )
    detail: int = key(
        8,
        meaning="times as many rows and columns in the pictures, averaged",
        ge=1,
        le=8,
    )
    camera: PhotographCameraConfig = key(
        PhotographCameraConfig(pitch=0.08, roll=0.03), meaning="how they are taken"
    )
    inference: InferenceConfig = key(InferenceConfig(), meaning="how closely they are looked at")
    cascade: CascadeConfig = key(PATTERNS, meaning="the periodic patterns of the fit")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.highest_wind > self.lowest_wind:
            raise wrong(
                "highest_wind",
                f"be above `lowest_wind` = {self.lowest_wind:g}, but is {self.highest_wind:g}",
            )
        if self.camera.pitch is None:
            raise wrong("camera.pitch", "be given: these pictures are drawn with it")
        return self


class BuoyPhotographsConfig(ExperimentConfig):
    """`buoy_photographs`: winds from photographs of buoys, beside what the buoys measured."""

    experiment: Literal["buoy_photographs"] = key(
        "buoy_photographs", meaning="which experiment this config runs"
    )
    folder: str | None = key(
        None,
        meaning="holds images and labels.csv (file, wind_speed_m_s); null: `photos` in the data folder",
        min_length=1,
    )
    anemometer: float = key(4.0, unit="m", meaning="height of the measured wind", gt=0.01, le=100)
    camera: PhotographCameraConfig = key(PhotographCameraConfig(), meaning="how they were taken")
    inference: InferenceConfig = key(InferenceConfig(), meaning="how closely they are looked at")
    cascade: CascadeConfig = key(PATTERNS, meaning="the periodic patterns")

    def photographs(self) -> Path:
        """The folder."""
        return data_folder() / "photos" if self.folder is None else Path(self.folder).expanduser()

    def inputs(self) -> tuple[str, ...]:
        folder = self.photographs()
        return tuple(str(path) for path in sorted(folder.iterdir())) if folder.is_dir() else ()
