"""Pictures and data files of measured seas."""

import itertools
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.ticker import NullFormatter

from . import _plots, schema
from ._files import Files, variable


class SeaView(NamedTuple):
    """What is shown of one file: numbers along its records, and the coverage [-] predicted for each."""

    name: str
    times: np.ndarray
    numbers: Any
    projected: np.ndarray
    rest: np.ndarray


def tail_name(config: schema.MeasuredSeaConfig) -> str:
    """The tail in a few words."""
    match config.tail:
        case schema.PowerTailConfig():
            return f"f^{config.tail.exponent:g}"
        case schema.ElfouhailyTailConfig():
            return "Elfouhaily"
        case _:
            return "none"


def plot_records(store: Files, view: SeaView, config: schema.MeasuredSeaConfig) -> None:
    """`<name>_records.png`: Hs, mean-square slope and coverage along the records."""
    times, numbers = view.times, view.numbers
    dated = np.issubdtype(times.dtype, np.datetime64) and np.unique(times).size == times.size
    along = times if dated else np.arange(times.size)
    above = {"loc": "upper left", "ncols": 2, "bbox_to_anchor": (0, 1.28)}
    with _plots.figure(3, 1, size=(8.0, 6.4), sharex=True, title=view.name) as (fig, (top, middle, bottom)):
        top.plot(along, numbers.wave_height, color=_plots.BLACK)
        top.set(ylabel="Hs (m)", ylim=(0, None))
        middle.plot(
            along, numbers.mean_square_slope, color=_plots.BLUE, label=f"with tail {tail_name(config)}"
        )
        middle.plot(along, numbers.measured_slope, color=_plots.ORANGE, label="below the cut-off")
        middle.set(ylabel="mss (-)", ylim=(0, None))
        middle.legend(**above)
        bottom.semilogy(along, visible(view.projected), color=_plots.VERMILION, label="projected area")
        bottom.semilogy(along, visible(view.rest), color=_plots.SKY, label="rest area")
        bottom.set(ylabel="coverage W (-)", xlabel="time (UTC)" if dated else "record")
        bottom.legend(**above)
        if dated:
            fig.autofmt_xdate()
        store.picture(f"{view.name}_records", fig)


def visible(coverage: np.ndarray, *, floor: float = 1e-9) -> np.ndarray:
    """Values for a logarithmic axis: what is below `floor` leaves a gap."""
    return np.where(coverage > floor, coverage, np.nan)


def plot_spectra(store: Files, frequency: np.ndarray, views: Sequence[SeaView]) -> None:
    """`spectra.png`: the mean E(f) of each file with its tail, and coverage against slope."""
    with _plots.figure(1, 2, size=(9.8, 4.2)) as (fig, (left, right)):
        top = 0.0
        for view, colour in zip(views, itertools.cycle(_plots.PALETTE), strict=False):
            energy = view.numbers.energy.mean(axis=0)
            measured = frequency <= float(np.mean(view.numbers.cut_off))
            top = max(top, float(energy.max()))
            left.loglog(frequency[measured], energy[measured], color=colour, label=view.name)
            left.loglog(frequency[~measured], energy[~measured], color=colour, linestyle=":")
            slope, coverage = view.numbers.mean_square_slope, visible(view.projected)
            right.loglog(slope, coverage, "o", color=colour, markersize=4, alpha=0.6, markeredgewidth=0)
        left.set(ylim=(top * 1e-8, top * 3), xlabel="frequency f (Hz)", ylabel="E(f) (m²/Hz)")
        left.set_title("Mean spectra; dotted: the tail")
        left.legend()
        right.set(xlabel="mean-square slope (-)", ylabel="coverage W, projected area (-)")
        right.set_title("Each record")
        # Labels of minor ticks would run into each other.
        right.xaxis.set_minor_formatter(NullFormatter())
        store.picture("spectra", fig)


def save(store: Files, view: SeaView, config: schema.MeasuredSeaConfig) -> None:
    """`<name>_records.nc`: the numbers of every record, with the tail they depend on."""
    n = view.numbers
    columns = {
        "significant_wave_height": (n.wave_height, "m", "significant wave height"),
        "peak_period": (n.peak_period, "s", "peak period"),
        "mean_square_slope": (n.mean_square_slope, "1", "mean-square slope, tail included"),
        "mean_square_slope_below_the_cut_off": (n.measured_slope, "1", "mean-square slope, measured part"),
        "cut_off": (n.cut_off, "s-1", "highest frequency used"),
        "coverage_projected": (view.projected, "1", "whitecap coverage, projected area"),
        "coverage_rest": (view.rest, "1", "whitecap coverage, rest area"),
    }
    standard = {
        "significant_wave_height": "sea_surface_wave_significant_height",
        "peak_period": "sea_surface_wave_period_at_variance_spectral_density_maximum",
    }
    variables = {
        key: variable("record", values, units=units, long_name=text, standard_name=standard.get(key))
        for key, (values, units, text) in columns.items()
    }
    if np.issubdtype(view.times.dtype, np.datetime64):
        seconds = view.times.astype("datetime64[s]").astype(np.int64)
        variables["time"] = variable(
            "record", seconds, units="seconds since 1970-01-01", long_name="time", standard_name="time"
        )
    store.data(
        f"{view.name}_records",
        variables,
        title=f"Sea state and predicted whitecap coverage, {view.name}",
        attributes={
            "tail": tail_name(config),
            "threshold": config.threshold,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
            "band_rad_per_m": np.asarray(config.band),
        },
    )
