"""The picture, the data and the words of `coverage`."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter

from .. import schema
from ..common import _plots
from ..common._words import low_pass
from ..harness._files import Files, variable
from ..harness._quantity import Quantity

LOWEST = 1e-10
"""Coverage below is not drawn."""

STYLES: dict[str, tuple[str, str, str]] = {
    "exact_rest": ("exact, rest area", _plots.BLUE, "--"),
    "exact_projected": ("exact, projected area", _plots.BLUE, "-"),
    "gaussian_rest": ("Gaussian, rest area", _plots.VERMILION, "--"),
    "gaussian_projected": ("Gaussian, projected area", _plots.VERMILION, "-"),
    "published": ("published, rest area", _plots.BLACK, ":"),
}


class Curves(NamedTuple):
    """log W of each closure against the threshold ε."""

    threshold: Any
    log_coverage: dict[str, Any]


def plot(store: Files, curves: Curves, numbers: Mapping[str, float], config: schema.CoverageConfig) -> None:
    """`coverage.png`: W against ε, and how far the Gaussian closure is from the exact one."""
    with _plots.figure(1, 2, size=(10.0, 4.6), width_ratios=(1.35, 1)) as (fig, (left, right)):
        _plot_coverage(left, curves, numbers, config)
        _plot_ratios(right, curves, numbers, config)
        fig.suptitle(_title(numbers, config), fontsize=11, x=0.01, ha="left")
        store.picture("coverage", fig)


def _plot_coverage(axes: Axes, curves: Curves, numbers: Mapping[str, float], config: Any) -> None:
    for name, (label, colour, line) in STYLES.items():
        log = curves.log_coverage[name]
        undefined = bool(np.all(np.isnan(log)))
        drawn = np.where(log > np.log(0.01 * LOWEST), log, np.nan)
        width = 2.4 if name == "published" else 1.8
        axes.plot(
            curves.threshold,
            np.exp(drawn),
            linestyle="none" if undefined else line,
            color=colour,
            linewidth=width,
            label=f"{label}: undefined" if undefined else label,
        )
        value = numbers[f"coverage_{name}"]
        if value > LOWEST:
            axes.plot([config.threshold], [value], "o", color=colour, markersize=5, zorder=4)
    _mark(axes, config.threshold)
    axes.set(yscale="log", ylim=(LOWEST, 1), xlabel="breaking threshold ε (-)", title="(a) Coverage")
    axes.set(ylabel="whitecap coverage W (-)", xlim=_informative(curves, "gaussian_rest", config.threshold))
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.legend(loc="best")


def _plot_ratios(axes: Axes, curves: Curves, numbers: Mapping[str, float], config: Any) -> None:
    """Only where the exact coverage is on the left picture."""
    shown = curves.log_coverage["exact_rest"] > np.log(LOWEST)
    x = curves.threshold
    for area, line in (("projected", "-"), ("rest", "--")):
        log = curves.log_coverage[f"gaussian_{area}"] - curves.log_coverage[f"exact_{area}"]
        ratio = np.where(shown & np.isfinite(log), np.exp(np.minimum(log, 12.0)), np.nan)
        axes.plot(x, ratio, line, color=_plots.VERMILION, label=f"Gaussian / exact, {area}")
    log = curves.log_coverage["exact_projected"] - curves.log_coverage["exact_rest"]
    ratio = np.where(shown & np.isfinite(log), np.exp(log), np.nan)
    axes.plot(x, ratio, color=_plots.BLUE, label="projected / rest, exact")
    axes.axhline(1, color=_plots.BLACK, linewidth=1, zorder=1)
    _mark(axes, config.threshold)
    axes.set(yscale="log", ylim=(0.05, 1e3), title="(b) Ratios of coverages")
    axes.set(xlabel="breaking threshold ε (-)", ylabel="ratio (-)")
    axes.set(xlim=_informative(curves, "exact_rest", config.threshold))
    axes.legend(loc="upper right")


def _informative(curves: Curves, name: str, threshold: float) -> tuple[float, float]:
    """From where this coverage comes into the picture, or the threshold, to 1."""
    x = curves.threshold
    visible = x[np.asarray(curves.log_coverage[name]) > np.log(LOWEST)]
    first = min(visible[0] if visible.size else x[-2], threshold)
    return float(first - 0.03 * (x[-1] - first)), float(x[-1])


def _mark(axes: Axes, threshold: float) -> None:
    axes.axvline(threshold, color=_plots.GREY, linewidth=1, zorder=1)
    axes.annotate(
        f"ε = {threshold:g}",
        (threshold, 0.03),
        xycoords=("data", "axes fraction"),
        xytext=(4, 0),
        textcoords="offset points",
        color=_plots.GREY,
        fontsize=9,
    )


def _title(numbers: Mapping[str, float], config: schema.CoverageConfig) -> str:
    swell = config.spectrum.swell
    beside = "" if swell is None else f" and swell of {swell.significant_wave_height:g} m"
    return (
        f"{config.spectrum.family.replace('_', '-').title()}{beside}, U10 = {config.wind.speed:g} m/s, "
        f"Hs = {numbers['significant_wave_height']:.3g} m, λ = {_choppiness(config)}, "
        f"{low_pass(config.breaking_wavenumber)}"
    )


def _choppiness(config: schema.CoverageConfig) -> str:
    values = config.choppiness if isinstance(config.choppiness, tuple) else (config.choppiness,)
    return ", ".join(f"{value:g}" for value in values)


def answer(numbers: Mapping[str, float], config: schema.CoverageConfig) -> str:
    """The coverage of this sea in one sentence."""
    rest, projected = numbers["coverage_exact_rest"], numbers["coverage_exact_projected"]
    gaussian = numbers["coverage_gaussian_projected"]
    sentence = (
        f"Whitecaps cover {100 * projected:.3g} % of this sea as seen from above, and {100 * rest:.3g} % of its "
        f"plane at rest, at ε = {config.threshold:g}"
    )
    if not projected > 0:
        return sentence + "."
    return sentence + f"; a Gaussian Jacobian would give {gaussian / projected:.3g} times the former."


def report(numbers: Mapping[str, float], config: schema.CoverageConfig, notes: tuple[str, ...] | Any) -> str:
    """`report.md`."""
    published = numbers["coverage_published"]
    rows = [
        ("exact", numbers["coverage_exact_projected"], f"{numbers['coverage_exact_rest']:.4g}"),
        ("Gaussian", numbers["coverage_gaussian_projected"], f"{numbers['coverage_gaussian_rest']:.4g}"),
    ]
    table = "\n".join(f"| {name} | {projected:.4g} | {rest} |" for name, projected, rest in rows)
    last = f"{published:.4g}" if published >= 0 else "undefined"
    listed = "\n".join(f"- {note}" for note in notes[1:])
    return f"""# Whitecap coverage of one sea

