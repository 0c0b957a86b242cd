"""The config of `dupuy_scenes`, and the scenes themselves."""

from dataclasses import dataclass
from typing import Literal, Self

from pydantic import model_validator

from ._base import ExperimentConfig, key, wrong


@dataclass(frozen=True)
class Scene:
    """One scene of the program published with Dupuy & Bruneton 2012.

    **Arguments:** `sizes` L_i [m]; `choppiness` λ_i; `wind` U10 [m/s]; `threshold` ε; `amplitude`: factor on the
    spectrum's variance; `inverse_wave_age` Ω.
    """

    sizes: tuple[float, ...]
    choppiness: tuple[float, ...]
    wind: float
    threshold: float
    amplitude: float = 2.0
    inverse_wave_age: float = 2.0


_SIZES = (893.0, 101.0, 21.0, 11.0)
SCENES: dict[int, Scene] = {
    1: Scene(_SIZES, (2.3, 2.1, 1.3, 0.9), 12.0, 0.2),
    2: Scene((5409.0, 503.0, 51.0, 7.0), (2.3, 1.9, 1.5, 0.6), 10.0, 0.171, amplitude=2.3),
    4: Scene(_SIZES, (2.0, 1.6, 0.9, 0.7), 12.0, 0.138),
    6: Scene(_SIZES, (2.3, 2.1, 1.3, 0.9), 12.0, -0.068),
}
"""The published scenes by their numbers."""


class DupuyScenesConfig(ExperimentConfig):
    """`dupuy_scenes`: coverage of the published scenes by every formula, and counted."""

    experiment: Literal["dupuy_scenes"] = key("dupuy_scenes", meaning="which experiment this config runs")
    scenes: tuple[int, ...] = key(
        tuple(SCENES),
        meaning="numbers of the published scenes",
        within="1, 2, 4, 6; each once",
        min_length=1,
    )
    resolution: int = key(
        256, meaning="grid points per side of every pattern", within="even, 16 to 1024", ge=16, le=1024
    )
    peak_enhancement: Literal["program", "published"] = key(
        "program",
        meaning="γ of the program's sea: 1.7 + 6 ln Ω as it computes, or 1.7 + 6 log10 Ω as published",
    )
    realisations: int = key(64, meaning="seas that are counted: their spread is their error", ge=8, le=10_000)
    shifts: int = key(4, meaning="arrangements of the patterns counted in each sea", ge=1, le=64)
    crop: float = key(25.0, unit="m", meaning="side of the maps of whitecaps", gt=0, le=1e4)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for number in self.scenes:
            if number not in SCENES:
                raise wrong("scenes", f"hold numbers of published scenes (1, 2, 4, 6), but one is {number}")
        if len(set(self.scenes)) < len(self.scenes):
            raise wrong("scenes", "hold each scene once")
        if self.resolution % 2:
            raise wrong("resolution", f"be even, but is {self.resolution}")
        return self
