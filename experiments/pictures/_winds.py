"""Winds found in several images: how good they are, and how good what needs no model is."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from scipy import stats

from fitting.pictures import PhotographFit
from jaxocean import optics
from jaxocean.render import Camera
from jaxocean.whitecaps.laws import Monahan1980

from ..common import _plots
from ..harness._files import Files, variable
from ..harness._result import Table
from ._photographs import WIND

MONAHAN = Monahan1980()

LEAST_FOAM = 1e-5
"""Share of bright pixels below which there are none: a law inverted needs one."""

NEAREST = np.radians(2.0)
"""How far below the horizon [rad] bright pixels count: farther away a crest hides the foam of the next."""


@dataclass(frozen=True)
class Inferred:
    """The wind of one image.

    **Arguments:** `name`; `true` U10 [m/s]; `found`, `low`, `high`: with its interval; `guess`: by regression alone;
    `misfit`; `foam`: share of bright pixels; `seconds`; `failure`: why there is none, else empty.
    """

    name: str
    true: float
    found: float
    low: float
    high: float
    guess: float
    misfit: float
    foam: float
    seconds: float
    failure: str = ""

    @classmethod
    def of(cls, name: str, true: float, fit: PhotographFit, level: float, foam: float) -> "Inferred":
        """From a fit."""
        low, high = fit.interval(WIND, level)
        return cls(name, true, fit.values[WIND], low, high, fit.guess[WIND], fit.misfit, foam, fit.seconds)

    @classmethod
    def failed(cls, name: str, true: float, failure: Exception, foam: float = math.nan) -> "Inferred":
        """Where there is no fit, and why."""
        nothing = math.nan
        return cls(name, true, nothing, nothing, nothing, nothing, nothing, foam, nothing, str(failure))

    @property
    def from_foam(self) -> float:
        """U10 [m/s] by Monahan's law from the share of bright pixels."""
        ratio = max(self.foam, LEAST_FOAM) / float(MONAHAN.coefficient)
        return ratio ** (1 / float(MONAHAN.exponent))


@dataclass(frozen=True)
class Score:
    """How good a way to the wind is.

    **Arguments:** `name`; `median_error`: median of |ln found/true| [-]; `bias`: mean of found − true [m/s]; `rms`: of
    found − true [m/s]; `rank`: Spearman's correlation; `holding`: share of intervals that hold the truth.
    """

    name: str
    median_error: float
    bias: float
    rms: float
    rank: float
    holding: float


def scores(inferred: Sequence[Inferred]) -> list[Score]:
    """Of the fit, of the regression alone, and of the two ways without a model."""
    found = [each for each in inferred if not each.failure]
    true = np.asarray([each.true for each in found])
    inside = np.asarray([each.low <= each.true <= each.high for each in found])
    constant = np.full(true.size, np.median(true) if true.size else np.nan)
    ways = (
        ("fit", [each.found for each in found], float(np.mean(inside)) if found else np.nan),
        ("regression alone", [each.guess for each in found], np.nan),
        ("constant median wind", constant, np.nan),
        ("bright pixels through Monahan 1980", [each.from_foam for each in found], np.nan),
    )
    return [_score(name, np.asarray(values, float), true, holding) for name, values, holding in ways]


def _score(name: str, found: np.ndarray, true: np.ndarray, holding: float) -> Score:
    if not true.size:
        return Score(name, np.nan, np.nan, np.nan, np.nan, holding)
    # The same wind for all has no order.
    same = true.size < 2 or np.ptp(found) == 0 or np.ptp(true) == 0
    rank = np.nan if same else float(np.asarray(stats.spearmanr(found, true))[0])
    off = found - true
    return Score(
        name,
        float(np.median(np.abs(np.log(found / true)))),
        float(np.mean(off)),
        float(np.sqrt(np.mean(off**2))),
        rank,
        holding,
    )


def score_table(found: Sequence[Score], level: float) -> Table:
    """One row for each way."""
    columns = (
        "way",
        "median error (%)",
        "bias (m/s)",
        "rms error (m/s)",
        "rank correlation",
        f"{100 * level:g} % intervals that hold the truth (%)",
    )
    rows = [
        (each.name, 100 * np.expm1(each.median_error), each.bias, each.rms, each.rank, 100 * each.holding)
        for each in found
    ]
    return Table("Winds against the truth", columns, rows)


