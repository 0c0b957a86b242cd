"""The config of `picture_recovery`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._sea import CascadeConfig, breaking_wavenumber_key


class TruthConfig(Section):
    """`truths`: what is drawn at random, and how far from it fits begin."""

    count: int = key(20, meaning="how many", ge=1, le=1000)
    lowest_wind: float = key(8.0, unit="m/s", meaning="least U10", gt=0, le=60)
    highest_wind: float = key(18.0, unit="m/s", meaning="greatest U10", gt=0, le=60)
    least_coverage: float = key(
        0.004, unit="-", meaning="a sea with fewer whitecaps is drawn anew", ge=0, lt=1
    )
    most_coverage: float = key(0.06, unit="-", meaning="a sea with more of them is drawn anew", gt=0, le=1)
    own_choppiness: bool = key(False, meaning="each pattern has a λ of its own, and each is to be found")
    nearest_start: float = key(
        0.3, unit="-", meaning="share by which each number is wrong at the start, at least", ge=0, lt=1
    )
    furthest_start: float = key(0.4, unit="-", meaning="the same at most", gt=0, lt=1)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for low, high in (
            ("lowest_wind", "highest_wind"),
            ("least_coverage", "most_coverage"),
            ("nearest_start", "furthest_start"),
        ):
            if not getattr(self, high) > getattr(self, low):
                raise wrong(
                    high, f"be above `{low}` = {getattr(self, low):g}, but is {getattr(self, high):g}"
                )
        return self


class PictureRecoveryConfig(ExperimentConfig):
    """`picture_recovery`: seas found again in pictures of them, when the random numbers of the waves are known."""

    experiment: Literal["picture_recovery"] = key(
        "picture_recovery", meaning="which experiment this config runs"
    )
    truths: TruthConfig = key(TruthConfig(), meaning="the seas that are to be found")
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns")
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    targets: Literal["alternate", "rays", "raster"] = key(
        "alternate", meaning="what draws the pictures: rays, a fine mesh, or these by turns"
    )
    finish: Literal["better", "raster"] = key(
        "better",
        meaning="what draws the last pictures of a fit: mesh or rays, whichever explains the picture better, or the "
        "mesh alone, so that no fit knows what draws pictures by rays",
    )
    detail: int = key(4, meaning="times as many rows and columns in them, averaged", ge=1, le=8)
    height: int = key(180, unit="px", meaning="rows", ge=16, le=2048)
    width: int = key(320, unit="px", meaning="columns", ge=16, le=2048)
    level: float = key(0.9, unit="-", meaning="probability of the intervals", gt=0, lt=1)
