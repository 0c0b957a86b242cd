"""`measured_sea`: from measured directional spectra to whitecap coverage, record by record."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import jaxocean as jo
from jaxocean import io
from jaxocean.spectra import measured as tails
from jaxocean.spectra.measured import MeasuredSpectrum

from . import _build, _measured_views, schema
from ._files import Files
from ._measured_views import SeaView, tail_name
from ._progress import Reporter
from ._result import Result, Table

NEGATIVE = {"renormalise": io.ClipAndRenormalise, "maximum_entropy": io.MaximumEntropy, "clip": io.Clip}
FREQUENCIES = np.geomspace(0.03, 3.0, 200)

MADE_FETCH = 200e3
"""Fetch [m] of the sea that is made where there are no measured ones, if the config's wind has none."""


class SeaNumbers(NamedTuple):
    """What is reported of a record; with a leading axis, of all records of a file."""

    wave_height: Float[Array, "*r"]
    peak_period: Float[Array, "*r"]
    mean_square_slope: Float[Array, "*r"]
    measured_slope: Float[Array, "*r"]
    covariance: Float[Array, "*r 3 3"]
    cut_off: Float[Array, "*r"]
    energy: Float[Array, "*r frequency"]


@dataclass(frozen=True)
class Station:
    """One file: its records by time or number, their numbers, and why some were left out."""

    name: str
    times: np.ndarray
    numbers: SeaNumbers
    left_out: tuple[str, ...]


def run(config: schema.MeasuredSeaConfig, progress: Reporter, store: Files) -> Result:
    """Predict the whitecap coverage of every record; see `schema.MeasuredSeaConfig`."""
    files, notes = config.spectrum_files(), []
    if not files:
        progress.step("Making a spectrum file, since there are no measured ones")
        files = (_make_file(config, store.folder / "made_here.nc"),)
        notes.append("No measured files were found: made_here.nc holds a JONSWAP sea of the config's wind.")
    stations = [
        _station(name, path, config, progress) for name, path in zip(_names(files), files, strict=True)
    ]
    progress.step("Predicting the coverage")
    views = [
        SeaView(station.name, station.times, station.numbers, projected, rest)
        for station, (projected, rest) in zip(stations, _coverage(stations, config.threshold), strict=True)
    ]
    progress.step("Drawing")
    for view in views:
        _measured_views.save(store, view, config)
        if view.times.size > 2:
            _measured_views.plot_records(store, view, config)
    _measured_views.plot_spectra(store, FREQUENCIES, views)
    for station in stations:
        if station.left_out:
            count, first = len(station.left_out), station.left_out[0]
            notes.append(f"{station.name}: {count} records left out, the first because: {first}")
    return _result(views, config, notes)


def _station(name: str, path: Path, config: schema.MeasuredSeaConfig, progress: Reporter) -> Station:
    """The numbers of all records of one file; a record that cannot be used is left out and counted."""
    progress.step(f"Reading {path.name}")
    dataset = io.open_spectra(path)
    records = list(_records(dataset, config.records))
    advance = progress.count(f"Integrating {len(records)} records of {path.name}", len(records))
    times, numbers, left_out = [], [], []
    for position, record in enumerate(records):
        try:
            spectrum = _spectrum(dataset, record, config)
        except ValueError as error:
            left_out.append(str(error))
        else:
            times.append(dataset["time"].values[record["time"]] if "time" in record else position)
            numbers.append(_describe(spectrum, config.choppiness, config.breaking_wavenumber, config.band))
        advance()
    if not numbers:
        raise ValueError(f"File {path} holds no usable record: {left_out[0]}")
    stacked = jax.tree.map(lambda *each: np.stack(each), *numbers)
    return Station(name, np.asarray(times), stacked, tuple(left_out))


def _spectrum(dataset: Any, record: dict[str, int], config: schema.MeasuredSeaConfig) -> MeasuredSpectrum:
    return io.spectrum_from_dataset(
        dataset,
        record=record,
        tail=_tail(config, dataset, record),
        cut_off=config.cut_off,
        negative=NEGATIVE[config.negative](),
    )


@eqx.filter_jit
def _describe(spectrum, choppiness, breaking_wavenumber, band) -> SeaNumbers:
    stats = jo.whitecaps.strain_statistics(
        spectrum, choppiness, band=band, breaking_wavenumber=breaking_wavenumber
    )
    without_tail = eqx.tree_at(lambda s: s.tail, spectrum, tails.NoTail())
    return SeaNumbers(
        wave_height=jo.spectra.significant_wave_height(spectrum, band=band),
        peak_period=jo.spectra.peak_period(spectrum),
        mean_square_slope=jo.spectra.mean_square_slope(spectrum, band=band),
        measured_slope=jo.spectra.mean_square_slope(without_tail, band=band),
        covariance=stats.covariance,
        cut_off=spectrum.cut_off(),
        energy=jo.spectra.frequency_spectrum(spectrum, jnp.asarray(FREQUENCIES)),
    )


