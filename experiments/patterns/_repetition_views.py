"""The picture and the data of `repetition`."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

import jaxocean as jo

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable

EARTH = 40_075.0
"""Circumference of the Earth [km]."""


class Repetition(NamedTuple):
    """How one sum of patterns repeats.

    `height`, `jacobian`: highest side peak, its distance [m], its axis (0 x, 1 y), and the highest within 500 m;
    `again`: the share of the foam that is foam again at the highest peak of j, and its standard error.
    """

    name: str
    cascade: jo.surface.Cascade
    height_shares: np.ndarray
    jacobian_shares: np.ndarray
    height: tuple[float, float, int, float]
    jacobian: tuple[float, float, int, float]
    again: tuple[float, float]
    coverage: float
    distance: np.ndarray
    height_curve: np.ndarray
    jacobian_curve: np.ndarray

    @property
    def patterns(self) -> int:
        return self.cascade.count


def family(found: list[Repetition]) -> list[Repetition]:
    """Those that differ in the number of patterns alone."""
    return [one for one in found if one.name.startswith("n = ")]


def others(found: list[Repetition]) -> list[Repetition]:
    """Sizes drawn at random."""
    return [one for one in found if one.name.startswith("random")]


def named(found: list[Repetition], name: str) -> Repetition:
    return next(one for one in found if one.name == name)


def plot(
    store: Files, found: list[Repetition], strips: dict[str, np.ndarray], config: schema.RepetitionConfig
) -> None:
    """`repetition.png`: autocorrelations, side peaks and periods against n, and two strips of sea."""
    shown = _shown(found)
    layout = [[f"curve{i}", "peaks" if 2 * i < len(shown) else "period"] for i in range(len(shown))]
    layout += [["strip0", "strip0"], ["strip1", "strip1"]]
    heights = [1.0] * len(shown) + [0.95, 0.95]
    with _plots.mosaic(layout, size=(11.0, 10.2), width_ratios=(1.5, 1), height_ratios=heights) as (
        fig,
        axes,
    ):
        for i, one in enumerate(shown):
            _plot_curve(axes[f"curve{i}"], one, last=i == len(shown) - 1)
        axes["curve0"].set_title("(a) Autocorrelation of height (orange) and j (blue), along x")
        _plot_peaks(axes["peaks"], found)
        _plot_period(axes["period"], found)
        for i, (name, heights_of) in enumerate(strips.items()):
            _plot_strip(axes[f"strip{i}"], name, heights_of, named(found, name), config)
        axes["strip0"].set_title("(d) Height of one sea, and where its largest pattern begins again")
        axes["strip1"].set_xlabel("x (m)")
        store.picture("repetition", fig)


def _shown(found: list[Repetition]) -> list[Repetition]:
    every = family(found)
    chosen = [every[i] for i in sorted({0, min(1, len(every) - 1), len(every) // 2, len(every) - 1})]
    return [*chosen, named(found, "paper"), named(found, "commensurate")]


def _plot_curve(axes: Axes, one: Repetition, *, last: bool) -> None:
    km = one.distance / 1000
    axes.plot(km, one.height_curve, color=_plots.ORANGE, linewidth=0.9, label="height")
    axes.plot(km, one.jacobian_curve, color=_plots.BLUE, linewidth=0.9, label="Jacobian j")
    axes.set(ylim=(-0.1, 1.08), yticks=(0, 0.5, 1), xlim=(0, km[-1]))
    sizes = ", ".join(f"{size:.3g}" for size in one.cascade.sizes)
    label = f"{one.name}: {sizes} m"
    box: Any = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
    axes.annotate(label, (0.01, 0.97), xycoords="axes fraction", va="top", fontsize=8, bbox=box)
    if last:
        axes.set_xlabel("distance (km)")
    else:
        axes.tick_params(labelbottom=False)


def _plot_peaks(axes: Axes, found: list[Repetition]) -> None:
    every = family(found)
    n = [one.patterns for one in every]
    axes.plot(n, [one.height[0] for one in every], "s-", color=_plots.ORANGE, markersize=5, label="height")
    axes.plot(
        n, [one.jacobian[0] for one in every], "o-", color=_plots.BLUE, markersize=5, label="Jacobian j"
    )
    foam = np.array([one.again for one in every])
    axes.errorbar(
        n, foam[:, 0], yerr=2 * foam[:, 1], fmt="^-", color=_plots.GREEN, markersize=5, label="foam again"
    )
    drawn = np.array([one.jacobian[0] for one in others(found)])
    axes.errorbar(
        [4.2],
        [drawn.mean()],
        yerr=[[drawn.mean() - drawn.min()], [drawn.max() - drawn.mean()]],
        fmt="none",
        ecolor=_plots.BLUE,
        elinewidth=3,
        alpha=0.4,
        label=f"j, {len(drawn)} random sets of sizes",
    )
    marks = (("paper", "*", 13), ("commensurate", "X", 8), ("recommended", "P", 8), ("peak shared", "D", 6))
    for name, marker, size in marks:
        one = named(found, name)
        for value, colour in ((one.height[0], _plots.ORANGE), (one.jacobian[0], _plots.BLUE)):
            style: Any = {"markersize": size, "markeredgecolor": _plots.BLACK, "markeredgewidth": 0.7}
            axes.plot([one.patterns], [value], marker, color=colour, **style)
        axes.plot(
            [], [], marker, color="none", markeredgecolor=_plots.BLACK, markersize=size * 0.8, label=name
        )
    axes.set(ylim=(0, 1.6), yticks=np.linspace(0, 1, 6), ylabel="highest side peak (-)")
    axes.set(title="(b) Visible repetition", xlim=_counts(found))
    axes.tick_params(labelbottom=False)
    axes.legend(fontsize=7.5, ncols=2, loc="upper center")


def _counts(found: list[Repetition]) -> tuple[float, float]:
    n = [one.patterns for one in found]
    return min(n) - 0.4, max(n) + 0.4


def _plot_period(axes: Axes, found: list[Repetition]) -> None:
    every = family(found)
    period = [one.cascade.period / 1000 for one in every]
    axes.plot([one.patterns for one in every], period, "o-", color=_plots.BLACK, markersize=5)
    for name, marker, size in (("paper", "*", 13), ("commensurate", "X", 8)):
        one = named(found, name)
        style: Any = {"markersize": size, "markeredgecolor": _plots.BLACK, "markeredgewidth": 0.7}
        axes.plot([one.patterns], [one.cascade.period / 1000], marker, color=_plots.SKY, label=name, **style)
    axes.axhline(EARTH, color=_plots.GREY, linewidth=1, zorder=1)
    axes.annotate(
        "around the Earth", (0.02, EARTH), xycoords=("axes fraction", "data"), fontsize=8, va="bottom"
    )
    axes.set(yscale="log", xlabel="number of patterns n", ylabel="period (km)", title="(c) Exact period")
    axes.set(xlim=_counts(found))
    axes.legend(fontsize=8, loc="lower right")


def _plot_strip(
    axes: Axes, name: str, height: np.ndarray, one: Repetition, config: schema.RepetitionConfig
) -> None:
    reach = float(np.quantile(np.abs(height), 0.995))
    extent = (0.0, config.strip, 0.0, config.strip * height.shape[0] / height.shape[1])
    axes.imshow(
        height,
        extent=extent,
        cmap="Blues_r",
        vmin=-reach,
        vmax=reach,
        interpolation="bilinear",
        aspect="equal",
    )
    largest = max(one.cascade.sizes)
    often = largest < 0.1 * config.strip
    for place in [] if often else np.arange(largest, config.strip, largest):
        axes.plot([place, place], extent[2:], color=_plots.VERMILION, linewidth=1.4)
    axes.grid(visible=False)
    axes.set_ylabel(f"{name}\ny (m)")
    axes.set_title(f"every {largest:.4g} m", fontsize=9, fontweight="normal", loc="right")


def save(store: Files, found: list[Repetition], config: schema.RepetitionConfig) -> None:
    """`repetition.nc`: the curves and the numbers of every cascade."""
    numbers: dict[str, tuple[Callable[[Repetition], float], str, str]] = {
        "patterns": (lambda r: r.patterns, "1", "number of patterns"),
        "resolution": (lambda r: r.cascade.resolution, "1", "samples along each side of a pattern"),
        "largest_size": (lambda r: max(r.cascade.sizes), "m", "size of the largest pattern"),
        "smallest_size": (lambda r: min(r.cascade.sizes), "m", "size of the smallest pattern"),
        "period": (lambda r: r.cascade.period, "m", "distance after which the sum repeats exactly"),
        "height_peak": (lambda r: r.height[0], "1", "highest side peak of the autocorrelation of the height"),
        "height_peak_distance": (lambda r: r.height[1], "m", "distance of that peak"),
        "jacobian_peak": (lambda r: r.jacobian[0], "1", "highest side peak of the autocorrelation of j"),
        "jacobian_peak_distance": (lambda r: r.jacobian[1], "m", "distance of that peak"),
        "jacobian_peak_near": (lambda r: r.jacobian[3], "1", "highest side peak of j within 500 m"),
        "foam_again": (lambda r: r.again[0], "1", "share of the foam that is foam again at the peak of j"),
        "foam_again_error": (lambda r: r.again[1], "1", "standard error of that share"),
        "coverage": (lambda r: r.coverage, "1", "coverage of the plane at rest"),
    }
    store.data(
        "repetition",
        {
            name: variable("cascade", [float(of(r)) for r in found], units=units, long_name=text)
            for name, (of, units, text) in numbers.items()
        }
        | {
            name: variable(
                ("cascade", "distance"),
                np.stack([getattr(r, name) for r in found]),
                units="1",
                long_name=f"autocorrelation along the wind, largest from here to the next distance, {what}",
            )
            for name, what in (("height_curve", "height"), ("jacobian_curve", "Jacobian j"))
        },
        {
            "distance": variable("distance", found[0].distance, units="m", long_name="distance"),
            "cascade_name": variable(
                "cascade", [r.name for r in found], units="1", long_name="sum of patterns"
            ),
        },
        title="How sums of periodic patterns repeat",
        attributes={
            "wind_speed_m_per_s": config.wind.speed,
            "inverse_wave_age": config.spectrum.inverse_wave_age or "from the wind",
            "threshold": config.threshold,
            "choppiness": 1.0,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
        },
    )
