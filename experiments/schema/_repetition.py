"""The config of `repetition`."""

from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, key, wrong
from ._sea import WindConfig, breaking_wavenumber_key, threshold_key
from ._spectra import ElfouhailyConfig


class RepetitionConfig(ExperimentConfig):
    """`repetition`: how many patterns a sea needs, lest it repeat visibly."""

    experiment: Literal["repetition"] = key("repetition", meaning="which experiment this config runs")
    wind: WindConfig = key(WindConfig(speed=12.0), meaning="the wind")
    spectrum: ElfouhailyConfig = key(ElfouhailyConfig(inverse_wave_age=2.0), meaning="the wave spectrum")
    patterns: tuple[int, ...] = key(
        (1, 2, 3, 4, 5, 6),
        meaning="numbers of patterns that are compared",
        within="increasing, 1 to 12",
        min_length=1,
    )
    samples: int = key(
        4 * 256**2, meaning="samples of all patterns together, the same for every number", ge=2048, le=2**24
    )
    spacing: float = key(
        11 / 256, unit="m", meaning="between samples of the smallest pattern, the same for every number", gt=0
    )
    largest: float = key(
        893.0, unit="m", meaning="the largest pattern, where `waves` permits it", gt=0, le=1e6
    )
    waves: float = key(8.0, unit="-", meaning="waves that fit at least into each pattern", ge=2.5, le=100)
    paper: tuple[float, ...] = key(
        (893.0, 101.0, 21.0, 11.0), unit="m", meaning="the paper's sizes", min_length=1, max_length=16
    )
    commensurate: tuple[float, ...] = key(
        (880.0, 110.0, 22.0, 11.0),
        unit="m",
        meaning="sizes that share their factors, for comparison",
        min_length=1,
        max_length=16,
    )
    resolution: int = key(
        256, meaning="grid points per side of all but the first", within="even, 8 to 4096", ge=8, le=4096
    )
    others: int = key(
        5, meaning="sets of sizes drawn at random around equal steps: do special sizes matter?", ge=2, le=1000
    )
    reach: float = key(5000.0, unit="m", meaning="distance over which repetition is looked for", gt=0, le=1e5)
    step: float = key(0.05, unit="m", meaning="between distances", gt=0)
    threshold: float = threshold_key()
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    draws: int = key(
        2_000_000, meaning="pairs of points drawn for the foam that comes again", ge=10_000, le=10**9
    )
    strip: float = key(2700.0, unit="m", meaning="length of the drawn strips of sea", gt=0, le=1e5)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if list(self.patterns) != sorted(set(self.patterns)):
            raise wrong("patterns", "increase from one to the next")
        for number in self.patterns:
            if not 1 <= number <= 12:
                raise wrong("patterns", f"hold numbers from 1 to 12, but one is {number}")
        if self.resolution % 2:
            raise wrong("resolution", f"be even, but is {self.resolution}")
        if self.reach / self.step > 1e6:
            raise wrong("step", f"be at least a millionth of `reach`, but is {self.step:g} m")
        for name in ("paper", "commensurate"):
            if min(getattr(self, name)) <= 0:
                raise wrong(name, "hold lengths greater than 0 m")
        if self.wind.speed <= 0:
            raise wrong("wind.speed", "be greater than 0: a calm sea does not repeat")
        return self
