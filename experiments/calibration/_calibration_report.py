"""What `calibrate_monahan` says: tables, sentences, and the numbers for `result.json`."""

import numpy as np

from ..common import _build
from ..harness._result import Result, Table
from ._calibration_views import View, band_name, per_wind_threshold, table_choppiness

AGREEMENT = 3.0
"""Standard errors within which counted coverage must agree with the closure."""


def report(view: View) -> Result:
    """Tables, sentences and numbers of a calibration."""
    config = view.config
    limit = "none" if config.breaking_wavenumber is None else f"{config.breaking_wavenumber:.4g} rad/m"
    what = f"{config.measure} area, {band_name(config)}, k_b = {limit}"
    tables = [_fit_table(view, what), _wind_table(view)]
    if any(view.table.values()):
        tables.append(_limit_table(view))
    exact = view.calibrations["exact"]
    notes = [exact.shared.identifiability, *exact.shared.warnings]
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
    return Result(values=values, tables=tables, notes=tuple(dict.fromkeys(notes)))


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
        columns.append(f"W, {name}")
        series.append(10**target.observed)
    for name, calibration in view.calibrations.items():
        columns.append(f"W, {name} fit")
        series.append(view.coverage[name])
        own = calibration.per_wind
        columns.append(f"ε(U10), {name}")
        series.append(per_wind_threshold(own, config.wind.speed)[0])
    if view.check is not None:
        columns += ["W, FFT seas", "± ", "deviation (SE)"]
        series += [view.check.counted, view.check.error, view.check.deviations]
    return Table("At each wind", columns, [tuple(map(float, row)) for row in zip(*series, strict=True)])


def _limit_table(view: View) -> Table:
    rows = [
        (row[0], *row[1:], *other[1:])
        for row, other in zip(view.table["projected"], view.table["rest"], strict=True)
    ]
    columns = ("k_b (rad/m)", "ε projected", "±", "RMS (log10)", "ε rest", "± ", "RMS (log10) ")
    return Table(f"ε against k_b, exact closure, λ = {table_choppiness(view.config):g}", columns, rows)
