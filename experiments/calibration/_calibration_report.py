"""What `calibrate_monahan` says: tables, sentences, and the numbers for `result.json`."""

from collections.abc import Sequence

import numpy as np

import fitting

from ..common import _build, _markdown
from ..harness._files import Files
from ..harness._result import Result, Table
from ._calibration_views import View, band_name, per_wind_threshold, table_choppiness

AGREEMENT = 3.0
"""Standard errors within which counted coverage must agree with the closure."""


def report(store: Files, view: View) -> Result:
    """Tables, sentences and numbers of a calibration, and `report.md`."""
    config = view.config
    limit = "none" if config.breaking_wavenumber is None else f"{config.breaking_wavenumber:.4g} rad/m"
    what = f"{config.measure} area, {band_name(config)}, k_b = {limit}"
    tables = [_fit_table(view, what), _wind_table(view), _threshold_table(view)]
    if any(view.table.values()):
        tables.append(_limit_table(view))
    exact = view.calibrations["exact"]
    notes = [exact.shared.identifiability, *exact.shared.warnings]
    notes += _build.outside_validity(config.spectrum, config.wind)
    if config.band is None:
        notes += _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)
    if config.realisations and view.check is None:
        notes.append("With a band instead of a cascade there are no FFT seas to check the result on.")
    values = {
        "measure": config.measure,
        "band_rad_per_m": config.band or _build.cascade(config.cascade).band,
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
        "wind_m_per_s": config.wind.speed,
        **{
            name: {"shared": c.shared.as_dict(), "per_wind": c.per_wind.as_dict()}
            for name, c in view.calibrations.items()
        },
        "threshold_by_breaking_wavenumber": view.table,
    }
    if view.check is not None:
        worst = float(np.max(np.abs(view.check.deviations)))
        agreement = "reproduce" if worst <= AGREEMENT else "do NOT reproduce"
        notes.append(
            f"{config.realisations} FFT seas at each wind {agreement} the fitted coverage within {AGREEMENT:g} "
            f"standard errors: the worst deviation is {worst:.2g}."
        )
        values["check"] = {
            "coverage_counted": view.check.counted,
            "standard_error": view.check.error,
            "coverage_expected": view.check.expected,
            "deviations": view.check.deviations,
        }
    notes = list(dict.fromkeys(notes))
    answer = [_threshold_words(view), _shape_words(view), *_limit_words(view)]
    setting = f"{what}; the spectrum is {config.spectrum.family.replace('_', '-').title()}'s"
    text = _markdown.page(
        "ε and λ that make a simulated sea obey whitecap laws",
        [*answer, *notes],
        tables,
        picture="calibration",
        setting=setting,
    )
    store.text("report.md", text)
    return Result(values=values, tables=tables, notes=notes)


def _threshold_words(view: View) -> str:
    """What was asked: the values that go into a simulation."""
    config = view.config
    exact, gaussian = (view.calibrations[name].shared for name in ("exact", "gaussian"))
    known = [*config.laws, *(["the measured points"] if config.points.file is not None else [])]
    parts = [f"ε = {_with_error(exact, 'threshold')}"]
    if "choppiness" in exact.values:
        parts.append(f"λ = {_with_error(exact, 'choppiness')}")
    if "breaking_wavenumber" in exact.values:
        parts.append(f"k_b = {_with_error(exact, 'breaking_wavenumber')} rad/m")
    choppiness = "" if "choppiness" in exact.values else f" at λ = {config.choppiness:g}"
    return (
        f"One sea for winds from {config.wind.speed[0]:g} to {config.wind.speed[-1]:g} m/s comes nearest to "
        f"{' and '.join(known)} with {', '.join(parts)}{choppiness} ({config.measure} area, exact closure). Were the "
        f"Jacobian Gaussian, it would be ε = {_with_error(gaussian, 'threshold')}."
    )


