"""Picture and data of `law_ensemble`."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

import fitting

from .. import schema
from ..common import _calibrated_sea, _plots
from ..harness._files import Files, variable

STYLES = {"total": "-", "decaying": "--", "active": ":"}


COLOURS = (_plots.BLACK, _plots.ORANGE, _plots.GREEN, _plots.PURPLE, _plots.SKY, "#8C564B")
"""Of laws; the calibrated seas have the other two."""

MARKS = ("o", "s", "^", "D", "v", "P", "X", "*", "<", ">", "h", "d")
"""Marks of laws, in their order."""


@dataclass(frozen=True)
class View:
    """What is to be shown: all laws with λ free and with λ held, and those of whole foam with their band."""

    config: schema.LawEnsembleConfig
    free: fitting.Ensemble
    held: fitting.Ensemble
    whole: fitting.Ensemble
    band: fitting.Band

    @property
    def colours(self) -> list[Any]:
        """A colour for each law: neighbours in ε, whose curves are near each other too, differ most."""
        order = np.argsort(np.argsort(self.held.values("threshold")))
        return [COLOURS[i % len(COLOURS)] for i in order]


def plot(store: Files, view: View) -> None:
    """`law_ensemble.png`: the laws, the calibrated seas and their band; ε of each law; where the spread comes from."""
    layout = [["coverage", "threshold"], ["coverage", "spread"]]
    with _plots.mosaic(layout, size=(12.5, 7.0), width_ratios=(1.25, 1)) as (fig, axes):
        _plot_coverage(axes["coverage"], view)
        _plot_thresholds(axes["threshold"], view)
        _plot_spread(axes["spread"], view)
        for name in ("coverage", "spread"):
            axes[name].xaxis.set_major_locator(MaxNLocator(integer=True, steps=[1, 2, 5, 10]))
        store.picture("law_ensemble", fig)


def _plot_coverage(axes: Axes, view: View) -> None:
    speeds, band = view.free.speeds, view.band
    percent = f"{100 * band.level:g} %"
    axes.fill_between(
        speeds, band.lower, band.upper, color="#BFD9EA", lw=0, label=f"calibrated seas, {percent}"
    )
    axes.plot(speeds, band.median, color=_plots.BLUE, lw=2.6, label="calibrated seas, median")
    for i, (member, colour) in enumerate(zip(view.free.members, view.colours, strict=True)):
        style: Any = {"marker": MARKS[i % len(MARKS)], "ms": 7, "mec": "white", "mew": 0.5}
        # Marks at different places, so that they do not hide each other.
        axes.plot(
            speeds,
            member.law_coverage,
            STYLES[member.law.foam],
            color=colour,
            lw=1.3,
            markevery=(i % 4, 4),
            **style,
        )
        if member.law.foam == "active":
            axes.plot(speeds, member.coverage, color=_plots.VERMILION, lw=1.4, dashes=(6, 2))
    shown = {member.law.foam for member in view.free.members}
    names = {"total": "law: total foam", "decaying": "law: decaying foam", "active": "law: active breaking"}
    handles, _ = axes.get_legend_handles_labels()
    handles += [
        Line2D([], [], color=_plots.GREY, ls=STYLES[foam], lw=1.4, label=label)
        for foam, label in names.items()
        if foam in shown
    ]
    if "active" in shown:
        handles.append(
            Line2D([], [], color=_plots.VERMILION, lw=1.4, dashes=(6, 2), label="sea of active breaking")
        )
    axes.legend(
        handles=handles, loc="lower right", title="colours and marks of laws as in (b)", title_fontsize=9
    )
    low = min(view.config.least, *(float(np.min(m.coverage)) for m in view.whole.members))
    axes.set(yscale="log", ylim=(max(low, view.config.least) * 0.8, 0.5), xlabel="wind speed U10 (m/s)")
    axes.set(
        ylabel=f"whitecap coverage W, {view.config.measure} area (-)",
        title="(a) Laws, and seas that obey them",
    )


def _plot_thresholds(axes: Axes, view: View) -> None:
    order = np.argsort(view.held.values("threshold"))
    wide, narrow = view.free.errors("threshold"), view.held.errors("threshold")
    for place, i in enumerate(order):
        colour = view.colours[i]
        axes.errorbar(
            view.free.values("threshold")[i], place - 0.14, xerr=wide[i], fmt=MARKS[i % len(MARKS)],
            mfc="white", color=colour, ms=5, capsize=2, lw=1,
        )  # fmt: skip
        axes.errorbar(
            view.held.values("threshold")[i],
            place + 0.14,
            xerr=narrow[i],
            fmt=MARKS[i % len(MARKS)],
            color=colour,
            ms=5,
            capsize=2,
        )
    names = [short(view.held.members[i].law.name) for i in order]
    axes.set_yticks(range(len(names)), names, fontsize=8)
    prior = view.config.choppiness_prior
    dark: Any = {"color": _plots.BLACK, "ls": "", "ms": 4.5}
    axes.legend(
        handles=[
            Line2D([], [], marker="o", label=f"λ = {prior.mean:g}", **dark),
            Line2D(
                [],
                [],
                marker="o",
                mfc="white",
                label=f"λ = {prior.mean:g} ± {prior.deviation:g}, fitted",
                **dark,
            ),
        ],
        loc="upper left",
    )
    axes.set(xlabel="breaking threshold ε (-), ± standard error", title="(b) ε by law")
    axes.grid(axis="y", visible=False)


def _plot_spread(axes: Axes, view: View) -> None:
    speeds, band = view.whole.speeds, view.band
    logs = np.log10(np.stack([member.law_coverage for member in view.whole.members]))
    known = np.sum(np.isfinite(logs), axis=0) > 1
    spread = np.full(speeds.size, np.nan)
    spread[known] = np.nanstd(logs[:, known], axis=0, ddof=1)
    axes.plot(speeds, spread, "^-", color=_plots.GREY, ms=4, label="laws themselves, where in range")
    axes.plot(speeds, band.between, "o-", color=_plots.BLUE, ms=4, label="calibrated seas, law to law")
    axes.plot(speeds, band.within, "s--", color=_plots.ORANGE, ms=4, label="one calibration's own error")
    axes.set(
        xlabel="wind speed U10 (m/s)",
        ylabel="standard deviation of log10 W",
        title="(c) Where the spread is from",
    )
    axes.set_ylim(bottom=0)
    axes.legend()


def short(name: str) -> str:
    """The name of a law, cut to what tells laws apart."""
    return name.replace("O'Muircheartaigh", "O'M.").replace("least squares", "OLS")


def save(store: Files, view: View) -> None:
    """`law_ensemble.nc`."""
    names = [member.law.name for member in view.free.members]
    stack = np.stack
    by_law = {
        "coverage_law": (stack([m.law_coverage for m in view.free.members]), "whitecap coverage by the law"),
        "coverage_sea": (
            stack([m.coverage for m in view.free.members]),
            "whitecap coverage of the calibrated sea",
        ),
    }
    variables = {
        name: variable(("law", "wind_speed"), values, units="1", long_name=text)
        for name, (values, text) in by_law.items()
    }
    for kind, each in (("", view.free), ("_at_fixed_choppiness", view.held)):
        for name, text in (("threshold", "breaking threshold"), ("choppiness", "choppiness")):
            if kind and name == "choppiness":
                continue
            words = text + (", choppiness fixed" if kind else "")
            variables[f"{name}{kind}"] = variable("law", each.values(name), units="1", long_name=words)
            variables[f"{name}{kind}_error"] = variable(
                "law", each.errors(name), units="1", long_name=f"standard error of the {words}"
            )
    band = {
        "coverage_lower": (view.band.lower, "lower end of the band of coverage"),
        "coverage_median": (view.band.median, "median of the band of coverage"),
        "coverage_upper": (view.band.upper, "upper end of the band of coverage"),
        "spread_between": (view.band.between, "standard deviation of log10 coverage from law to law"),
        "spread_within": (
            view.band.within,
            "standard deviation of log10 coverage by the errors of one calibration",
        ),
    }
    variables |= {
        name: variable("wind_speed", values, units="1", long_name=text)
        for name, (values, text) in band.items()
    }
    store.data(
        "law_ensemble",
        variables,
        {
            "wind_speed": variable(
                "wind_speed",
                view.free.speeds,
                units="m s-1",
                long_name="wind speed at 10 m",
                standard_name="wind_speed",
            ),
            "law": variable("law", np.arange(len(names)), units="1", long_name="number of the whitecap law"),
        },
        title="One sea calibrated to several whitecap laws",
        attributes={
            **_calibrated_sea.attributes(view.config),
            "laws": "; ".join(
                f"{i}: {name} ({m.law.foam})"
                for i, (name, m) in enumerate(zip(names, view.free.members, strict=True))
            ),
            "band": f"{100 * view.band.level:g} per cent, laws of total and decaying foam",
        },
    )
