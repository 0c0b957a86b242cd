"""Picture and data of `calibration_uncertainty`."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse

import fitting

from .. import schema
from ..common import _calibrated_sea, _plots
from ..harness._files import Files, variable

SYMBOLS = {"threshold": "ε", "choppiness": "λ", "scatter": "σ"}
COLOURS = {"prior": _plots.BLUE, "weak": _plots.VERMILION, "none": _plots.BLACK, "scatter": _plots.GREEN}
METHODS = {"laplace": "fit ± error", "profile": "profile", "posterior": "posterior"}
MARKS = {"laplace": "o", "profile": "s"}
LEVELS = (0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
"""Levels of confidence at which intervals are counted."""

SHOWN = 2000
"""Draws in a cloud, at most."""

HIGHEST = 9.0
"""2Δcost above which profiles are not drawn."""


@dataclass(frozen=True)
class View:
    """What is to be shown.

    - `posteriors`: "prior", "weak" (prior), and "scatter", with σ free; `profiles`: "prior", "weak" and "none", of
      each parameter; `repeated`: fits of synthetic data.
    """

    config: schema.UncertaintyConfig
    posteriors: Mapping[str, fitting.Posterior]
    profiles: Mapping[str, Mapping[str, fitting.Profile]]
    repeated: fitting.CoverageProbability

    @property
    def names(self) -> dict[str, str]:
        """What the cases are called."""
        prior = self.config.choppiness_prior
        return {
            "prior": f"λ = {prior.mean:g} ± {prior.deviation:g}",
            "weak": f"λ = {prior.mean:g} ± {self.config.weak_deviation:g}",
            "none": "no prior on λ",
            "scatter": f"λ = {prior.mean:g} ± {prior.deviation:g}, σ free",
        }


def plot(store: Files, view: View) -> None:
    """`calibration_uncertainty.png`: two posteriors, error ratios, two profiles, and how often intervals are right."""
    layout = [["strong", "weak", "ratio"], ["threshold", "choppiness", "hits"]]
    with _plots.mosaic(layout, size=(13.0, 8.8)) as (fig, axes):
        _plot_cloud(axes["strong"], view, "prior", "(a) Posterior")
        _plot_cloud(axes["weak"], view, "weak", "(b) Posterior, weak prior")
        _plot_ratios(axes["ratio"], view)
        _plot_profile(axes["threshold"], view, "threshold", "(d) Profile of ε")
        _plot_profile(axes["choppiness"], view, "choppiness", "(e) Profile of λ")
        _plot_hits(axes["hits"], view)
        lines = [
            *(
                Line2D([], [], color=COLOURS[kind], label=view.names[kind])
                for kind in ("prior", "weak", "none")
            ),
            Line2D([], [], ls=":", lw=1.3, color=_plots.BLACK, label="as the fit's errors say"),
        ]
        fig.legend(handles=lines, loc="outside lower left", ncols=4, title="(d), (e)", title_fontsize=9)
        store.picture("calibration_uncertainty", fig)


def _plot_cloud(axes: Axes, view: View, kind: str, title: str) -> None:
    """Draws of (ε, λ), the fit's ellipses over them, and both marginals."""
    posterior, colour = view.posteriors[kind], COLOURS[kind]
    x, y = posterior.values["threshold"].ravel(), posterior.values["choppiness"].ravel()
    chosen = np.linspace(0, x.size - 1, min(SHOWN, x.size)).astype(int)
    axes.scatter(x[chosen], y[chosen], s=3, color=colour, alpha=0.35, lw=0, rasterized=True)
    for level, style in ((0.5, "--"), (view.config.level, "-")):
        axes.add_patch(_ellipse(posterior.fit, level, style))
    fit = posterior.fit
    axes.plot(fit.values["threshold"], fit.values["choppiness"], "+", color=_plots.BLACK, ms=9, mew=1.6)
    percent = f"{100 * view.config.level:g} %"
    axes.legend(
        handles=[
            Line2D(
                [], [], marker="o", ls="", ms=3, color=colour, label=f"{x.size:,} draws, {view.names[kind]}"
            ),
            Line2D([], [], color=_plots.BLACK, lw=1.3, label=f"fit, 50 % and {percent}"),
        ],
        loc="lower left",
    )
    box: Any = axes.inset_axes
    _marginal(box((0, 1.0, 1, 0.16), sharex=axes), x, fit, "threshold", colour, upright=True)
    _marginal(box((1.0, 0, 0.16, 1), sharey=axes), y, fit, "choppiness", colour, upright=False)
    axes.set(xlabel="breaking threshold ε (-)", ylabel="choppiness λ (-)")
    for one, values, name in ((axes.set_xlim, x, "threshold"), (axes.set_ylim, y, "choppiness")):
        reach = 3.2 * float(fit.errors[name])
        centre = float(fit.values[name])
        low, high = np.quantile(values, [0.0005, 0.9995])
        one(min(low, centre - reach), max(high, centre + reach))
    axes.text(0, 1.2, title, transform=axes.transAxes, fontweight="bold", fontsize=11)