def _shape_words(view: View) -> str:
    """What one threshold cannot do, and what each wind would need."""
    speeds, exact = view.config.wind.speed, view.calibrations["exact"]
    rms = " and ".join(f"{target.rms:.2f} for {target.name}" for target in exact.shared.targets)
    words = f"What one ε for all winds leaves is an RMS of log10 W of {rms}."
    value, error = per_wind_threshold(exact.per_wind, speeds)
    known = np.flatnonzero(np.isfinite(value))
    if known.size < 2:
        return words
    first, last = known[0], known[-1]
    return (
        f"{words} Each wind by itself needs ε = {value[first]:.3f} ± {error[first]:.3f} at {speeds[first]:g} m/s and "
        f"{value[last]:.3f} ± {error[last]:.3f} at {speeds[last]:g} m/s."
    )


def _limit_words(view: View) -> list[str]:
    """That a threshold belongs to its band and its area."""
    rows, other = view.table["projected"], view.table["rest"]
    if not rows:
        return []
    (low, at_low, *_), (high, at_high, *_) = rows[0], rows[-1]
    return [
        f"ε belongs to its band: if foam sees waves up to k_b = {low:g} rad/m it is {at_low:.3f}, up to {high:g} rad/m "
        f"{at_high:.3f} (projected area, λ = {table_choppiness(view.config):g}); and to its area: for the plane at "
        f"rest it is {other[0][1]:.3f} and {other[-1][1]:.3f}."
    ]


def _with_error(fit: fitting.Fit, name: str) -> str:
    return f"{float(fit.values[name]):.3f} ± {float(fit.errors[name]):.3f}"


def _fit_table(view: View, what: str) -> Table:
    rows = []
    for name, calibration in view.calibrations.items():
        fit = calibration.shared
        for parameter in fit.parameters:
            rows.append((name, parameter.name, parameter.value, parameter.error, parameter.unit))
        for target in fit.targets:
            rows.append((name, f"RMS to {target.name}", target.rms, float("nan"), "log10 W"))
    return Table(f"One value for all winds: {what}", ("closure", "quantity", "value", "±", "unit"), rows)


def _wind_table(view: View) -> Table:
    config = view.config
    columns = ["U10 (m/s)"]
    series: list = [config.wind.speed]
    exact = view.calibrations["exact"]
    for name, target in zip(config.laws, exact.shared.targets, strict=False):
        # Words wrap in a narrow column where a name would be cut.
        columns.append(f"W, {name.replace('_', ' ')}")
        series.append(10**target.observed)
    for name in view.calibrations:
        columns += [f"W, {name} fit", _plus_minus(columns)]
        series += [view.coverage[name], view.coverage[name] * view.spread[name]]
    if view.check is not None:
        columns += ["W, FFT seas", _plus_minus(columns), "deviation (SE)"]
        series += [view.check.counted, view.check.error, view.check.deviations]
    return Table("Coverage at each wind", columns, _rows(series))


def _threshold_table(view: View) -> Table:
    columns = ["U10 (m/s)"]
    series: list = [view.config.wind.speed]
    for name, calibration in view.calibrations.items():
        columns += [f"ε(U10), {name}", _plus_minus(columns)]
        series += per_wind_threshold(calibration.per_wind, view.config.wind.speed)
    return Table("A threshold for each wind", columns, _rows(series))


def _rows(series: Sequence) -> list[tuple[float, ...]]:
    return [tuple(map(float, row)) for row in zip(*series, strict=True)]


def _plus_minus(columns: Sequence[str]) -> str:
    """A heading of errors that is not there yet."""
    return "±" + " " * sum(column.startswith("±") for column in columns)


def _limit_table(view: View) -> Table:
    rows = [
        (row[0], *row[1:], *other[1:])
        for row, other in zip(view.table["projected"], view.table["rest"], strict=True)
    ]
    columns = ("k_b (rad/m)", "ε projected", "±", "RMS (log10)", "ε rest", "± ", "RMS (log10) ")
    return Table(f"ε against k_b, exact closure, λ = {table_choppiness(view.config):g}", columns, rows)
