"""What `gaussian_vs_monte_carlo` found, in numbers and in words."""

import numpy as np

from .. import schema
from ..common import _build, _markdown
from ..common._words import low_pass
from ..harness._files import Files
from ..harness._result import Result, Table
from ._gaussian_views import Comparison

SHOWN = (0.3, 0.5, 0.7)
"""The table has the thresholds nearest to these."""


def report(store: Files, seas: list[Comparison], config: schema.GaussianVsMonteCarloConfig) -> Result:
    """Result, tables and the answer in words, and `report.md`."""
    verdicts = {
        ("exact", "monte_carlo"): _verdict(seas, config, "exact", "monte_carlo"),
        ("gaussian", "monte_carlo"): _verdict(seas, config, "gaussian", "monte_carlo"),
        ("exact", "fft"): _verdict(seas, config, "exact", "fft"),
        ("gaussian", "fft"): _verdict(seas, config, "gaussian", "fft"),
    }
    tables = (_ratio_table(seas, config), _coverage_table(seas, config), _verdict_table(verdicts, config))
    notes = _notes(seas, verdicts, config)
    limit = low_pass(config.breaking_wavenumber)
    setting = (
        f"{config.measure} area, λ = {np.array2string(np.asarray(config.choppiness))}, {limit}, "
        f"{seas[0].draws.total:,} draws and {config.realisations} FFT seas at each wind"
    )
    text = _markdown.page("Is the Jacobian Gaussian?", notes, tables, picture="coverage", setting=setting)
    store.text("report.md", text + "\n\n![densities of j](densities.png)")
    return Result(
        values={
            "measure": config.measure,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
            "draws": seas[0].draws.total,
            "realisations": config.realisations,
            "confidence": config.confidence,
            "thresholds": config.thresholds,
            "seas": [_values(sea, config) for sea in seas],
            "agreement": {f"{closure}_with_{counted}": v for (closure, counted), v in verdicts.items()},
        },
        tables=tables,
        notes=notes,
    )


def _values(sea: Comparison, config: schema.GaussianVsMonteCarloConfig) -> dict:
    lower, upper = sea.draws.interval(config.confidence)
    return {
        "wind_speed_m_per_s": sea.speed,
        "jacobian_variance": sea.closed.variance,
        "jacobian_variance_monte_carlo": sea.draws.variance,
        "skewness": sea.closed.skewness,
        "skewness_monte_carlo": sea.draws.skewness,
        "exact": sea.closed.at.exact,
        "gaussian": sea.closed.at.gaussian,
        "gaussian_over_exact": sea.closed.at.ratio,
        "published_is_defined": sea.published_is_defined and config.measure == "rest",
        "published_variance": sea.closed.published_variance,
        "published": sea.closed.at.published if config.measure == "rest" else None,
        "monte_carlo": sea.draws.counted.mean,
        "monte_carlo_interval": [lower, upper],
        "fft": sea.realised.mean,
        "fft_standard_error": sea.realised.error,
    }


def _verdict(seas: list[Comparison], config, closure: str, counted: str) -> dict:
    """In how many cases a closure lies where the counts allow it, and the worst case."""
    cases = []
    for sea in seas:
        expected = getattr(sea.closed.at, closure)
        if counted == "monte_carlo":
            lower, upper = sea.draws.interval(config.confidence)
            usable, deviation = sea.drawn, sea.draws.deviation(expected)
            agrees = (lower <= expected) & (expected <= upper)
        else:
            usable, deviation = sea.seen, sea.realised.deviation(expected)
            agrees = np.abs(deviation) <= 3
        cases += [
            (sea.speed, *case)
            for case, use in zip(zip(config.thresholds, deviation, agrees, strict=True), usable, strict=True)
            if use
        ]
    if not cases:
        return {"cases": 0, "agreeing": 0, "worst": None}
    speed, threshold, deviation, _ = max(cases, key=lambda case: abs(case[2]))
    return {
        "cases": len(cases),
        "agreeing": sum(bool(case[3]) for case in cases),
        "worst": {
            "wind_speed_m_per_s": speed,
            "threshold": threshold,
            "standard_errors": float(deviation),
        },
    }


def _shown(config: schema.GaussianVsMonteCarloConfig) -> list[int]:
    """Places of the thresholds that the table shows."""
    thresholds = np.asarray(config.thresholds)
    return sorted({int(np.argmin(np.abs(thresholds - wanted))) for wanted in SHOWN})


def _middle(config: schema.GaussianVsMonteCarloConfig) -> int:
    return int(np.argmin(np.abs(np.asarray(config.thresholds) - SHOWN[1])))


def _ratio_table(seas: list[Comparison], config: schema.GaussianVsMonteCarloConfig) -> Table:
    shown = _shown(config)
    columns = (
        "U10 (m/s)",
        "Var j (-)",
        "skewness",
        "counted",
        *(f"ε = {config.thresholds[i]:g}" for i in shown),
    )
    rows = [
        (
            sea.speed,
            float(sea.closed.variance),
            float(sea.closed.skewness),
            sea.draws.skewness,
            *(float(sea.closed.at.ratio[i]) for i in shown),
        )
        for sea in seas
    ]
    return Table(f"Skewness of j, and Gaussian over exact coverage, {config.measure} area", columns, rows)


