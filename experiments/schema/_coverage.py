"""The config of `coverage`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, key, wrong
from ._sea import (
    CascadeConfig,
    Choppiness,
    WindConfig,
    breaking_wavenumber_key,
    check_choppiness,
    choppiness_key,
    threshold_key,
)
from ._spectra import ElfouhailyConfig, SpectrumConfig


class CoverageConfig(ExperimentConfig):
    """`coverage`: whitecap coverage of one sea in closed form."""

    experiment: Literal["coverage"] = key("coverage", meaning="which experiment this config runs")
    wind: WindConfig = key(WindConfig(), meaning="the wind")
    spectrum: SpectrumConfig = key(ElfouhailyConfig(), meaning="the wave spectrum")
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns whose waves count")
    band: tuple[float, float] | None = key(
        None, unit="rad/m", meaning="[lower, upper] of |k| instead of the cascade's; null: the cascade"
    )
    choppiness: Choppiness = choppiness_key()
    threshold: float = threshold_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.band is not None:
            lower, upper = self.band
            if not 0 < lower < upper:
                raise wrong(
                    "band", f"be [lower, upper] with 0 < lower < upper, but is [{lower:g}, {upper:g}]"
                )
        if self.band is not None and isinstance(self.choppiness, tuple) and len(self.choppiness) != 1:
            raise wrong(
                "choppiness",
                f"be one number where `band` takes the place of the cascade, but holds {len(self.choppiness)}",
            )
        check_choppiness(self.choppiness, 1 if self.band is not None else len(self.cascade.sizes))
        return self

    @classmethod
    def varies(cls) -> frozenset[str]:
        """The numbers of the sea; the band, the cascade and names are the shape of the computation."""
        return frozenset({"choppiness", "threshold", "breaking_wavenumber"}) | {
            f"{section}.{name}" for section, names in _NUMBERS.items() for name in names
        }


_SPREADING = ("inverse_wave_age", "s", "s_max")
_NUMBERS = {
    "wind": ("speed", "direction", "fetch", "sea_air_temperature_difference"),
    "spectrum": (
        "amplitude",
        "depth",
        "exponent",
        "inverse_wave_age",
        "opposing",
        "peak_enhancement",
        "peak_period",
        "scale",
        "significant_wave_height",
        "smallest_wave",
    ),
    "spectrum.spreading": _SPREADING,
    "spectrum.swell": ("significant_wave_height", "peak_period", "direction", "width"),
    "spectrum.swell.spreading": _SPREADING,
}