{notes[0]}

The sea: {_title(numbers, config)}. The variance of its Jacobian is {numbers["jacobian_variance"]:.4g} and its
skewness {numbers["jacobian_skewness"]:+.3g}; the mean-square slope of the waves that count is \
{numbers["mean_square_slope"]:.4g}.

| closure | projected area | rest area |
|---|---|---|
{table}
| published | rest area only | {last} |

![coverage](coverage.png)

{listed}"""


def save(
    store: Files,
    curves: Curves,
    numbers: Mapping[str, float],
    config: schema.CoverageConfig,
    quantities: Mapping[str, Quantity],
) -> None:
    """`coverage.nc`: the curves, and the numbers of the sea."""
    variables = {
        f"log_coverage_{name}": variable(
            "threshold",
            np.where(np.isfinite(log), log, np.nan),
            units="1",
            long_name=f"natural logarithm of the {quantities[f'coverage_{name}'].long_name}",
        )
        for name, log in curves.log_coverage.items()
    }
    for name, quantity in quantities.items():
        if not name.startswith("coverage_"):
            variables[name] = variable(
                "",
                numbers[name],
                units=quantity.units,
                long_name=quantity.long_name,
                standard_name=quantity.standard_name,
            )
    store.data(
        "coverage",
        variables,
        {
            "threshold": variable(
                "threshold", curves.threshold, units="1", long_name="breaking threshold epsilon"
            )
        },
        title="Whitecap coverage of one sea against the breaking threshold, in closed form",
        attributes={
            "wind_speed_m_per_s": config.wind.speed,
            "spectrum": config.spectrum.family,
            "choppiness": np.atleast_1d(config.choppiness),
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
        },
    )