def _coverage_table(seas: list[Comparison], config: schema.GaussianVsMonteCarloConfig) -> Table:
    i = _middle(config)
    limit = low_pass(config.breaking_wavenumber)
    rows = []
    for sea in seas:
        lower, upper = sea.draws.interval(config.confidence)
        at, published = sea.closed.at, "rest area only"
        if config.measure == "rest":
            published = f"{at.published[i]:.4g}" if sea.published_is_defined else "undefined"
        rows.append(
            (
                sea.speed,
                float(at.exact[i]),
                f"{lower[i]:.4g} to {upper[i]:.4g}",
                f"{sea.realised.mean[i]:.4g} ± {sea.realised.error[i]:.2g}",
                float(at.gaussian[i]),
                published,
            )
        )
    columns = ("U10 (m/s)", "exact", "Monte Carlo", "FFT seas", "Gaussian", "published")
    return Table(f"Coverage W at ε = {config.thresholds[i]:g}, {config.measure} area, {limit}", columns, rows)


def _verdict_table(verdicts: dict, config: schema.GaussianVsMonteCarloConfig) -> Table:
    names = {
        "monte_carlo": f"Monte Carlo, {100 * config.confidence:g} % interval",
        "fft": f"{config.realisations} FFT seas, 3 standard errors",
    }
    rows = []
    for (closure, counted), verdict in verdicts.items():
        worst = verdict["worst"]
        where = _place(worst["wind_speed_m_per_s"], worst["threshold"]) if worst else "-"
        rows.append(
            (
                closure.replace("gaussian", "Gaussian"),
                names[counted],
                f"{verdict['agreeing']} of {verdict['cases']}",
                float(worst["standard_errors"]) if worst else float("nan"),
                where,
            )
        )
    return Table("Agreement", ("closure", "against", "inside", "worst (std errors)", "where"), rows)


def _notes(seas: list[Comparison], verdicts: dict, config: schema.GaussianVsMonteCarloConfig) -> list[str]:
    """The answer in words."""
    first, last = seas[0], seas[-1]
    skewness = f"{float(first.closed.skewness):+.2f} at U10 = {first.speed:g} m/s"
    if len(seas) > 1:
        skewness += f", {float(last.closed.skewness):+.2f} at {last.speed:g} m/s"
    gaussian = verdicts["gaussian", "monte_carlo"]
    answer = (
        "The draws cannot tell the Jacobian from a Gaussian one"
        if gaussian["agreeing"] == gaussian["cases"]
        else "The Jacobian is not Gaussian"
    )
    notes = [f"{answer}: its skewness is {skewness} (0 if it were)."]
    i = _middle(config)
    listed = ", ".join(f"{factor(float(sea.closed.at.ratio[i]))} at {sea.speed:g} m/s" for sea in seas)
    notes.append(f"At ε = {config.thresholds[i]:g} the Gaussian formula is {listed}.")
    counted = [
        (float(sea.closed.at.ratio[i]), sea.speed, config.thresholds[i])
        for sea in seas
        for i in np.nonzero(sea.drawn)[0]
    ]
    if counted:
        (high, *above), (low, *below) = max(counted), min(counted)
        words = f"Where draws can tell, it is worst {_place(*above)}: {factor(high)}"
        notes.append(words + (f"; and {_place(*below)} it is {factor(low)}." if low < 1 else "."))
    exact = verdicts["exact", "monte_carlo"]
    notes.append(
        f"The exact closure lies inside the {100 * config.confidence:g} % interval of {seas[0].draws.total:,} "
        f"draws in {exact['agreeing']} of {exact['cases']} cases; chance alone puts about "
        f"{(1 - config.confidence) * exact['cases']:.1g} of them outside."
    )
    notes.append(_published_note(seas, config))
    notes += _build.outside_validity(config.spectrum, config.wind)
    return notes + _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)


def _published_note(seas: list[Comparison], config: schema.GaussianVsMonteCarloConfig) -> str:
    if config.measure != "rest":
        return "The published formula counts rest area only: it is left out (measure=rest shows it)."
    undefined = [sea for sea in seas if not sea.published_is_defined]
    if not undefined:
        return "The published formula (eqs 6-8 as printed) is defined here."
    variances = ", ".join(
        f"{float(sea.closed.published_variance):.2f} at {sea.speed:g} m/s" for sea in undefined
    )
    return (
        f"The published formula (eqs 6-8 as printed) is undefined: its variance is negative ({variances}), as for "
        "any ordinary sea of more than one pattern."
    )


def _place(speed: float, threshold: float) -> str:
    return f"at U10 = {speed:g} m/s, ε = {threshold:g}"


def factor(ratio: float) -> str:
    """A ratio in words."""
    if not np.isfinite(ratio):
        return "without limit too high"
    return (
        f"{ratio:.3g} times too high"
        if ratio >= 1.5
        else (f"{100 * (ratio - 1):.2g} % too high" if ratio >= 1 else f"{100 * (1 - ratio):.2g} % too low")
    )