def _ellipse(fit: fitting.Fit, level: float, style: str) -> Ellipse:
    """Where a Gaussian of the fit's covariance holds this share."""
    covariance = fit.covariance[:2, :2]
    variances, axes = np.linalg.eigh(covariance)
    # χ² with two degrees of freedom has the quantile −2 ln(1 − p).
    width, height = 2 * np.sqrt(-2 * np.log(1 - level) * variances)
    angle = float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0])))
    centre = (float(fit.values["threshold"]), float(fit.values["choppiness"]))
    return Ellipse(centre, width, height, angle=angle, fill=False, lw=1.3, ls=style, color=_plots.BLACK)


def _marginal(
    axes: Axes, draws: np.ndarray, fit: fitting.Fit, name: str, colour: str, *, upright: bool
) -> None:
    counts, edges = np.histogram(draws, bins=50, density=True)
    value, error = float(fit.values[name]), float(fit.errors[name])
    at = np.linspace(value - 4 * error, value + 4 * error, 200)
    normal = np.exp(-0.5 * ((at - value) / error) ** 2) / (error * np.sqrt(2 * np.pi))
    centres = 0.5 * (edges[1:] + edges[:-1])
    if upright:
        axes.fill_between(centres, counts, color=colour, alpha=0.4, lw=0, step="mid")
        axes.plot(at, normal, color=_plots.BLACK, lw=1.2)
    else:
        axes.fill_betweenx(centres, counts, color=colour, alpha=0.4, lw=0, step="mid")
        axes.plot(normal, at, color=_plots.BLACK, lw=1.2)
    axes.axis("off")


def _plot_ratios(axes: Axes, view: View) -> None:
    """Deviation of the draws over the fit's error, for each number of each case."""
    rows = [
        (kind, check) for kind in ("prior", "scatter", "weak") for check in view.posteriors[kind].laplace()
    ]
    for place, (kind, check) in enumerate(reversed(rows)):
        size = view.posteriors[kind].effective_size[view.posteriors[kind].labels.index(check.label)]
        axes.errorbar(
            check.ratio,
            place,
            xerr=2 * check.ratio / np.sqrt(2 * size),
            fmt="o",
            color=COLOURS[kind],
            capsize=3,
        )
    axes.axvline(1, color=_plots.BLACK, lw=1)
    axes.set_yticks(range(len(rows)), [SYMBOLS[check.label] for _, check in reversed(rows)])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    handles = [
        Line2D([], [], marker="o", ls="", color=COLOURS[kind], label=view.names[kind])
        for kind in ("prior", "scatter", "weak")
    ]
    axes.legend(handles=handles, loc="lower right")
    reach = max(0.35, *(abs(check.ratio - 1) * 1.25 for _, check in rows))
    axes.set_xlim(1 - reach, 1 + reach)
    axes.set(xlabel="deviation of the draws / error of the fit", title="(c) Are the fit's errors right?")
    axes.grid(axis="y", visible=False)


def _plot_profile(axes: Axes, view: View, name: str, title: str) -> None:
    for kind in ("none", "weak", "prior"):
        found = view.profiles[kind][name]
        axes.plot(found.grid, found.excess, color=COLOURS[kind], label=view.names[kind])
        if found.fit is not None and kind != "none":
            pull = (found.grid - found.fit.values[name]) / found.fit.errors[name]
            axes.plot(found.grid, pull**2, ":", color=COLOURS[kind], lw=1.3)
    limit = fitting.profile_limit(view.config.level)
    axes.axhline(limit, color=_plots.GREY, lw=1)
    percent = f"{100 * view.config.level:g} %"
    x, side = (0.01, "left") if name == "threshold" else (0.99, "right")
    axes.text(x, limit + 0.12, percent, color=_plots.GREY, ha=side, transform=axes.get_yaxis_transform())
    unit = "breaking threshold ε (-)" if name == "threshold" else "choppiness λ (-)"
    axes.set(ylim=(0, HIGHEST), xlabel=unit, ylabel="2 Δcost = −2 Δ log likelihood", title=title)
    shown = [g for kind in ("prior", "weak") for g in view.profiles[kind][name].grid]
    low, high = min(shown), max(shown)
    axes.set_xlim(
        max(low, high - 2.5) if name == "threshold" else 0, min(high, 1.0) if name == "threshold" else 3
    )


