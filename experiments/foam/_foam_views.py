"""The figure of foam in time."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..common import _build, _plots
from ..harness._files import Files
from ._foam_results import View

MONAHAN, CALLAGHAN = 3.53, (1.4, 4.8)
"""Decay times of foam [s] in the literature."""

BARS: Any = {"elinewidth": 1.1, "capsize": 2}
OPEN: Any = {"markerfacecolor": "white", "markeredgewidth": 1.1}


def plot(store: Files, view: View) -> None:
    """`foam_in_time.png`."""
    layout = [["series", "coverage"], ["error", "durations"]]
    with _plots.mosaic(layout, size=(11.0, 8.2)) as (fig, axes):
        colours = _plots.colours_for(len(view.growths))
        _draw_series(axes["series"], view, colours)
        _draw_coverage(axes["coverage"], view)
        _draw_errors(axes["error"], view, colours)
        _draw_durations(axes["durations"], view)
        store.picture("foam_in_time", fig)


def _draw_series(axes: Axes, view: View, colours: Any) -> None:
    config, calibration = view.config, view.calibration
    for i, (growth, colour) in enumerate(zip(view.growths, colours, strict=True)):
        time = config.step * np.arange(1, growth.series.shape[1] + 1)
        for kind, width in (("total", 1.6), ("active", 1.0)):
            seas = growth.column(f"{kind}_projected")
            axes.plot(time, _positive(seas.mean(axis=0)), color=colour, linewidth=width)
            low, high = _positive(seas.min(axis=0)), _positive(seas.max(axis=0))
            axes.fill_between(time, low, high, color=colour, alpha=0.15, linewidth=0)
        total = calibration.closed["renewal", "projected"][i, calibration.place]
        style: Any = {"color": colour, "linestyle": (0, (4, 2)), "linewidth": 1.0}
        start = growth.spin * config.step
        axes.plot([start, time[-1]], [total, total], **style)
        axes.plot([start, time[-1]], [calibration.points.projected[i]] * 2, **style)
        axes.annotate(
            f"{config.wind.speed[i]:g} m/s",
            (time[-1], total),
            xytext=(4, 0),
            textcoords="offset points",
            color=colour,
            va="center",
            fontsize=9,
        )
    start = view.growths[0].spin * config.step
    axes.axvspan(0, start, color="#F1F1F1", zorder=0)
    axes.annotate(
        "spin-up",
        (0.5 * start, 1),
        xycoords=("data", "axes fraction"),
        va="top",
        ha="center",
        color=_plots.GREY,
    )
    axes.set(yscale="log", xlabel="time t (s)", ylabel="coverage W, projected area (-)", xlim=(0, None))
    low = min(g.column("active_projected")[:, g.spin :].mean() for g in view.growths)
    axes.set_ylim(bottom=max(0.05 * low, 1e-8))
    dark: Any = {"color": _plots.BLACK}
    handles = [
        Line2D([], [], label=f"mean of {config.seas} seas on the tile", **dark),
        Patch(alpha=0.15, linewidth=0, label="their range", **dark),
        Line2D([], [], linestyle=(0, (4, 2)), linewidth=1, label="without a tile", **dark),
    ]
    axes.legend(handles=handles, loc="lower right", ncols=3, fontsize=8.5, columnspacing=1.0)
    axes.set_title("(a) Total (above) and active (below) coverage in time")


def _positive(values: np.ndarray) -> np.ndarray:
    return np.where(values > 0, values, np.nan)


def _draw_coverage(axes: Axes, view: View) -> None:
    calibration, speeds = view.calibration, np.asarray(view.config.wind.speed)
    active, total = (view.mean(f"{kind}_projected") for kind in ("active", "total"))
    at = calibration.place
    law: Any = {"color": _plots.GREY, "linewidth": 3.5, "alpha": 0.45, "solid_capstyle": "round"}
    axes.plot(speeds, calibration.total_law, **law)
    axes.plot(speeds, calibration.active_law, **law)
    axes.plot(speeds, calibration.closed["renewal", "projected"][:, at], color=_plots.BLUE)
    axes.plot(
        speeds, calibration.closed["poisson", "projected"][:, at], "--", color=_plots.SKY, linewidth=1.3
    )
    axes.plot(speeds, calibration.points.projected, color=_plots.VERMILION)
    axes.errorbar(speeds, total[0], 2 * total[1], fmt="o", color=_plots.BLUE, markersize=5, **BARS)
    axes.errorbar(speeds, active[0], 2 * active[1], fmt="s", color=_plots.VERMILION, markersize=5, **BARS)
    axes.set(yscale="log", xlabel="wind U10 (m/s)", ylabel="coverage W, projected area (-)")
    lowest = min(calibration.active_law.min(), calibration.points.projected.min(), active[0].min())
    axes.set_ylim(0.12 * lowest, 3 * max(calibration.total_law.max(), total[0].max()))
    tau = calibration.used[1]
    names = [_build.law(name).name for name in (view.config.total_law, view.config.active_law)]
    handles = [
        Line2D(
            [],
            [],
            color=_plots.BLUE,
            marker="o",
            label=f"total, renewal foam, τ = {tau:.2f} s; tile ± 2 s.e.",
        ),
        Line2D([], [], color=_plots.SKY, linestyle="--", linewidth=1.3, label="total, Poisson foam"),
        Line2D([], [], color=_plots.VERMILION, marker="s", label="active, exact closure; tile ± 2 s.e."),
        Line2D([], [], label=f"laws: {names[0]}\nand {names[1]}", **law),
    ]
    axes.legend(handles=handles, loc="lower right", fontsize=8.5)
    axes.set_title("(b) From active to total coverage")


def _draw_errors(axes: Axes, view: View, colours: Any) -> None:
    calibration = view.calibration
    axes.axhline(0, color=_plots.BLACK, linewidth=1)
    shift = np.linspace(-0.06, 0.06, len(view.growths))
    for closure, style in (("poisson", {"fmt": "o", **OPEN}), ("renewal", {"fmt": "o"})):
        mean, error = 100 * view.closure_error(closure)
        for i, colour in enumerate(colours):
            x = calibration.decay_times * np.exp(shift[i])
            axes.errorbar(x, mean[i], 2 * error[i], color=colour, markersize=5.5, **style, **BARS)
    axes.set(xscale="log", xlabel="decay time of the foam τ (s)", ylabel="closed form over tile − 1 (%)")
    axes.set_xticks(calibration.decay_times, [f"{tau:.3g}" for tau in calibration.decay_times])
    axes.set_xticks([], minor=True)
    dark: Any = {"color": _plots.BLACK, "linestyle": "", "marker": "o"}
    winds = [
        Line2D([], [], color=colour, marker="o", linestyle="", label=f"{speed:g} m/s")
        for speed, colour in zip(view.config.wind.speed, colours, strict=True)
    ]
    ways = [
        Line2D([], [], label="renewal foam", **dark),
        Line2D([], [], label="Poisson foam", **dark, **OPEN),
    ]
    axes.legend(handles=[*ways, *winds], ncols=2, loc="best")
    axes.set_title("(c) Error without a tile, ± 2 standard errors")


def _draw_durations(axes: Axes, view: View) -> None:
    config, calibration = view.config, view.calibration
    speeds = np.asarray(config.wind.speed)
    axes.axhspan(*CALLAGHAN, color="#E7EEF4", zorder=0)
    axes.axhline(MONAHAN, color=_plots.BLUE, linewidth=1, linestyle=":")
    axes.plot(speeds, calibration.own_decay_time, "D", color=_plots.BLUE, markersize=5)
    axes.axhline(calibration.used[1], color=_plots.BLUE, linewidth=1.4)
    for shortest, style in ((config.events.shortest, {}), (0.0, OPEN)):
        mean, error = np.array([growth.events.mean(shortest) for growth in view.growths]).T
        axes.errorbar(
            speeds, mean, 2 * error, fmt="o", color=_plots.VERMILION, markersize=5.5, **style, **BARS
        )
    axes.plot(speeds, calibration.points.duration, color=_plots.ORANGE)
    tile = view.mean("active_rest")[0] / view.mean("birth_rate")[0]
    axes.plot(speeds, tile, "s", color=_plots.ORANGE, markersize=5)
    if view.measured is not None:
        wind, mean, error = view.measured.by_wind()
        axes.errorbar(wind, mean, 2 * error, fmt="^", color=_plots.BLACK, markersize=6, **BARS)
    axes.set(yscale="log", xlabel="wind U10 (m/s)", ylabel="time (s)", ylim=(0.1, 40))
    axes.set_yticks([0.1, 0.2, 0.5, 1, 2, 5, 10], ["0.1", "0.2", "0.5", "1", "2", "5", "10"])
    axes.set_yticks([], minor=True)
    handles: list[Any] = [
        Line2D([], [], color=_plots.BLUE, marker="D"),
        (Patch(color="#E7EEF4"), Line2D([], [], color=_plots.BLUE, linewidth=1, linestyle=":")),
        Line2D([], [], color=_plots.BLACK, marker="^", linestyle=""),
        Line2D([], [], color=_plots.VERMILION, marker="o", linestyle=""),
        Line2D([], [], color=_plots.ORANGE, marker="s"),
    ]
    labels = [
        "foam decays: τ for all winds and for each",
        f"τ measured: Callaghan's {CALLAGHAN[0]:g} to {CALLAGHAN[1]:g} s, Monahan's {MONAHAN:g} s",
        "a breaker lasts: measured",
        f"on the tile (those of ≥ {config.events.shortest:.2g} s; open: all)",
        "a point breaks: W/ν; tile",
    ]
    kept = [i for i in range(len(handles)) if i != 2 or view.measured is not None]
    axes.legend([handles[i] for i in kept], [labels[i] for i in kept], loc="upper left", fontsize=8.5)
    axes.set_title("(d) How long breakers and foam last")
