"""The config of `calibrate_monahan`."""

import itertools
from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, Section, key, wrong
from ._sea import CascadeConfig, WindConfig, breaking_wavenumber_key, threshold_key
from ._spectra import ElfouhailyConfig, JonswapConfig, PiersonMoskowitzConfig, SpectrumConfig

LawName = Literal[
    "monahan_1980",
    "monahan_1980_least_squares",
    "monahan_1986",
    "callaghan_2008",
    "stramska_petelski_2003_undeveloped",
    "stramska_petelski_2003_developed",
    "salisbury_2013",
    "goddijn_murphy_2011",
    "zhao_toba_2001",
    "monahan_lu_1990_stage_a",
    "monahan_lu_1990_stage_b",
    "coare_3_6",
]


class WindsConfig(WindConfig):
    """`wind`: the winds at 10 m over which the model shall obey the law."""

    speed: tuple[float, ...] = key(  # pyright: ignore[reportIncompatibleVariableOverride]
        (4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0),
        unit="m/s",
        meaning="U10 of each",
        within="increasing, 0.5 to 60",
        min_length=2,
        max_length=200,
    )


class ParameterPrior(Section):
    """A prior that keeps what coverage alone cannot tell."""

    mean: float = key(1.0, unit="-", meaning="its centre", gt=0, le=100)
    deviation: float = key(0.1, unit="-", meaning="its standard deviation", gt=0, le=100)


class FreeConfig(Section):
    """`free`: what is fitted besides the threshold ε."""

    choppiness: bool = key(True, meaning="fit λ, with its prior")
    breaking_wavenumber: bool = key(False, meaning="fit k_b, with a log-normal prior around its value")
    scatter: bool = key(False, meaning="fit the scatter σ of log10 W")


class PointsConfig(Section):
    """`points`: measured coverage from a CSV file, beside the laws."""

    file: str | None = key(None, meaning="CSV file with a header; null: none")
    wind: str = key("wind", meaning="column with U10 in m/s")
    coverage: str = key("coverage", meaning="column with the coverage")
    percent: bool = key(False, meaning="the coverage is in percent")


class CalibrationConfig(ExperimentConfig):
    """`calibrate_monahan`: breaking threshold ε and choppiness λ for which a sea obeys a whitecap law."""

    experiment: Literal["calibrate_monahan"] = key(
        "calibrate_monahan", meaning="which experiment this config runs"
    )
    laws: tuple[LawName, ...] = key(
        ("monahan_1980",), meaning="whitecap laws to obey, one or several at once"
    )
    points: PointsConfig = key(PointsConfig(), meaning="measured coverage to fit beside the laws")
    wind: WindsConfig = key(WindsConfig(), meaning="the winds")
    spectrum: SpectrumConfig = key(
        ElfouhailyConfig(),
        meaning="the wave spectrum of each wind",
        within="elfouhaily, pierson_moskowitz, or jonswap with wind.fetch",
    )
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns that make the sea")
    band: tuple[float, float] | None = key(
        None, unit="rad/m", meaning="[lower, upper] of |k| instead of the cascade's; null: the cascade"
    )
    measure: Literal["projected", "rest"] = key(
        "projected", meaning="area: seen from above, or on the plane at rest"
    )
    threshold: float = threshold_key()
    choppiness: float = key(
        1.0, unit="-", meaning="horizontal displacement λ where the fit starts", gt=0, lt=3
    )
    choppiness_prior: ParameterPrior = key(
        ParameterPrior(), meaning="prior on λ: ε and λ are nearly inseparable"
    )
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    free: FreeConfig = key(FreeConfig(), meaning="what is fitted besides ε")
    scatter: float = key(0.5, unit="-", meaning="σ of log10 W around a law", gt=0, le=5)
    solver: Literal["levenberg_marquardt", "gauss_newton", "dogleg", "bfgs", "lbfgs", "nelder_mead"] = key(
        "levenberg_marquardt", meaning="optimiser"
    )
    starts: int = key(1, meaning="starting points of the shared fits", ge=1, le=100)
    breaking_wavenumbers: tuple[float, ...] = key(
        (9.0, 18.0, 36.0, 73.0),
        unit="rad/m",
        meaning="k_b for which ε is tabled; [] for none",
        within="each > 0",
    )
    realisations: int = key(64, meaning="FFT seas that check the result; 0 for none", ge=0, le=100_000)
    shifts: int = key(2, meaning="arrangements of the patterns counted in each sea", ge=1, le=64)

    @model_validator(mode="after")
    def _check(self) -> Self:
        speeds = self.wind.speed
        if any(not 0.5 <= speed <= 60 for speed in speeds):
            raise wrong("wind.speed", "hold speeds from 0.5 to 60 m/s")
        if any(b <= a for a, b in itertools.pairwise(speeds)):
            raise wrong("wind.speed", "increase from one speed to the next")
        if not self.laws and self.points.file is None:
            raise wrong("laws", "name at least one law, unless `points.file` gives measured coverage")
        if len(set(self.laws)) < len(self.laws):
            raise wrong("laws", "name each law once")
        if not isinstance(self.spectrum, ElfouhailyConfig | PiersonMoskowitzConfig | JonswapConfig):
            raise wrong("spectrum.family", "follow the wind: elfouhaily, pierson_moskowitz or jonswap")
        if isinstance(self.spectrum, JonswapConfig) and self.wind.fetch is None:
            raise wrong("wind.fetch", "be given, so that the spectrum `jonswap` follows the wind")
        if self.band is not None and not 0 < self.band[0] < self.band[1]:
            raise wrong("band", "be [lower, upper] with 0 < lower < upper")
        if self.free.breaking_wavenumber and self.breaking_wavenumber is None:
            raise wrong("breaking_wavenumber", "be a number where it is fitted: the fit starts there")
        if any(not 0 < k <= 1e5 for k in self.breaking_wavenumbers):
            raise wrong("breaking_wavenumbers", "hold wavenumbers greater than 0 rad/m and at most 1e5")
        return self

    def inputs(self) -> tuple[str, ...]:
        return () if self.points.file is None else (self.points.file,)
