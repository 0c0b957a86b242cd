"""What `foam_in_time` gathers: the calibration, how foam grew on the tiles, and their means with errors."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import fitting
from jaxocean.whitecaps import foam

from .. import schema
from ._foam_events import Events, Measured

FIELDS = foam.Coverage._fields
"""The first columns of a series; coverage at the decay times follows."""


class Points(NamedTuple):
    """How a point breaks in each wind, without a tile."""

    rest: np.ndarray
    projected: np.ndarray
    rate: np.ndarray
    duration: np.ndarray

    @classmethod
    def of(cls, points: foam.PointBreaking) -> "Points":
        """Plain arrays of what the room says, batched over winds."""
        return cls(*(np.asarray(getattr(points, name)) for name in cls._fields))


@dataclass(frozen=True)
class Calibration:
    """ε and τ, shared (`used`, with their fits) and for each wind (`own_…`), and what the closed forms say then.

    `closed[closure, measure]` is total coverage [wind, decay time]; `active_law`
    and `total_law` are the laws' coverage; `table` has a row for each k_b.
    """

    threshold: fitting.Fit | None
    decay_time: fitting.Fit
    used: tuple[float, float]
    own_threshold: np.ndarray
    own_decay_time: np.ndarray
    points: Points
    decay_times: np.ndarray
    closed: dict[tuple[str, str], np.ndarray]
    active_law: np.ndarray
    total_law: np.ndarray
    table: list[tuple[float, ...]]

    @property
    def place(self) -> int:
        """Where the decay time that is used stands among all."""
        return int(np.argmin(np.abs(self.decay_times - self.used[1])))


class Picture(NamedTuple):
    """One tile at one time [s]: foam, its age [s], displacement [m] and height [m]."""

    time: float
    coverage: np.ndarray
    age: np.ndarray
    displacement: np.ndarray
    height: np.ndarray


@dataclass(frozen=True)
class Growth:
    """Foam of one wind: `series[sea, time, field]`, of which the first `spin` steps are no part of any mean."""

    series: np.ndarray
    spin: int
    events: Events
    picture: Picture | None

    @classmethod
    def of_seas(cls, seas: list[tuple[np.ndarray, Events, Picture | None]], spin: int) -> "Growth":
        """Put the seas of one wind together."""
        events = Events(
            *(np.concatenate([getattr(one, name) for _, one, _ in seas]) for name in ("duration", "weight"))
        )
        picture = next((one for *_, one in seas if one is not None), None)
        return cls(np.stack([series for series, *_ in seas]).astype(float), spin, events, picture)

    def column(self, name: str) -> np.ndarray:
        """A series [sea, time] by the name of its field."""
        return self.series[..., FIELDS.index(name)]

    def at_decay_time(self, place: int) -> np.ndarray:
        """Total rest coverage [sea, time] at one of the decay times; NaN where it was not counted."""
        return self.series[..., len(FIELDS) + place]

    def mean(self, values: np.ndarray) -> tuple[float, float]:
        """Mean after the spin-up and its standard error, from the scatter of the seas."""
        seas = np.nanmean(values[:, self.spin :], axis=1)
        return float(seas.mean()), float(seas.std(ddof=1) / np.sqrt(len(seas)))

    def blocks(self, values: np.ndarray, block: int) -> np.ndarray:
        """Means of blocks after the spin-up, all seas behind each other."""
        kept = values[:, self.spin :]
        count = max(1, kept.shape[1] // block)
        return np.array([np.nanmean(part) for one in kept for part in np.array_split(one, count)])


@dataclass(frozen=True)
class View:
    """Everything that pictures, data and report are made of."""

    config: schema.FoamInTimeConfig
    calibration: Calibration
    growths: list[Growth]
    measured: Measured | None

    @property
    def picture(self) -> Picture | None:
        """The tile that is drawn."""
        return next((growth.picture for growth in self.growths if growth.picture is not None), None)

    @property
    def block(self) -> int:
        """Steps of a block."""
        return max(1, round(self.config.block / self.config.step))

    def mean(self, name: str) -> np.ndarray:
        """Mean and standard error [2, wind] of a field."""
        return np.array([g.mean(g.column(name)) for g in self.growths]).T

    def total_at(self, place: int) -> np.ndarray:
        """Mean and standard error [2, wind] of total rest coverage at a decay time."""
        return np.array([g.mean(g.at_decay_time(place)) for g in self.growths]).T

    def closure_error(self, closure: str) -> np.ndarray:
        """Closed form over tile minus one, and its standard error [2, wind, decay time], rest area.

        The closed form is given how much the tile breaks and how often its points start to: what is left is its
        assumption on the times in between, not by how much a few seas differ from the average of all.
        """
        calibration = self.calibration
        points, times = calibration.points, calibration.decay_times
        fresh = calibration.closed[closure, "rest"] - points.rest[:, None]
        lasting = fresh / (points.rate[:, None] * times)  # 1 − E[e^{−D/τ}]
        result = np.empty((2, *lasting.shape))
        for i, growth in enumerate(self.growths):
            active = growth.column("active_rest")
            for k, tau in enumerate(times):
                total = growth.at_decay_time(k)
                closed = active + lasting[i, k] * self._without_repeats(growth.column("birth_rate"), tau)
                closed = np.where(np.isnan(total), np.nan, closed)
                one, other = growth.blocks(closed, self.block), growth.blocks(total, self.block)
                ratio = one.mean() / other.mean()
                residual = one - ratio * other
                result[:, i, k] = ratio - 1, residual.std(ddof=1) / np.sqrt(len(residual)) / other.mean()
        return result

    def _without_repeats(self, rate: np.ndarray, tau: float) -> np.ndarray:
        """Decaying foam [sea, time] if no point broke again before its foam is gone: births, each fading away."""
        step = self.config.step
        fade = np.exp(-step / tau)
        foam, series = np.zeros(rate.shape[0]), np.empty_like(rate)
        for i, births in enumerate(rate.T):
            foam = fade * (foam + births * step)
            series[:, i] = foam
        return series
