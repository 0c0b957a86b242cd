"""Breakers as events: connected in space and time on a periodic tile, and as cameras measured them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage, sparse

from ..common._columns import read_columns

EVERY_NEIGHBOUR = np.ones((3, 3, 3), bool)


@dataclass(frozen=True)
class Events:
    """Durations of breakers [s] with weights that make up for those that a window cuts."""

    duration: np.ndarray
    weight: np.ndarray

    def mean(self, shortest: float = 0.0) -> tuple[float, float]:
        """Mean duration [s] of those that last at least so long, and its standard error; NaN if there are none."""
        use = self.duration >= shortest - 1e-9
        if use.sum() < 2:
            return float("nan"), float("nan")
        duration, weight = self.duration[use], self.weight[use] / self.weight[use].sum()
        mean = float(np.sum(weight * duration))
        return mean, float(np.sqrt(np.sum(weight**2 * (duration - mean) ** 2)))


def follow(breaks: np.ndarray, step: float) -> Events:
    """Durations of the connected events in `breaks[time, y, x]`; x and y are periodic.

    Events that touch the first or the last frame are left out, since how long they last is not known. The longer an
    event, the likelier it is cut: the others are weighted by 1/(window − duration).
    """
    found: Any = ndimage.label(breaks, structure=EVERY_NEIGHBOUR)
    labels, count = found
    if count == 0:
        return Events(np.zeros(0), np.zeros(0))
    parts = ndimage.find_objects(labels)
    first = np.array([part[0].start for part in parts])
    last = np.array([part[0].stop for part in parts])
    whole = _join(labels, count)
    starts, ends = np.full(whole.max() + 1, len(breaks)), np.zeros(whole.max() + 1, int)
    np.minimum.at(starts, whole, first)
    np.maximum.at(ends, whole, last)
    inside = (starts > 0) & (ends < len(breaks))
    frames = (ends - starts)[inside]
    return Events(frames * step, 1.0 / (len(breaks) - 1 - frames).clip(min=1))


def _join(labels: np.ndarray, count: int) -> np.ndarray:
    """For each label the number of the event that it belongs to, across the edges of the tile."""
    pairs = []
    for axis in (1, 2):
        one, other = np.take(labels, -1, axis=axis), np.take(labels, 0, axis=axis)
        for in_time in (-1, 0, 1):
            for aside in (-1, 0, 1):
                near = np.roll(other, aside, axis=1)
                a, b = one[max(0, -in_time) : len(one) - max(0, in_time)], near[max(0, in_time) :]
                b = b[: len(a)]
                both = (a > 0) & (b > 0)
                pairs.append(np.stack([a[both], b[both]]))
    a, b = np.concatenate(pairs, axis=1) - 1
    links = sparse.coo_matrix((np.ones(len(a), bool), (a, b)), shape=(count, count))
    return sparse.csgraph.connected_components(links, directed=False)[1]


@dataclass(frozen=True)
class Measured:
    """Durations [s] of measured events and the wind [m/s] of each."""

    duration: np.ndarray
    wind: np.ndarray

    def by_wind(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Winds [m/s], mean durations [s] and their standard errors."""
        winds = np.unique(self.wind)
        groups = [self.duration[self.wind == wind] for wind in winds]
        mean = np.array([group.mean() for group in groups])
        error = np.array(
            [group.std(ddof=1) / np.sqrt(len(group)) if len(group) > 1 else np.nan for group in groups]
        )
        return winds, mean, error


def read_measured(path: Path) -> Measured:
    """Events from a CSV file with the columns `wave_breaking_duration` [s] and `wind_speed` [m/s]."""
    columns = read_columns(str(path), ("wave_breaking_duration", "wind_speed"))
    return Measured(np.asarray(columns["wave_breaking_duration"]), np.asarray(columns["wind_speed"]))
