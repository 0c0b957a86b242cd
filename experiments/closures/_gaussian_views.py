"""Pictures and data of closures against counts."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from .. import schema
from ..common import _plots
from ..common._counting import Counted, Draws, normal_quantile
from ..harness._files import Files, variable

LOWEST, HIGHEST = 1e-10, 1e3
"""Coverage below and ratios above are not drawn."""

ERROR_BARS: Any = {"elinewidth": 1.0, "capsize": 1.5}
OPEN: Any = {"markerfacecolor": "none", "markeredgewidth": 0.9}

FEWEST = 10
"""Draws are compared with closures where so many of them should break; FFT seas where half of them do."""


class Curves(NamedTuple):
    """Coverage [-] against the threshold ε."""

    threshold: Any
    exact: Any
    gaussian: Any
    published: Any
    ratio: Any  # Gaussian over exact, also where both underflow


class Closed(NamedTuple):
    """One sea without sampling: coverage, moments of j, and its densities at the centres of the bins."""

    at: Curves
    fine: Curves
    published_variance: Any
    variance: Any
    skewness: Any
    density: Any
    gaussian_density: Any


class Comparison(NamedTuple):
    """One sea, closed and counted."""

    speed: float
    closed: Closed
    draws: Draws
    realised: Counted

    @property
    def published_is_defined(self) -> bool:
        return bool(self.closed.published_variance > 0)

    @property
    def drawn(self) -> np.ndarray:
        """Where the draws say something: decided by what is expected, lest chance choose the cases."""
        return (self.closed.at.exact * self.draws.total >= FEWEST) & (self.draws.counted.error > 0)

    @property
    def seen(self) -> np.ndarray:
        """Where the FFT seas say something."""
        return self.realised.seen >= len(self.realised.coverage) / 2


def plot_coverage(store: Files, seas: list[Comparison], config: schema.GaussianVsMonteCarloConfig) -> None:
    """`coverage.png`: W(ε) of each wind, the error of the Gaussian closure, and counts over the exact coverage."""
    layout = [["coverage", "gaussian"], ["coverage", "counted"]]
    with _plots.mosaic(layout, size=(10.0, 6.0), width_ratios=(1.2, 1)) as (fig, axes):
        left, top, bottom = axes["coverage"], axes["gaussian"], axes["counted"]
        colours = _plots.colours_for(len(seas))
        for sea, colour in zip(seas, colours, strict=True):
            _draw_coverage(left, sea, colour, config)
            _draw_ratio(top, sea, colour)
            _draw_residuals(bottom, sea, colour, config)
        area = {"rest": "rest area", "projected": "projected area"}[config.measure]
        left.set(yscale="log", ylim=(LOWEST, 1), xlabel="breaking threshold ε (-)")
        left.set(ylabel=f"whitecap coverage W, {area} (-)", title="(a) Coverage")
        left.yaxis.set_major_locator(LogLocator(numticks=12))
        left.yaxis.set_minor_formatter(NullFormatter())
        _legends(left, seas, colours, config)
        for axis in (top, bottom):
            axis.axhline(1, color=_plots.BLACK, linewidth=1, zorder=1)
        top.set(
            title="(b) Gaussian over exact; dots: over draws",
            ylabel="ratio of coverages (-)",
            ylim=(0.5, HIGHEST),
        )
        top.set(yscale="log", xlim=_informative(seas), xlabel="breaking threshold ε (-)")
        bottom.set(
            title=f"(c) Counted over exact, {100 * config.confidence:g} % intervals",
            ylabel="ratio of coverages (-)",
            ylim=(0.7, 1.3),
        )
        bottom.set(xscale="log", xlabel="exact coverage W (-)")
        store.picture("coverage", fig)


def _draw_coverage(axes: Axes, sea: Comparison, colour: Any, config: Any) -> None:
    fine, x = sea.closed.fine, sea.closed.at.threshold
    axes.plot(fine.threshold, _visible(fine.exact), color=colour)
    axes.plot(fine.threshold, _visible(fine.gaussian), "--", color=colour, linewidth=1.3)
    if config.measure == "rest":
        axes.plot(fine.threshold, _visible(fine.published), ":", color=_plots.BLACK, linewidth=2.2)
    mean, bars = sea.draws.counted.mean, _bars(sea, config)
    # The binomial interval holds for any count, the normal one of the projected area for many only.
    use = sea.draws.counted.seen > 0 if config.measure == "rest" else sea.drawn
    axes.errorbar(x[use], mean[use], yerr=bars[:, use], fmt="o", color=colour, markersize=3.5, **ERROR_BARS)
    use = sea.seen
    axes.plot(x[use], sea.realised.mean[use], "s", color=colour, markersize=7, **OPEN)


def _draw_ratio(axes: Axes, sea: Comparison, colour: Any) -> None:
    """The Gaussian closure over the exact one, and over what was counted."""
    fine, use = sea.closed.fine, sea.drawn
    axes.plot(fine.threshold, np.minimum(fine.ratio, 100 * HIGHEST), "--", color=colour, linewidth=1.3)
    over = sea.closed.at.gaussian[use] / sea.draws.counted.mean[use]
    axes.plot(sea.closed.at.threshold[use], over, "o", color=colour, markersize=3.5)


def _draw_residuals(axes: Axes, sea: Comparison, colour: Any, config: Any) -> None:
    """Counts over the exact coverage, against the latter: the fewer break, the less they can tell."""
    exact = sea.closed.at.exact
    mean, bars, use = sea.draws.counted.mean, _bars(sea, config), sea.drawn
    axes.errorbar(
        exact[use],
        mean[use] / exact[use],
        yerr=bars[:, use] / exact[use],
        fmt="o",
        color=colour,
        markersize=3.5,
        **ERROR_BARS,
    )
    mean, use = sea.realised.mean, sea.seen
    half = normal_quantile(config.confidence) * sea.realised.error
    x = exact[use] * 1.12  # beside the draws
    axes.errorbar(
        x,
        mean[use] / exact[use],
        yerr=half[use] / exact[use],
        fmt="s",
        color=colour,
        markersize=5,
        elinewidth=0.8,
        **OPEN,
    )


def _bars(sea: Comparison, config: Any) -> np.ndarray:
    lower, upper = sea.draws.interval(config.confidence)
    return np.array([sea.draws.counted.mean - lower, upper - sea.draws.counted.mean])


def _informative(seas: list[Comparison]) -> tuple[float, float]:
    """The thresholds at which the ratio is on the picture for some wind."""
    x = seas[0].closed.fine.threshold
    shown = np.any([sea.closed.fine.ratio < HIGHEST for sea in seas], axis=0)
    margin = 0.03 * (x[-1] - x[0])
    return float(x[shown][0] - margin if shown.any() else x[0]), float(x[-1] + margin)


def _legends(axes: Axes, seas: list[Comparison], colours: Any, config: Any) -> None:
    winds = [
        Line2D([], [], color=colour, label=f"{sea.speed:g} m/s")
        for sea, colour in zip(seas, colours, strict=True)
    ]
    draws, realisations = f"{seas[0].draws.total:,}", len(seas[0].realised.coverage)
    dark: Any = {"color": _plots.BLACK}
    ways = [
        Line2D([], [], label="exact closure", **dark),
        Line2D([], [], linestyle="--", linewidth=1.3, label="Gaussian closure", **dark),
        Line2D([], [], marker="o", linestyle="", markersize=3.5, label=f"{draws} draws", **dark),
        Line2D(
            [], [], marker="s", linestyle="", markersize=7, label=f"{realisations} FFT seas", **dark, **OPEN
        ),
    ]
    if config.measure == "rest":
        defined = any(sea.published_is_defined for sea in seas)
        style: Any = {"linestyle": ":" if defined else "", "linewidth": 2.2}
        name = "published closure" if defined else "published closure: undefined"
        ways.append(Line2D([], [], label=name, **dark, **style))
    axes.add_artist(axes.legend(handles=winds, title="wind U10", loc="lower right"))
    axes.legend(handles=ways, loc="upper left")


def plot_densities(store: Files, seas: list[Comparison], j: np.ndarray) -> None:
    """`densities.png`: histograms of j with the exact and the Gaussian density, linear and logarithmic."""
    chosen = seas if len(seas) <= 4 else [seas[i] for i in np.linspace(0, len(seas) - 1, 4).astype(int)]
    width = float(j[1] - j[0])
    size = (max(6.0, 1.0 + 2.4 * len(chosen)), 5.2)
    options: Any = {"sharex": True, "sharey": "row", "squeeze": False, "height_ratios": (1, 1.3)}
    with _plots.figure(2, len(chosen), size=size, **options) as (fig, axes):
        top = max(float(sea.closed.density.max()) for sea in chosen)
        for column, sea in zip(axes.T, chosen, strict=True):
            for each in column:
                bars = each.bar(j, sea.draws.density, width, color="#C9C9C9")
                (exact,) = each.plot(j, sea.closed.density, color=_plots.BLUE)
                (gaussian,) = each.plot(j, sea.closed.gaussian_density, "--", color=_plots.VERMILION)
            skewness = f"skewness {float(sea.closed.skewness):.3f}\ncounted {sea.draws.skewness:.3f}"
            column[0].set(title=f"U10 = {sea.speed:g} m/s", ylim=(0, 1.3 * top))
            place: Any = {"xycoords": "axes fraction", "ha": "right", "va": "top", "fontsize": 9}
            column[0].annotate(skewness, (1.0, 1.0), **place)
            column[1].set(yscale="log", ylim=(1e-6 * top, 3 * top), xlabel="Jacobian j (-)")
        axes[0, 0].set(ylabel="density of j (-)", xlim=(j[0], j[-20]))
        axes[1, 0].set(ylabel="density of j (-)")
        names = ("exact density", "Gaussian density", f"{chosen[0].draws.total:,} draws")
        fig.legend((exact, gaussian, bars), names, loc="outside lower center", ncols=3)
        store.picture("densities", fig)


def _visible(coverage: np.ndarray) -> np.ndarray:
    return np.where(coverage > 0.01 * LOWEST, coverage, np.nan)


def save(
    store: Files, seas: list[Comparison], j: np.ndarray, config: schema.GaussianVsMonteCarloConfig
) -> None:
    """`coverage.nc` and `densities.nc`."""
    intervals = [sea.draws.interval(config.confidence) for sea in seas]
    columns = {
        "exact": ([sea.closed.at.exact for sea in seas], "exact closure"),
        "gaussian": ([sea.closed.at.gaussian for sea in seas], "Gaussian closure"),
        "monte_carlo": ([sea.draws.counted.mean for sea in seas], "Monte Carlo"),
        "monte_carlo_lower": ([lower for lower, _ in intervals], "Monte Carlo, lower end of the interval"),
        "monte_carlo_upper": ([upper for _, upper in intervals], "Monte Carlo, upper end of the interval"),
        "fft": ([sea.realised.mean for sea in seas], "FFT realisations, mean"),
        "fft_standard_error": ([sea.realised.error for sea in seas], "FFT realisations, standard error"),
    }
    if config.measure == "rest":
        columns["published"] = (
            [sea.closed.at.published for sea in seas],
            "published closure; NaN where undefined",
        )
    attributes = {
        "measure": config.measure,
        "choppiness": np.atleast_1d(config.choppiness),
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
        "draws": seas[0].draws.total,
        "realisations": config.realisations,
        "confidence": config.confidence,
    }
    speed = variable(
        "wind", [sea.speed for sea in seas], units="m s-1", long_name="U10", standard_name="wind_speed"
    )
    store.data(
        "coverage",
        {
            name: variable(("wind", "threshold"), np.stack(values), units="1", long_name=f"coverage, {text}")
            for name, (values, text) in columns.items()
        },
        {
            "wind": speed,
            "threshold": variable(
                "threshold", seas[0].closed.at.threshold, units="1", long_name="breaking threshold"
            ),
        },
        title="Whitecap coverage against the breaking threshold, closed and counted",
        attributes=attributes,
    )
    densities = {
        "exact": [sea.closed.density for sea in seas],
        "gaussian": [sea.closed.gaussian_density for sea in seas],
        "monte_carlo": [sea.draws.density for sea in seas],
    }
    store.data(
        "densities",
        {
            name: variable(
                ("wind", "jacobian"), np.stack(values), units="1", long_name=f"density of j, {name}"
            )
            for name, values in densities.items()
        }
        | {
            "skewness": variable(
                "wind", [float(sea.closed.skewness) for sea in seas], units="1", long_name="skewness of j"
            )
        },
        {"wind": speed, "jacobian": variable("jacobian", j, units="1", long_name="Jacobian j")},
        title="Density of the Jacobian, closed and counted",
        attributes=attributes,
    )
