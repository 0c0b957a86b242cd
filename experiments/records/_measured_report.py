"""`report.md` of `measured_sea`: what its numbers say, in words."""

from collections.abc import Mapping, Sequence

import numpy as np

from .. import schema
from ..common import _build
from ._measured_records import Station
from ._measured_views import FLOOR, tail_name

LEAST = 1e-6
"""Smaller shares are told as less than this."""


def report(
    stations: Sequence[Station],
    laws: Mapping[str, Mapping[str, np.ndarray]],
    config: schema.MeasuredSeaConfig,
    notes: Sequence[str],
) -> str:
    """The text."""
    limit = config.breaking_wavenumber
    seen = "all waves" if limit is None else f"waves up to k_b = {limit:.4g} rad/m"
    head = f"""# Whitecaps of measured seas

{sum(station.times.size for station in stations)} records of {len(stations)} files, cut at \
{"their last frequency" if config.cut_off is None else f"{config.cut_off:g} Hz"}; tail {tail_name(config)} above. \
Coverage by the exact closure at ε = {config.threshold:g} ± {config.threshold_error:g}, λ = {config.choppiness:g}; \
foam sees {seen}.
"""
    parts = [_paragraph(station, laws[station.name], config) for station in stations]
    listed = "\n".join(f"- {note}" for note in notes)
    return "\n".join([head, *parts, "![spectra](spectra.png)\n", listed])


def _paragraph(station: Station, laws: Mapping[str, np.ndarray], config: schema.MeasuredSeaConfig) -> str:
    n = station.numbers
    low, middle, high = np.quantile(n.projected[:, 1], (0.05, 0.5, 0.95))
    steep, flat = float(np.median(n.other_tails[:, 0])), float(np.median(n.other_tails[:, 1]))
    share = float(np.mean(n.measured_slope / np.where(n.mean_square_slope > 0, n.mean_square_slope, 1.0)))
    worst, best = (_percent(float(np.median(n.projected[:, i]))) for i in (0, 2))
    spread, it = _percent(middle), "it"
    if station.times.size > 1:
        spread = f"median {_percent(middle)}, 5 to 95 % of the records {_percent(low)} to {_percent(high)}"
        it = "that median"
    lines = [
        f"## {station.name}\n",
        f"{_count(station)}, {_period(station)}Hs {_range(n.wave_height)} m, Tp {_range(n.peak_period)} s. "
        f"The waves that were measured hold {100 * share:.2g} % of the mean-square slope; the rest is tail.",
        f"Coverage with tail {tail_name(config)}, projected area: {spread}. The error of ε makes "
        f"{it} {worst} to {best}, a tail between f^-5 and f^-4 {_percent(steep)} to {_percent(flat)}.",
    ]
    lines += [_compare(name, coverage, n.projected[:, 1]) for name, coverage in laws.items()]
    if station.times.size > 2:
        lines.append(f"\n![{station.name}]({station.name}_records.png)")
    return "\n".join(lines) + "\n"


def _period(station: Station) -> str:
    if not np.issubdtype(station.times.dtype, np.datetime64):
        return ""
    first, last = (str(end)[:16] for end in (station.times.min(), station.times.max()))
    return f"{first} UTC: " if first == last else f"{first} to {last} UTC: "


def _compare(name: str, law: np.ndarray, predicted: np.ndarray) -> str:
    both = (law > FLOOR) & (predicted > FLOOR)
    title = _build.law(name).name
    if both.sum() < 1:
        return f"{title} cannot be held against it: no record has whitecaps by both."
    ratio = np.log10(predicted[both] / law[both])
    return (
        f"Against {title} at the file's wind, over {both.sum()} records with whitecaps by both, the median of "
        f"log10(W/W_law) is {np.median(ratio):+.2f}."
    )


def _count(station: Station) -> str:
    return "One record" if station.times.size == 1 else f"{station.times.size} records"


def _range(values: np.ndarray) -> str:
    low, high = f"{values.min():.3g}", f"{values.max():.3g}"
    return low if low == high else f"{low} to {high}"


def _percent(share: float | np.floating) -> str:
    """A share that can be read: no exponents, and nothing smaller than one millionth."""
    if not share > FLOOR:
        return "none"
    if share < LEAST:
        return f"less than {100 * LEAST:g} %"
    return f"{float(f'{100 * share:.2g}'):.6f}".rstrip("0").rstrip(".") + " %"