def wind_table(inferred: Sequence[Inferred], what: str, level: float) -> Table:
    """One row for each image."""
    columns = (
        what,
        "true U10 (m/s)",
        "found (m/s)",
        f"{100 * level:g} % interval (m/s)",
        "regression alone (m/s)",
        "misfit",
        "bright pixels (%)",
        "from these (m/s)",
    )
    rows = []
    for each in inferred:
        if each.failure:
            rows.append((each.name, each.true, "-", "-", "-", "-", "-", "-"))
            continue
        rows.append(
            (
                each.name,
                each.true,
                each.found,
                f"{each.low:.1f} to {each.high:.1f}",
                each.guess,
                each.misfit,
                100 * each.foam,
                each.from_foam,
            )
        )
    return Table("Images", columns, rows)


def bright_share(light: np.ndarray, camera: Camera, mask: np.ndarray | None) -> float:
    """Share of the pixels of sea that are three robust deviations brighter than their median.

    The plain way: one threshold for the whole sea, median + 3 × 1.4826 median absolute deviations of the luminance.
    """
    rays = np.asarray(camera.rays(light.shape[:2]))
    sea = np.arcsin(np.clip(-rays[..., 2], -1, 1)) > NEAREST
    if mask is not None:
        sea &= mask > 0.5
    values = np.asarray(optics.luminance(jnp.asarray(light)))[sea]
    if not values.size:
        return float("nan")
    middle = np.median(values)
    spread = 1.4826 * np.median(np.abs(values - middle))
    return float(np.mean(values > middle + 3 * spread))


def plot(store: Files, inferred: Sequence[Inferred], level: float, labels: bool) -> None:
    """`winds.png`: what was found over what is true, and the two ways without a model."""
    found = [each for each in inferred if not each.failure]
    true = np.asarray([each.true for each in found])
    panels = (
        (f"Fit, with {100 * level:g} % intervals", np.asarray([each.found for each in found]), _plots.BLUE),
        ("Bright pixels through Monahan 1980", np.asarray([each.from_foam for each in found]), _plots.ORANGE),
    )
    every = [value for each in found for value in (each.low, each.high, each.from_foam)]
    ends = np.array([0.9 * min([2.2, *every]), 1.1 * max([27.0, *every])])
    with _plots.figure(1, 2, size=(10.5, 5.2), sharey=True) as (fig, axes):
        for number, (axis, (title, values, colour)) in enumerate(zip(axes, panels, strict=True)):
            errors = None
            if number == 0 and found:
                errors = np.abs([[each.found - each.low, each.high - each.found] for each in found]).T
            axis.errorbar(true, values, yerr=errors, fmt="o", ms=5, lw=1.2, color=colour)
            axis.plot(ends, ends, color=_plots.GREY, lw=1, label="truth")
            axis.fill_between(
                ends, 0.85 * ends, 1.15 * ends, color=_plots.GREY, alpha=0.15, lw=0, label="± 15 %"
            )
            if labels:
                for each, value in zip(found, values, strict=True):
                    axis.annotate(
                        each.name, (each.true, value), (4, 4), textcoords="offset points", fontsize=7
                    )
            axis.set(xscale="log", yscale="log", xlabel="true U10 (m/s)", xlim=(2.5, 24.0), ylim=ends)
            for side in (axis.xaxis, axis.yaxis):
                side.set_major_formatter(lambda value, _: f"{value:g}")
                side.set_minor_formatter(lambda value, _: "")
            axis.set_xticks([3, 5, 10, 20])
            axis.set_yticks(
                [tick for tick in (0.5, 1, 2, 3, 5, 10, 20, 30, 50) if ends[0] <= tick <= ends[1]]
            )
            axis.set_title(title)
        axes[0].set_ylabel("found U10 (m/s)")
        axes[0].legend(loc="upper left")
        store.picture("winds", fig)


def save(store: Files, inferred: Sequence[Inferred], title: str) -> None:
    """`winds.nc`: all of it."""
    columns = (
        ("true", "m s-1", "true wind speed at 10 m"),
        ("found", "m s-1", "wind speed found"),
        ("low", "m s-1", "lower end of its interval"),
        ("high", "m s-1", "upper end of its interval"),
        ("guess", "m s-1", "wind speed by regression alone"),
        ("from_foam", "m s-1", "wind speed from bright pixels by Monahan 1980"),
        ("foam", "1", "share of bright pixels"),
        ("misfit", "1", "mean square distance of statistics in units of chance"),
    )
    variables = {
        name: variable("image", [getattr(each, name) for each in inferred], units=units, long_name=words)
        for name, units, words in columns
    }
    store.data("winds", variables, title=title)
