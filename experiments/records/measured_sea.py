"""`measured_sea`: from measured directional spectra to whitecap coverage, record by record."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean import io

from .. import schema
from ..common import _build
from ..harness._errors import UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result, Table
from . import _measured_report, _measured_views
from ._measured_records import OTHER_TAILS, Station, describe, read

MADE_FETCH = 200e3
"""Fetch [m] of the sea that is made where there are no measured ones, if the config's wind has none."""


def run(config: schema.MeasuredSeaConfig, progress: Reporter, store: Files) -> Result:
    """Predict the whitecap coverage of every record; see `schema.MeasuredSeaConfig`."""
    files, notes = config.spectrum_files(), []
    if not files:
        progress.step("Making a spectrum file, since there are no measured ones")
        files = (_make_file(config, store.folder / "made_here.nc"),)
        notes.append("No measured files were found: made_here.nc holds a JONSWAP sea of the config's wind.")
    with jax.enable_x64(True):
        stations = _stations(files, config, progress, notes)
        laws = {station.name: _laws(station, config) for station in stations}
    progress.step("Drawing")
    for station in stations:
        _measured_views.save(store, station, laws[station.name], config)
        if station.times.size > 2:
            _measured_views.plot_records(store, station, laws[station.name], config)
    _measured_views.plot_spectra(store, stations)
    notes += [note for station in stations for note in _notes(station, config)]
    notes.append(
        "Buoys stop far below the waves that break: the tail decides about W (try tail.law=elfouhaily)."
    )
    result = _result(stations, laws, config, notes)
    store.text("report.md", _measured_report.report(stations, laws, config, notes))
    return result


def _stations(
    files: Sequence[Path], config: schema.MeasuredSeaConfig, progress: Reporter, notes: list[str]
) -> list[Station]:
    """The numbers of all files; one without the records that are asked for is left out and noted."""
    stations, extents = [], []
    for name, path in zip(_names(files), files, strict=True):
        progress.step(f"Reading {path.name}")
        dataset = read(path, config.kind)
        station = describe(name, dataset, config, progress.count)
        if station is None:
            extents.append(f"{name} has {_extent(dataset)}")
            notes.append(f"{name} has none of the records that were asked for: it is left out.")
        else:
            stations.append(station)
    if not stations:
        raise UserError(f"No file has a record that `record` and `times` ask for: {'; '.join(extents)}.")
    return stations


def _extent(dataset: Any) -> str:
    records = int(np.prod([n for name, n in dataset["efth"].sizes.items() if name not in ("freq", "dir")]))
    said = f"{records} records (0 to {records - 1})"
    if "time" not in dataset:
        return said
    times = np.atleast_1d(dataset["time"].values)
    return f"{said} from {str(times.min())[:16]} to {str(times.max())[:16]}"


def _names(files: Sequence[Path]) -> list[str]:
    """A name for each file's results: its stem, numbered where two are alike."""
    stems = [path.stem for path in files]
    return [f"{stem}_{i + 1}" if stems.count(stem) > 1 else stem for i, stem in enumerate(stems)]


def _laws(station: Station, config: schema.MeasuredSeaConfig) -> dict[str, np.ndarray]:
    """Coverage by the laws at the file's wind; none where the waves themselves gave that wind."""
    known = np.isfinite(station.winds)
    if station.wind_origin in (None, "derived") or not known.any():
        return {}
    speeds = jnp.asarray(np.where(known, station.winds, 1.0))
    found = {}
    for name in config.laws:
        law = _build.law(name)
        coverage = np.asarray(jax.vmap(lambda u, law=law: law.coverage(jo.Wind(u)))(speeds))
        found[name] = np.where(known, coverage, np.nan)
    return found


def _make_file(config: schema.MeasuredSeaConfig, path: Path) -> Path:
    wind = _build.wind(config.wind)
    fetch = MADE_FETCH if wind.fetch is None else None
    return io.write_spectrum(jo.spectra.JONSWAP.from_fetch(wind, fetch=fetch), path)


def _notes(station: Station, config: schema.MeasuredSeaConfig) -> list[str]:
    notes = []
    if station.left_out:
        count, first = len(station.left_out), station.left_out[0]
        notes.append(f"{station.name}: {count} records left out, the first because: {first}")
    if station.wind_origin == "derived":
        tail = isinstance(config.tail, schema.ElfouhailyTailConfig)
        used = " Only its tail is that of this wind." if tail else ""
        notes.append(
            f"{station.name}: its wind is derived from its waves, not measured: no law is held against it.{used}"
        )
    return notes


def _result(
    stations: Sequence[Station],
    laws: dict[str, dict[str, np.ndarray]],
    config: schema.MeasuredSeaConfig,
    notes: Sequence[str],
) -> Result:
    limit = "none" if config.breaking_wavenumber is None else f"{config.breaking_wavenumber:.4g} rad/m"
    title = (
        f"Means over the records; tail {_measured_views.tail_name(config)}, ε = {config.threshold:g}, "
        f"λ = {config.choppiness:g}, k_b = {limit}"
    )
    columns = ("file", "records", "Hs (m)", "Tp (s)", "cut-off (Hz)", "mss below it", "mss")
    rows = []
    for station in stations:
        n = station.numbers
        quantities = (n.wave_height, n.peak_period, n.cut_off, n.measured_slope, n.mean_square_slope)
        means = [float(np.mean(quantity)) for quantity in (*quantities, n.projected[:, 1], n.rest)]
        rows.append((station.name, station.times.size, *means))
    columns_of = {station.name: _columns(station, laws[station.name]) for station in stations}
    together = {
        name: np.concatenate([columns_of[station.name][name] for station in stations])
        for name in _columns(stations[0], {})
    }
    return Result(
        values={
            "tail": config.tail.model_dump(),
            "threshold": config.threshold,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
            "band_rad_per_m": config.band,
            "records": sum(station.times.size for station in stations),
            "records_left_out": sum(len(station.left_out) for station in stations),
            **{f"mean_{name}": float(np.mean(values)) for name, values in together.items()},
            "files": {
                station.name: {
                    "time": [str(time) for time in station.times],
                    **{name: _plain(values) for name, values in columns_of[station.name].items()},
                }
                for station in stations
            },
        },
        tables=(Table(title, (*columns, "W projected", "W rest"), rows),),
        notes=tuple(notes),
    )


def _columns(station: Station, laws: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The numbers of all records, by names that tell their units."""
    n = station.numbers
    columns = {
        "significant_wave_height_m": n.wave_height,
        "peak_period_s": n.peak_period,
        "mean_square_slope": n.mean_square_slope,
        "mean_square_slope_below_the_cut_off": n.measured_slope,
        "cut_off_hz": n.cut_off,
        "coverage_projected": n.projected[:, 1],
        "coverage_rest": n.rest,
        **{
            f"coverage_projected_tail_{abs(exponent):g}": n.other_tails[:, i]
            for i, exponent in enumerate(OTHER_TAILS)
        },
    }
    if np.isfinite(station.winds).any():
        columns[f"wind_speed_{station.wind_origin}_m_per_s"] = station.winds
    return columns | {f"coverage_{name}": values for name, values in laws.items()}


def _plain(values: np.ndarray) -> Any:
    """A number where there is one record, as a sweep over records wants it; else all of them."""
    return float(values[0]) if values.size == 1 else values
