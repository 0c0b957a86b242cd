"""Tables, notes and `report.md` of `ship_records`."""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .. import schema
from ..common import _build
from ..harness._result import Table

BINS = (2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0)
"""Edges of the winds [m/s] over which biases are told."""


def _interval(triple: Sequence[float], form: str) -> str:
    if not np.isfinite(triple[0]):
        return "-"
    value, low, high = (format(number, form) for number in triple)
    return f"{value} ({low} to {high})" if np.isfinite(triple[1]) else value


def tables(
    values: Mapping[str, Any], compared: Sequence[Any], config: schema.ShipRecordsConfig
) -> tuple[Table, ...]:
    """The comparison, and the bias at each wind."""
    share = f"{100 * config.confidence:g} %"
    rows = [
        (
            _build.law(one.law).name,
            values[f"mean_coverage_{one.law}"],
            values["mean_coverage_projected"],
            one.records,
            _interval(one.rank_correlation, ".3f"),
            _interval(one.bias, "+.2f"),
        )
        for one in compared
    ]
    columns = ("law", "mean W by it", "predicted", "records")
    by_wind = [
        (f"{low:g} to {high:g}", *(_interval(one.by_wind[i], "+.2f") for one in compared))
        for i, (low, high) in enumerate(itertools.pairwise(BINS))
        if any(np.isfinite(one.by_wind[i][0]) for one in compared)
    ]
    return (
        Table(
            f"Predicted coverage at ε = {config.threshold:g}, projected area, and laws; Spearman's ranks, {share}",
            (*columns, "rank correlation", "log10(W/W_law)"),
            rows,
        ),
        Table(
            "Mean log10(W/W_law) by wind",
            ("U10 (m/s)", *(_build.law(one.law).name for one in compared)),
            by_wind,
        ),
    )


def notes(values: Mapping[str, Any], config: schema.ShipRecordsConfig) -> list[str]:
    """What one must know to read the tables."""
    said = [
        f"The wind was brought to 10 m along the neutral profile of the drag law `{config.drag}`: U10 is "
        f"{values['wind_ratio']:.3f} of what was measured, on average.",
        f"In {100 * values['swell_share']:.1f} % of the records U10/c_p is below 0.84: their peak is swell. "
        f"{values['records_younger']} of {values['records']} records have less height than their wind would raise: "
        "the wind sea is made younger until it fits, and has no swell"
        + (
            f" (scaled down instead, W would change by {values['scaled_instead_of_younger_percent']:+.0f} %, median)."
            if values["records_younger"]
            else "."
        ),
        "The laws know only the wind, so that all of them have nearly the same rank correlation.",
    ]
    if values["records_left_out"]:
        said.append(
            f"{values['records_left_out']} records lack wind, height or phase speed and are left out."
        )
    return said


def report(
    values: Mapping[str, Any],
    compared: Sequence[Any],
    config: schema.ShipRecordsConfig,
    listed: Sequence[str],
) -> str:
    """`report.md`."""
    limit = config.breaking_wavenumber
    sees = "all waves" if limit is None else f"waves up to {limit:.4g} rad/m"
    lines = [_sentence(one, values, config) for one in compared]
    effect, across = values["swell_effect_percent"], values["swell_effect_across_percent"]
    swell = (
        f"Swell does little to whitecaps in a linear sea: it changes W by {effect:+.1f} % (median over the "
        f"{values['records_with_swell']} records that have any), and by {across:+.1f} % if it is turned by 90°. What "
        "swell does to the wind and to short waves riding on it is not in this model."
        if np.isfinite(effect)
        else "No record has swell."
    )
    scatter = values["scatter_at_one_wind"]
    spread = (
        f"At one wind speed the predictions scatter by {scatter:.2f} in log10 W. Observed coverage scatters by 0.5 to "
        "1, so that in this model height and phase speed explain little of it."
        if np.isfinite(scatter)
        else ""
    )
    return f"""# Whitecaps from ship records

{values["records"]} records, U10 {values["mean_wind_speed_m_per_s"]:.3g} m/s and Hs \
{values["mean_significant_wave_height_m"]:.3g} m on average. Each is a wind sea (Elfouhaily) and swell that carries \
the rest of the height at the measured phase speed. Coverage by the exact closure, projected area, at \
ε = {config.threshold:g}, λ = {config.choppiness:g}; foam sees {sees}. Its mean is \
{100 * values["mean_coverage_projected"]:.3g} %.

{chr(10).join(lines)}

{swell}

{spread}

![ship records](ship_records.png)

{chr(10).join(f"- {note}" for note in listed)}"""


def _sentence(one: Any, values: Mapping[str, Any], config: schema.ShipRecordsConfig) -> str:
    name = _build.law(one.law).name
    factor = 10 ** one.bias[0] if np.isfinite(one.bias[0]) else float("nan")
    return (
        f"- Beside {name} (mean {100 * values[f'mean_coverage_{one.law}']:.3g} %): rank correlation "
        f"{_interval(one.rank_correlation, '.3f')}, mean log10(W/W_law) {_interval(one.bias, '+.2f')}, a factor of "
        f"{factor:.2g}, over {one.records} records with whitecaps to be seen by both ({100 * config.confidence:g} % "
        f"intervals from blocks of {config.block:g} days)."
    )
