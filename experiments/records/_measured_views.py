"""Pictures and data files of measured seas."""

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.dates import AutoDateLocator, ConciseDateFormatter
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from .. import schema
from ..common import _build, _plots
from ..common._words import low_pass
from ..harness._files import Files, variable
from ._measured_records import FREQUENCIES, OTHER_TAILS, Station

FLOOR = 1e-9
"""Coverage below is not drawn."""

LONG_GAP = 3.0
"""Lines break where records are missing for so many usual steps."""

ORIGINS = {"measured": "measured wind", "model": "the model's wind", "unknown": "the file's wind"}


def tail_name(config: schema.MeasuredSeaConfig) -> str:
    """The tail in a few words."""
    match config.tail:
        case schema.PowerTailConfig():
            return f"f^{config.tail.exponent:g}"
        case schema.ElfouhailyTailConfig():
            return "Elfouhaily"
        case _:
            return "none"


def _label(config: schema.MeasuredSeaConfig) -> str:
    """The tail for pictures."""
    if isinstance(config.tail, schema.PowerTailConfig):
        return f"tail $f^{{{config.tail.exponent:g}}}$"
    return f"tail {tail_name(config)}" if isinstance(config.tail, schema.ElfouhailyTailConfig) else "no tail"


def plot_records(
    store: Files, station: Station, laws: Mapping[str, np.ndarray], config: schema.MeasuredSeaConfig
) -> None:
    """`<name>_records.png`: height and period, slope, and coverage along the records."""
    line = Line.of(station)
    heights = (1, 1, 2.1)
    with _plots.figure(3, 1, size=(8.6, 8.2), sharex=True, height_ratios=heights) as (
        fig,
        (top, middle, bottom),
    ):
        _plot_height(top, line, station)
        _plot_slope(middle, line, station, config)
        _plot_coverage(bottom, line, station, laws, config)
        bottom.set_xlabel("time (UTC)" if station.dated else "record")
        if not station.dated:
            bottom.xaxis.set_major_locator(MaxNLocator(integer=True))
        fig.legend(*bottom.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        fig.suptitle(
            f"{station.name}: {station.times.size} records, ε = {config.threshold:g} ± {config.threshold_error:g}, "
            f"λ = {config.choppiness:g}, {low_pass(config.breaking_wavenumber)}",
            fontsize=11,
            x=0.01,
            ha="left",
        )
        if station.dated:
            # With the year, which the ticks of short records leave out.
            locator = AutoDateLocator()
            bottom.xaxis.set_major_locator(locator)
            bottom.xaxis.set_major_formatter(ConciseDateFormatter(locator))
            first, last = (str(end)[:10] for end in (station.times.min(), station.times.max()))
            period = first if first == last else f"{first} to {last}"
            bottom.set_xlabel(f"time (UTC), {period}")
            fig.autofmt_xdate(rotation=0, ha="center")
        store.picture(f"{station.name}_records", fig)


class Line(NamedTuple):
    """Where records lie on the axis; a gap much longer than the usual step breaks lines."""

    along: np.ndarray
    gaps: np.ndarray

    @classmethod
    def of(cls, station: Station) -> "Line":
        """The axis of a station: its times if they are all different, else the numbers of its records."""
        if not station.dated:
            return cls(np.arange(station.times.size), np.zeros(0, int))
        steps = np.diff(station.times)
        gaps = np.flatnonzero(steps > LONG_GAP * np.median(steps)) + 1
        return cls(np.insert(station.times, gaps, station.times[gaps - 1] + steps[gaps - 1] / 2), gaps)

    def broken(self, values: np.ndarray) -> np.ndarray:
        """Values at all places, missing in the gaps."""
        return np.insert(np.asarray(values, float), self.gaps, np.nan)


def _plot_height(axes: Axes, line: Line, station: Station) -> None:
    axes.plot(line.along, line.broken(station.numbers.wave_height), color=_plots.BLACK)
    axes.set(ylabel="Hs (m)", title="(a) Significant wave height and peak period")
    axes.set_ylim(0, 1.1 * float(station.numbers.wave_height.max()))
    right = axes.twinx()
    right.plot(
        line.along, line.broken(station.numbers.peak_period), ".", color=_plots.VERMILION, markersize=4
    )
    right.set_ylabel("Tp (s)", color=_plots.VERMILION)
    right.tick_params(axis="y", colors=_plots.VERMILION)
    right.set_ylim(0, 1.1 * float(station.numbers.peak_period.max()))
    right.grid(visible=False)


def _plot_slope(axes: Axes, line: Line, station: Station, config: schema.MeasuredSeaConfig) -> None:
    numbers, name = station.numbers, _label(config)
    axes.plot(line.along, line.broken(numbers.mean_square_slope), color=_plots.BLUE, label=f"with {name}")
    axes.plot(line.along, line.broken(numbers.measured_slope), color=_plots.GREY, label="below the cut-off")
    axes.set(ylabel="mss (-)", ylim=(0, None), title="(b) Mean-square slope")
    axes.legend(loc="lower right", bbox_to_anchor=(1, 0.98), ncols=2)


def _plot_coverage(
    axes: Axes,
    line: Line,
    station: Station,
    laws: Mapping[str, np.ndarray],
    config: schema.MeasuredSeaConfig,
) -> None:
    numbers, along, name = station.numbers, line.along, _label(config)
    low, high = (line.broken(np.maximum(numbers.other_tails[:, i], FLOOR)) for i in (0, 1))
    axes.fill_between(along, low, high, color="#E4E4E4", linewidth=0, label="tails from $f^{-5}$ to $f^{-4}$")
    below, above = (line.broken(np.maximum(numbers.projected[:, i], FLOOR)) for i in (0, 2))
    axes.fill_between(
        along,
        below,
        above,
        color=_plots.BLUE,
        alpha=0.3,
        linewidth=0,
        label=f"ε ± {config.threshold_error:g}",
    )
    projected, rest = (line.broken(visible(w)) for w in (numbers.projected[:, 1], numbers.rest))
    axes.plot(along, projected, color=_plots.BLUE, label=f"{name}, projected area")
    axes.plot(along, rest, color=_plots.BLUE, linestyle=":", linewidth=1.2, label=f"{name}, rest area")
    marks = zip(laws.items(), (_plots.VERMILION, _plots.GREEN, _plots.PURPLE, _plots.ORANGE), strict=False)
    for (law, coverage), colour in marks:
        label = f"{_build.law(law).name} at {ORIGINS.get(station.wind_origin or '', 'its wind')}"
        axes.plot(along, line.broken(visible(coverage)), "o", color=colour, markersize=3.5, label=label)
    axes.set(yscale="log", ylim=(FLOOR, 1), ylabel="whitecap coverage W (-)", title="(c) Coverage")
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    axes.yaxis.set_minor_formatter(NullFormatter())


def visible(coverage: np.ndarray) -> np.ndarray:
    """Values for a logarithmic axis: what is below its floor leaves a gap."""
    return np.where(coverage > FLOOR, coverage, np.nan)


def plot_spectra(store: Files, stations: Sequence[Station]) -> None:
    """`spectra.png`: the mean E(f) of each file with its tail, and coverage against slope."""
    with _plots.figure(1, 2, size=(9.8, 4.2)) as (fig, (left, right)):
        top = 0.0
        for station, colour in zip(stations, itertools.cycle(_plots.PALETTE), strict=False):
            energy = station.numbers.energy.mean(axis=0)
            measured = float(np.mean(station.numbers.cut_off)) >= FREQUENCIES
            top = max(top, float(energy.max()))
            left.loglog(FREQUENCIES[measured], energy[measured], color=colour, label=station.name)
            left.loglog(FREQUENCIES[~measured], energy[~measured], color=colour, linestyle=":")
            slope, coverage = station.numbers.mean_square_slope, visible(station.numbers.projected[:, 1])
            right.loglog(slope, coverage, "o", color=colour, markersize=4, alpha=0.6, markeredgewidth=0)
        left.set(ylim=(top * 1e-8, top * 3), xlabel="frequency f (Hz)", ylabel="E(f) (m²/Hz)")
        left.set_title("(a) Mean spectra; dotted: the tail")
        left.legend()
        right.set(xlabel="mean-square slope (-)", ylabel="coverage W, projected area (-)")
        right.set_title("(b) Each record")
        # Labels of minor ticks would run into each other.
        right.xaxis.set_minor_formatter(NullFormatter())
        store.picture("spectra", fig)


def save(
    store: Files, station: Station, laws: Mapping[str, np.ndarray], config: schema.MeasuredSeaConfig
) -> None:
    """`<name>_records.nc`: the numbers of every record, with the tail they depend on."""
    n = station.numbers
    columns = {
        "significant_wave_height": (n.wave_height, "m", "significant wave height"),
        "peak_period": (n.peak_period, "s", "peak period"),
        "mean_square_slope": (n.mean_square_slope, "1", "mean-square slope, tail included"),
        "mean_square_slope_below_the_cut_off": (n.measured_slope, "1", "mean-square slope, measured part"),
        "cut_off": (n.cut_off, "s-1", "highest frequency used"),
        "coverage_projected": (n.projected[:, 1], "1", "whitecap coverage, projected area"),
        "coverage_projected_low": (n.projected[:, 0], "1", "the same at epsilon less its error"),
        "coverage_projected_high": (n.projected[:, 2], "1", "the same at epsilon plus its error"),
        "coverage_rest": (n.rest, "1", "whitecap coverage, rest area"),
    }
    for i, exponent in enumerate(OTHER_TAILS):
        words = f"whitecap coverage, projected area, if the tail were f^{exponent:g}"
        columns[f"coverage_projected_tail_{abs(exponent):g}"] = (n.other_tails[:, i], "1", words)
    if np.isfinite(station.winds).any():
        columns["wind_speed"] = (station.winds, "m s-1", f"wind speed at 10 m ({station.wind_origin})")
    for name, coverage in laws.items():
        words = f"whitecap coverage by {_build.law(name).name} at that wind"
        columns[f"coverage_{name}"] = (coverage, "1", words)
    standard = {
        "significant_wave_height": "sea_surface_wave_significant_height",
        "peak_period": "sea_surface_wave_period_at_variance_spectral_density_maximum",
        "wind_speed": "wind_speed",
    }
    dimension = "time" if station.dated else "record"
    variables = {
        key: variable(dimension, values, units=units, long_name=text, standard_name=standard.get(key))
        for key, (values, units, text) in columns.items()
    }
    coordinates = {}
    if np.issubdtype(station.times.dtype, np.datetime64):
        seconds = station.times.astype("datetime64[s]").astype(np.int64)
        coordinates["time"] = variable(
            dimension, seconds, units="seconds since 1970-01-01", long_name="time", standard_name="time"
        )
    store.data(
        f"{station.name}_records",
        variables,
        coordinates,
        title=f"Sea state and predicted whitecap coverage, {station.name}",
        attributes={
            "tail": tail_name(config),
            "threshold": config.threshold,
            "threshold_error": config.threshold_error,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
            "band_rad_per_m": np.asarray(config.band),
            "wind": station.wind_origin or "none",
        },
    )