def _coverage(stations: list[Station], threshold: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Projected and rest coverage of every record; all files in one call, compiled once."""
    covariance = jnp.concatenate([station.numbers.covariance for station in stations])
    stats = jo.whitecaps.StrainStatistics(jnp.zeros_like(covariance[:, 0]), covariance)
    projected, rest = _close(stats, threshold)
    ends = np.cumsum([station.times.size for station in stations])[:-1]
    return list(zip(np.split(np.asarray(projected), ends), np.split(np.asarray(rest), ends), strict=True))


@eqx.filter_jit
def _close(stats: jo.whitecaps.StrainStatistics, threshold: float):
    return tuple(jo.whitecaps.ExactClosure(measure)(stats, threshold) for measure in ("projected", "rest"))


def _names(files: tuple[Path, ...]) -> list[str]:
    """A name for each file's results: its stem, numbered where two are alike."""
    stems = [path.stem for path in files]
    return [f"{stem}_{i + 1}" if stems.count(stem) > 1 else stem for i, stem in enumerate(stems)]


def _records(dataset: Any, most: int) -> Iterator[dict[str, int]]:
    """Indices of at most `most` records, evenly spaced over every dimension but frequency and direction."""
    if "efth" not in dataset:
        yield {}
        return
    sizes = {str(name): size for name, size in dataset["efth"].sizes.items() if name not in ("freq", "dir")}
    everything = list(itertools.product(*(range(size) for size in sizes.values())))
    chosen = np.unique(np.linspace(0, len(everything) - 1, min(most, len(everything))).astype(int))
    for index in chosen:
        yield dict(zip(sizes, everything[index], strict=True))


def _tail(config: schema.MeasuredSeaConfig, dataset: Any, record: dict[str, int]) -> tails.AbstractTail:
    """The tail of a config; that of Elfouhaily has the record's own wind where there is one."""
    match config.tail:
        case schema.NoTailConfig():
            return tails.NoTail()
        case schema.PowerTailConfig():
            return tails.PowerTail(config.tail.exponent)
        case schema.ElfouhailyTailConfig():
            try:
                wind = io.wind_from_dataset(dataset, record=record)
            except ValueError:
                wind = _build.wind(config.wind)
            return tails.ElfouhailyTail(wind, blend=config.tail.blend, exponent=config.tail.exponent)


def _make_file(config: schema.MeasuredSeaConfig, path: Path) -> Path:
    wind = _build.wind(config.wind)
    sea = (
        jo.spectra.JONSWAP.from_fetch(wind, fetch=200e3)
        if wind.fetch is None
        else jo.spectra.JONSWAP.from_fetch(wind)
    )
    return io.write_spectrum(sea, path)


def _result(views: list[SeaView], config: schema.MeasuredSeaConfig, notes: list[str]) -> Result:
    limit = "none" if config.breaking_wavenumber is None else f"{config.breaking_wavenumber:.4g} rad/m"
    title = (
        f"Means over the records; tail {tail_name(config)}, ε = {config.threshold:g}, "
        f"λ = {config.choppiness:g}, k_b = {limit}"
    )
    columns = (
        "file",
        "records",
        "Hs (m)",
        "Tp (s)",
        "cut-off (Hz)",
        "mss below it",
        "mss",
        "W projected",
        "W rest",
    )
    rows = []
    for view in views:
        n = view.numbers
        quantities = (n.wave_height, n.peak_period, n.cut_off, n.measured_slope, n.mean_square_slope)
        means = [float(np.mean(quantity)) for quantity in (*quantities, view.projected, view.rest)]
        rows.append((view.name, view.times.size, *means))
    return Result(
        values={
            "tail": config.tail.model_dump(),
            "threshold": config.threshold,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
            "band_rad_per_m": config.band,
            "files": {
                view.name: {
                    "time": [str(time) for time in view.times],
                    "significant_wave_height_m": view.numbers.wave_height,
                    "peak_period_s": view.numbers.peak_period,
                    "mean_square_slope": view.numbers.mean_square_slope,
                    "mean_square_slope_below_the_cut_off": view.numbers.measured_slope,
                    "cut_off_hz": view.numbers.cut_off,
                    "coverage_projected": view.projected,
                    "coverage_rest": view.rest,
                }
                for view in views
            },
        },
        tables=(Table(title, columns, rows),),
        notes=(
            *notes,
            "Buoys stop far below the waves that break: the tail decides about W (try tail.law=elfouhaily).",
        ),
    )
