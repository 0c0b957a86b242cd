"""What `law_ensemble` says: tables, sentences, and the numbers for `result.json`."""

import numpy as np

import fitting

from ..common import _calibrated_sea, _markdown
from ..harness._files import Files
from ..harness._result import Result, Table
from ._ensemble_views import View, short

TITLE = "One sea, many whitecap laws"

SHOWN = 6
"""Winds in the table of the band, at most."""


def report(store: Files, view: View) -> Result:
    """Result, tables, and `report.md`."""
    tables = (_law_table(view), _band_table(view))
    answer = [_threshold_words(view), _coverage_words(view), _shape_words(view), *_active_words(view)]
    notes = [*answer, *view.free.skipped, *_fit_warnings(view), *_calibrated_sea.limits(view.config)]
    setting = (
        f"{_calibrated_sea.named(view.config)}; σ = {view.config.scatter:g} of log10 W at each of "
        f"{view.free.speeds.size} winds from {view.free.speeds[0]:g} to {view.free.speeds[-1]:g} m/s, each law in its "
        f"own range and where it gives W ≥ {view.config.least:g}; the prior of λ is "
        f"{view.config.choppiness_prior.mean:g} ± {view.config.choppiness_prior.deviation:g}"
    )
    text = _markdown.page(
        TITLE, [*answer, *view.free.skipped], tables, picture="law_ensemble", setting=setting
    )
    store.text("report.md", text)
    return Result(values=_values(view), tables=tables, notes=tuple(dict.fromkeys(notes)))


def _threshold_words(view: View) -> str:
    whole = view.held.only(
        [m.law.foam != "active" for m in view.held.members]
        if _mixed(view)
        else [True] * len(view.held.members)
    )
    epsilon, error = whole.values("threshold"), float(np.mean(whole.errors("threshold")))
    spread = float(np.std(epsilon, ddof=1)) if epsilon.size > 1 else 0.0
    low, high = (whole.members[int(i)].law.name for i in (np.argmin(epsilon), np.argmax(epsilon)))
    return (
        f"Calibrated to {epsilon.size} laws of whole foam at λ = {view.config.choppiness_prior.mean:g}, ε lies "
        f"between {epsilon.min():.3f} ({low}) and {epsilon.max():.3f} ({high}): {epsilon.mean():.3f} ± {spread:.3f} "
        f"from law to law, where one fit claims ± {error:.3f}. The choice of the law makes {spread / error:.2g} times "
        "the error of the fit."
    )


def _coverage_words(view: View) -> str:
    band, speeds = view.band, view.free.speeds
    i = int(np.argmin(np.abs(speeds - 10.0)))
    first, last = 0, speeds.size - 1
    seas, own = band.between, band.within
    return (
        f"At {speeds[i]:g} m/s the seas that obey these laws have W = {band.median[i]:.2g}, {100 * band.level:g} % "
        f"between {band.lower[i]:.2g} and {band.upper[i]:.2g}, a factor of {band.upper[i] / band.lower[i]:.2g}; at "
        f"{speeds[first]:g} and {speeds[last]:g} m/s the factor is {band.upper[first] / band.lower[first]:.2g} and "
        f"{band.upper[last] / band.lower[last]:.2g}. From law to law log10 W varies by {seas[i]:.2f} (standard "
        f"deviation) at {speeds[i]:g} m/s, by the errors of one calibration by {own[i]:.2f}."
    )


def _shape_words(view: View) -> str:
    rms = np.asarray([member.rms for member in view.free.members])
    best, worst = view.free.members[int(np.argmin(rms))], view.free.members[int(np.argmax(rms))]
    return (
        "One ε shifts the curve W(U10) of the sea but hardly bends it, so no sea obeys a law of another shape: the "
        f"misfit (RMS of log10 W) is {rms.min():.2f} for {best.law.name} and {rms.max():.2f} for {worst.law.name}."
    )


def _active_words(view: View) -> list[str]:
    if not _mixed(view):
        return []
    texts = []
    for member in view.held.members:
        if member.law.foam == "active":
            texts.append(
                f"{member.law.name} counts active breaking only, which is what j < ε resembles: it needs ε = "
                f"{_with_error(member.fit, 'threshold')}. All other laws count foam that outlives its breaking, so "
                "that their ε stands for the foam's life as well; the active law is left out of the band."
            )
    return texts


def _mixed(view: View) -> bool:
    """Whether there are laws of active breaking beside others."""
    return len({member.law.foam == "active" for member in view.free.members}) == 2


def _fit_warnings(view: View) -> list[str]:
    return [f"{member.law.name}: {text}" for member in view.free.members for text in member.fit.warnings]


def _law_table(view: View) -> Table:
    rows = []
    for free, held in zip(view.free.members, view.held.members, strict=True):
        seen = view.free.speeds[free.seen]
        rows.append(
            (
                short(free.law.name),
                free.law.foam,
                f"{seen[0]:g}–{seen[-1]:g}",
                _with_error(held.fit, "threshold"),
                _with_error(free.fit, "threshold"),
                f"{free.rms:.2f}",
            )
        )
    columns = (
        "law",
        "foam",
        "m/s",
        f"ε at λ = {view.config.choppiness_prior.mean:g}",
        "ε, λ fitted",
        "misfit",
    )
    return Table("Calibrations, with λ held and with λ fitted; misfit: RMS of log10 W", columns, rows)


def _with_error(fit: fitting.Fit, name: str) -> str:
    return f"{fit.values[name]:.3f} ± {fit.errors[name]:.3f}"


def _band_table(view: View) -> Table:
    speeds, band = view.free.speeds, view.band
    places = sorted({int(i) for i in np.linspace(0, speeds.size - 1, min(SHOWN, speeds.size)).round()})
    rows = [
        tuple(
            float(column[i])
            for column in (
                speeds,
                band.lower,
                band.median,
                band.upper,
                band.lowest,
                band.highest,
                band.between,
                band.within,
            )
        )
        for i in places
    ]
    percent = f"{100 * band.level:g} %"
    columns = (
        "U10 (m/s)",
        f"W, {percent} from",
        "median",
        "to",
        "lowest sea",
        "highest sea",
        "law to law",
        "own error",
    )
    return Table(
        "W(U10) of the seas that obey laws of whole foam, and the deviation of log10 W: law to law, own error",
        columns,
        rows,
    )


def _values(view: View) -> dict:
    return {
        "measure": view.config.measure,
        "breaking_wavenumber_rad_per_m": view.config.breaking_wavenumber,
        "wind_m_per_s": view.free.speeds,
        "laws": [
            {
                "name": free.law.name,
                "foam": free.law.foam,
                "citation": free.law.citation,
                "winds_m_per_s": view.free.speeds[free.seen],
                "threshold": free.fit.values["threshold"],
                "threshold_error": free.fit.errors["threshold"],
                "choppiness": free.fit.values["choppiness"],
                "choppiness_error": free.fit.errors["choppiness"],
                "threshold_at_fixed_choppiness": held.fit.values["threshold"],
                "threshold_at_fixed_choppiness_error": held.fit.errors["threshold"],
                "rms": free.rms,
                "coverage_law": free.law_coverage,
                "coverage_sea": free.coverage,
            }
            for free, held in zip(view.free.members, view.held.members, strict=True)
        ],
        "skipped": view.free.skipped,
        "band": {
            "level": view.band.level,
            "lower": view.band.lower,
            "median": view.band.median,
            "upper": view.band.upper,
            "between_laws_log10": view.band.between,
            "within_fit_log10": view.band.within,
        },
    }