def _plot_hits(axes: Axes, view: View) -> None:
    repeated = view.repeated
    levels = np.linspace(0.4, 1.0, 121)
    total = int(repeated.converged.sum())
    spread = 1.96 * np.sqrt(levels * (1 - levels) / total)
    axes.fill_between(
        levels, levels - spread, levels + spread, color="#E3E3E3", lw=0, label=f"chance (95 %), {total} sets"
    )
    axes.plot([0.4, 1], [0.4, 1], color=_plots.BLACK, lw=1)
    colours = {"threshold": _plots.BLUE, "choppiness": _plots.ORANGE}
    shift = {"threshold": -0.005, "choppiness": 0.005}
    for method, offset in (("laplace", -0.003), ("profile", 0.003)):
        for name in repeated.labels:
            values = [repeated.share(method, name, level).value for level in LEVELS]
            face = colours[name] if method == "laplace" else "none"
            x = np.asarray(LEVELS) + shift[name] + offset
            label = f"{SYMBOLS[name]}: {METHODS[method]}"
            axes.plot(x, values, MARKS[method], color=colours[name], ms=5, mfc=face, label=label)
    if len(repeated.ranks):
        for name in repeated.labels:
            # Few data sets: their own binomial interval says how little they say.
            share = repeated.share("posterior", name, view.config.level)
            bars = [[share.value - share.lower], [share.upper - share.value]]
            x = view.config.level + 4 * shift[name]
            label = f"{SYMBOLS[name]}: posterior, {share.total} sets"
            axes.errorbar(
                [x], [share.value], bars, fmt="^", color=colours[name], ms=6, capsize=3, lw=1.2, label=label
            )
    axes.set(xlim=(0.45, 1.0), ylim=(0.3, 1.02), xlabel="level of the intervals (-)")
    axes.set(ylabel="share that contains the truth (-)", title="(f) Do intervals keep their promise?")
    axes.legend(loc="lower right", fontsize=8)


def save(store: Files, view: View) -> None:
    """`posterior.nc`, `profiles.nc` and `coverage_probability.nc`."""
    attributes = _calibrated_sea.attributes(view.config) | {
        "law": view.config.law,
        "weak_prior_deviation": view.config.weak_deviation,
    }
    first = view.posteriors["prior"].draws
    places = {
        name: variable(name, np.arange(size), units="1", long_name=f"number of the {text}")
        for name, size, text in (("chain", first.shape[0], "Markov chain"), ("draw", first.shape[1], "draw"))
    }
    suffix = {"prior": "", "weak": "_weak_prior", "scatter": "_free_scatter", "none": "_no_prior"}
    draws = {
        f"{name}{suffix[kind]}": variable(
            ("chain", "draw"), values, units="1", long_name=f"draws of the {_word(name)}, {_case(kind)}"
        )
        for kind, posterior in view.posteriors.items()
        for name, values in posterior.values.items()
    }
    store.data("posterior", draws, places, title="Posterior draws of a calibration", attributes=attributes)
    excess, grids = {}, {}
    for kind, each in view.profiles.items():
        for name, found in each.items():
            axis = f"{name}{suffix[kind]}"
            grids[axis] = variable(axis, found.grid, units="1", long_name=f"{_word(name)}, {_case(kind)}")
            excess[f"excess_{axis}"] = variable(
                axis, found.excess, units="1", long_name=f"twice the cost above the least, {_case(kind)}"
            )
    store.data("profiles", excess, grids, title="Profile likelihoods of a calibration", attributes=attributes)
    repeated = view.repeated
    numbers = {}
    for i, name in enumerate(repeated.labels):
        for what, values, text in (
            ("truth", repeated.truths, "true"),
            ("fitted", repeated.values, "fitted"),
            ("error", repeated.errors, "standard error of the fitted"),
            ("signed_root", repeated.roots, "signed root of twice the profile's cost at the true"),
        ):
            numbers[f"{name}_{what}"] = variable(
                "data_set", values[:, i], units="1", long_name=f"{text} {_word(name)}"
            )
    sets = variable(
        "data_set", np.arange(len(repeated.truths)), units="1", long_name="number of the synthetic data set"
    )
    title = "Calibrations of synthetic data with known truth"
    store.data("coverage_probability", numbers, {"data_set": sets}, title=title, attributes=attributes)


def _word(name: str) -> str:
    return {
        "threshold": "breaking threshold",
        "choppiness": "choppiness",
        "scatter": "scatter of log10 coverage",
    }[name]


def _case(kind: str) -> str:
    return {
        "prior": "prior on the choppiness",
        "weak": "weak prior on the choppiness",
        "none": "no prior on the choppiness",
        "scatter": "prior on the choppiness, scatter free",
    }[kind]
