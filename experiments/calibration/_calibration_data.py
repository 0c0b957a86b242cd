"""The data of `calibrate_monahan`: `calibration.nc`."""

from typing import Any

import numpy as np

from ..harness._files import Files, variable
from ._calibration_views import View, band_name, per_wind_threshold, table_choppiness


def save(store: Files, view: View) -> None:
    """The numbers of the figure as CF netCDF."""
    limit = view.config.breaking_wavenumber
    speeds = variable(
        "wind_speed",
        np.asarray(view.config.wind.speed),
        units="m s-1",
        long_name="wind speed at 10 m",
        standard_name="wind_speed",
    )
    limits, coordinate = _limits(view)
    store.data(
        "calibration",
        _fits(view) | _check(view) | _targets(view) | limits,
        {"wind_speed": speeds} | coordinate,
        title="Calibration of a breaking threshold to whitecap laws",
        attributes={
            "area_measure": view.config.measure,
            "band": band_name(view.config),
            "breaking_wavenumber": "none" if limit is None else f"{limit:.6g} rad/m",
        },
    )


def _fits(view: View) -> dict[str, Any]:
    found = {}
    for name, calibration in view.calibrations.items():
        value, error = per_wind_threshold(calibration.per_wind, view.config.wind.speed)
        columns = {
            f"coverage_{name}": (view.coverage[name], "whitecap coverage of the fit"),
            f"coverage_{name}_relative_error": (view.spread[name], "standard error of ln W of the fit"),
            f"threshold_{name}": (value, "breaking threshold of each wind"),
            f"threshold_error_{name}": (error, "standard error of the breaking threshold"),
        }
        found |= {
            key: _of_wind(values, f"{words}, {name} closure") for key, (values, words) in columns.items()
        }
    return found


def _check(view: View) -> dict[str, Any]:
    if view.check is None:
        return {}
    return {
        "coverage_counted": _of_wind(view.check.counted, "whitecap coverage counted on FFT seas"),
        "coverage_counted_error": _of_wind(view.check.error, "standard error of the counted coverage"),
    }


def _targets(view: View) -> dict[str, Any]:
    """The laws by the names that configs use, and measured points along a dimension of their own."""
    targets = view.calibrations["exact"].shared.targets
    found = {
        name: _of_wind(10**target.observed, f"whitecap coverage, {target.name}")
        for name, target in zip(view.config.laws, targets, strict=False)
    }
    for target in targets[len(view.config.laws) :]:
        found["measured_wind_speed"] = variable(
            "measurement", target.speeds, units="m s-1", long_name="wind speed at 10 m of the measurement"
        )
        found["measured_coverage"] = variable(
            "measurement", 10**target.observed, units="1", long_name="measured whitecap coverage"
        )
    return found


def _limits(view: View) -> tuple[dict[str, Any], dict[str, Any]]:
    """ε against k_b for both areas, and its coordinate."""
    found: dict[str, Any] = {}
    k: Any = ()
    for measure, rows in view.table.items():
        if not rows:
            continue
        k, *columns = (np.asarray(column) for column in zip(*rows, strict=True))
        words = ("breaking threshold", "standard error of the threshold", "RMS of log10 W around the targets")
        names = ("threshold_of_limit", "threshold_of_limit_error", "rms_of_limit")
        for name, text, values in zip(names, words, columns, strict=True):
            found[f"{name}_{measure}"] = variable(
                "breaking_wavenumber",
                values,
                units="1",
                long_name=f"{text} if foam sees waves up to this wavenumber, {measure} area",
                choppiness=table_choppiness(view.config),
            )
    if not found:
        return {}, {}
    coordinate = variable("breaking_wavenumber", k, units="rad m-1", long_name="breaking wavenumber k_b")
    return found, {"breaking_wavenumber": coordinate}


def _of_wind(values: np.ndarray, words: str) -> Any:
    return variable("wind_speed", values, units="1", long_name=words)
