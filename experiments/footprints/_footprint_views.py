"""What was found in footprints, and its pictures."""

import math
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, SymmetricalLogLocator

from ..common import _plots
from ..common._tiles import Tile
from ..harness._files import Files
from . import _normality
from ._footprint_errors import CLOSURES, Errors
from ._footprint_storage import Stored

FEWEST = 0.5
"""Errors are shown relative to W where the standard error of W is below this share of it."""

STYLES: dict[str, Any] = {
    "exact": {"color": _plots.BLUE, "label": "exact closure"},
    "gaussian": {"color": _plots.ORANGE, "label": "Gaussian j, right variance"},
    "program": {"color": _plots.VERMILION, "label": "Dupuy & Bruneton, their program"},
    "exact_pyramid": {
        "color": _plots.SKY,
        "linestyle": "--",
        "linewidth": 1.3,
        "label": "exact, from the pyramid",
    },
    "exact_refined_pyramid": {
        "color": _plots.GREEN,
        "linestyle": "--",
        "linewidth": 1.3,
        "label": "exact, pyramid of twice the samples",
    },
}


class Sea(NamedTuple):
    """All seas of one wind."""

    speed: float
    plane: np.ndarray  # (threshold,): exact W of the whole plane
    skewness: float  # of j on the whole plane
    trusted: float  # lowest ε from which on Gaussian j is within 25 % there
    errors: list[Errors]
    shapes: np.ndarray  # (seed, quantity, statistic, size)

    @property
    def truth(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean coverage of the tiles per threshold, and its standard error."""
        return _mean([each.truth for each in self.errors])

    def bias(self, closure: str) -> tuple[np.ndarray, np.ndarray]:
        """Mean error [threshold, size] and its standard error."""
        return _mean([each.bias[CLOSURES.index(closure)] for each in self.errors])

    def root_mean_square(self, closure: str) -> tuple[np.ndarray, np.ndarray]:
        """Root-mean-square error [threshold, size] and its standard error."""
        mean, error = _mean([each.squared[CLOSURES.index(closure)] for each in self.errors])
        root = np.sqrt(mean)
        return root, np.divide(0.5 * error, root, out=np.zeros_like(root), where=root > 0)

    def defined(self, closure: str) -> np.ndarray:
        """Share of footprints of each size where the closure says anything."""
        return np.mean([each.defined[CLOSURES.index(closure)] for each in self.errors], axis=0)

    @property
    def counted(self) -> np.ndarray:
        """For which thresholds enough breaks to speak of relative errors."""
        mean, error = self.truth
        return (mean > 0) & (error < FEWEST * mean)


class Found(NamedTuple):
    """Everything that the experiment measured."""

    tile: Tile
    thresholds: tuple[float, ...]
    seas: tuple[Sea, ...]
    storage: tuple[Stored, ...]


def _mean(values: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    stacked = np.stack(values)
    return stacked.mean(axis=0), stacked.std(axis=0, ddof=1) / math.sqrt(len(stacked))


def plot_bias(store: Files, found: Found) -> None:
    """`footprint_bias.png`: relative bias of each closure for all ε, and the RMS error at the highest ε."""
    rows, columns = len(found.thresholds) + 1, len(found.seas)
    size = (max(6.5, 1.2 + 3.3 * columns), 1.3 + 2.6 * rows)
    options: Any = {"sharex": True, "sharey": "row", "squeeze": False}
    lengths = found.tile.lengths
    with _plots.figure(rows, columns, size=size, **options) as (fig, axes):
        for column, sea in zip(axes.T, found.seas, strict=True):
            truth, error = sea.truth
            for t, threshold in enumerate(found.thresholds):
                axis = column[t]
                words = f"ε = {threshold:g}:  W = {_scientific(truth[t])} ± {_scientific(error[t])}"
                axis.text(0.02, 0.97, words, transform=axis.transAxes, va="top", fontsize=8.5)
                axis.axhline(0, color=_plots.BLACK, linewidth=1, zorder=1)
                if sea.counted[t]:
                    _draw_relative(axis, sea, t, lengths)
                else:
                    place: Any = {"transform": axis.transAxes, "ha": "center", "color": _plots.GREY}
                    axis.text(0.5, 0.6, "too little breaks", **place)
            _draw_root_mean_square(column[-1], sea, lengths)
            column[0].set_title(f"U10 = {sea.speed:g} m/s")
            column[-1].set(xscale="log", xlabel="side of the footprint (m)")
            column[-1].xaxis.set_minor_formatter(NullFormatter())
        for t in range(len(found.thresholds)):
            axis = axes[t, 0]
            axis.set_yscale("symlog", linthresh=0.1, linscale=0.8)
            axis.set(ylabel="bias / W (-)", ylim=(-1.5, _top(found, t)))
            axis.yaxis.set_major_locator(SymmetricalLogLocator(base=10, linthresh=0.1))
            axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:+g}" if y else "0"))
        bottom = axes[-1, 0]
        bottom.set(yscale="log", ylabel=f"RMS error of W,\nε = {found.thresholds[-1]:g} (-)")
        bottom.yaxis.set_major_locator(LogLocator(numticks=8))
        handles = [Line2D([], [], **{"linewidth": 1.8, **style}) for style in STYLES.values()]
        undefined = min(float(np.min(1 - sea.defined("printed")[1:])) for sea in found.seas)
        words = f"as printed: undefined in {100 * math.floor(1000 * undefined) / 1000:g} % or more"
        handles.append(Line2D([], [], linestyle="", label=words))
        fig.legend(handles=handles, loc="outside lower center", ncols=3 if columns > 2 else 1)
        store.picture("footprint_bias", fig)


def _draw_relative(axes: Axes, sea: Sea, t: int, lengths: np.ndarray) -> None:
    truth = sea.truth[0][t]
    for name, style in STYLES.items():
        mean, error = (each[t] / truth for each in sea.bias(name))
        axes.plot(lengths, mean, **style)
        axes.fill_between(lengths, mean - 2 * error, mean + 2 * error, color=style["color"], alpha=0.2, lw=0)


def _draw_root_mean_square(axes: Axes, sea: Sea, lengths: np.ndarray) -> None:
    for name, style in STYLES.items():
        root, error = (each[-1] for each in sea.root_mean_square(name))
        # A single sample is its own mean: there is no error but that of rounding.
        seen = (lengths > lengths[0]) | (name not in ("exact", "gaussian"))
        root, error = np.where(seen & (root > 0), root, np.nan), np.where(seen, error, np.nan)
        axes.plot(lengths, root, **style)
        low, high = np.maximum(root - 2 * error, 0.2 * root), root + 2 * error
        axes.fill_between(lengths, low, high, color=style["color"], alpha=0.2, lw=0)


def _top(found: Found, t: int) -> float:
    """A little more than the largest relative bias drawn."""
    largest = [
        np.nanmax(sea.bias(name)[0][t] + 2 * sea.bias(name)[1][t]) / sea.truth[0][t]
        for sea in found.seas
        if sea.counted[t]
        for name in STYLES
    ]
    return 3.0 * max(1.0, *largest) if largest else 10.0


def plot_normality(store: Files, found: Found) -> None:
    """`normality.png`: skewness, excess kurtosis and Kolmogorov distance inside footprints, slopes beside j."""
    lengths = np.asarray(_normality.sizes(found.tile)) * found.tile.spacing
    options: Any = {"sharex": True, "sharey": "row", "squeeze": False}
    with _plots.figure(3, 3, size=(10.0, 7.6), **options) as (fig, axes):
        colours = _plots.colours_for(len(found.seas))
        for q, title in enumerate(_normality.QUANTITIES):
            axes[0, q].set_title(title)
            for s in range(3):
                axis = axes[s, q]
                if s < 2:
                    axis.axhline(0, color=_plots.BLACK, linewidth=1, zorder=1)
                for sea, colour in zip(found.seas, colours, strict=True):
                    values = sea.shapes[:, q, s]
                    mean, spread = values.mean(axis=0), values.std(axis=0, ddof=1)
                    axis.plot(lengths, mean, color=colour, label=f"{sea.speed:g} m/s")
                    axis.fill_between(
                        lengths, mean - spread, mean + spread, color=colour, alpha=0.25, linewidth=0
                    )
                    if q == 2 and s == 0:
                        axis.plot(lengths[-1] * 1.5, sea.skewness, "D", color=colour, markersize=5)
            axes[2, q].set(xscale="log", xlabel="side of the footprint (m)")
        for axis, label in zip(
            axes[:, 0],
            ("skewness (-)", "excess kurtosis (-)", "distance from normal,\nlargest |F − Φ| (-)"),
            strict=True,
        ):
            axis.set_ylabel(label)
        axes[2, 0].set_ylim(bottom=0)
        axes[0, 0].legend(title="wind U10", loc="best")
        words = "diamonds: whole plane, closed form"
        axes[0, 2].text(0.98, 0.03, words, transform=axes[0, 2].transAxes, fontsize=8.5, ha="right")
        store.picture("normality", fig)


def _scientific(number: float) -> str:
    if not number > 0:
        return "0"
    exponent = math.floor(math.log10(number))
    return f"{number / 10**exponent:.1f}·10$^{{{exponent}}}$"
