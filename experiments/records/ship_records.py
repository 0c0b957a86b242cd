"""`ship_records`: wind sea and swell from what ships report, and their whitecaps beside empirical laws."""

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from scipy import stats as statistics

import jaxocean as jo
from jaxocean import io

from .. import schema
from ..common import _build
from ..common._bootstrap import block_interval
from ..harness._errors import UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _ship_report, _ship_views
from ._ship_report import BINS

BATCH = 256
"""Records that are integrated together."""


SEEN = 1e-5
"""Coverage below is not told apart from none: logarithms of a law near its onset mean nothing."""


class Sea(NamedTuple):
    """What is found for each record; the last axis of `projected` is ε less its error, ε, ε plus its error."""

    wind_speed: Any
    inverse_wave_age: Any
    younger: Any
    wind_sea_height: Any
    swell_height: Any
    swell_period: Any
    projected: Any
    rest: Any
    without_swell: Any
    swell_across: Any
    scaled: Any
    laws: Any


class Comparison(NamedTuple):
    """The model beside one law: numbers with the ends of their intervals."""

    law: str
    records: int
    rank_correlation: tuple[float, float, float]
    bias: tuple[float, float, float]
    by_wind: tuple[tuple[float, float, float], ...]


def run(config: schema.ShipRecordsConfig, progress: Reporter, store: Files) -> Result:
    """Predict the whitecaps of every record and compare; see `schema.ShipRecordsConfig`."""
    path = config.path()
    if config.file is None and not path.is_file():
        raise UserError(
            f"There are no ship records at {path}: give a table of them with file=…, or the folder that holds "
            "meteorology/test_36_data.txt in the environment variable JAXOCEAN_DATA."
        )
    progress.step(f"Reading {path.name}")
    ship = io.read_ship_records(path)
    where = _choose(ship, config)
    with jax.enable_x64(True):
        sea = _seas(ship, where, config, progress)
    progress.step("Comparing with the laws")
    block = _blocks(ship.day[where], config.block)
    compared = [
        _compare(name, sea.projected[:, 1], sea.laws[:, i], sea.wind_speed, block, config)
        for i, name in enumerate(config.laws)
    ]
    progress.step("Drawing")
    left_out = _considered(ship, config).size - where.size
    _ship_views.plot(store, sea, ship.peak_speed[where], compared, config)
    _ship_views.save(store, ship, where, sea, config)
    values = _values(sea, ship, where, left_out, compared, config)
    notes = _ship_report.notes(values, config)
    store.text("report.md", _ship_report.report(values, compared, config, notes))
    return Result(values=values, tables=_ship_report.tables(values, compared, config), notes=notes)


def _considered(ship: io.ShipRecords, config: schema.ShipRecordsConfig) -> np.ndarray:
    places = np.arange(ship.wind_speed.size)
    if config.record is None:
        return places
    first, last = config.record if isinstance(config.record, tuple) else (config.record, config.record)
    return places[first : last + 1]


def _choose(ship: io.ShipRecords, config: schema.ShipRecordsConfig) -> np.ndarray:
    """The places of the complete records that a config asks for."""
    considered = _considered(ship, config)
    if considered.size == 0:
        size = ship.wind_speed.size
        raise UserError(
            f"The key `record` asks for {config.record}, but {config.path()} has {size} records (0 to {size - 1})."
        )
    where = considered[ship.complete()[considered]]
    if where.size == 0:
        raise UserError(f"None of the {considered.size} records asked for has wind, height and phase speed.")
    return where


def _seas(
    ship: io.ShipRecords, where: np.ndarray, config: schema.ShipRecordsConfig, progress: Reporter
) -> Sea:
    """All records, a batch at a time."""
    speed = _ten_metres(ship, where, config)
    warmer = ship.sea_temperature[where] - ship.air_temperature[where]
    measured = (
        speed,
        ship.significant_wave_height[where],
        ship.peak_speed[where],
        np.where(np.isfinite(warmer), warmer, 0.0),
    )
    program = _program(config)
    size = min(BATCH, where.size)
    advance = progress.count(f"Integrating {where.size} seas", -(-where.size // size))
    found = []
    for start in range(0, where.size, size):
        # The last one is filled up, so that all batches share one program.
        filled = np.minimum(np.arange(start, start + size), where.size - 1)
        found.append(jax.tree.map(np.asarray, program(*(values[filled] for values in measured))))
        advance()
    return jax.tree.map(lambda *each: np.concatenate(each)[: where.size], *found)


def _ten_metres(ship: io.ShipRecords, where: np.ndarray, config: schema.ShipRecordsConfig) -> np.ndarray:
    """U10 [m/s] of every record, from the height of its own anemometer."""
    drag, speed, height = _build.drag(config.drag), ship.wind_speed[where], ship.wind_height[where]
    found = np.empty_like(speed)
    for one in np.unique(height).tolist():

        def to_ten_metres(u, one=one):
            return jo.Wind.from_meteorological(u, from_degrees=0.0, height=one, drag=drag).speed

        same = height == one
        found[same] = np.asarray(jax.jit(jax.vmap(to_ten_metres))(speed[same]))
    return found


def _program(config: schema.ShipRecordsConfig) -> Callable[..., Sea]:
    """From wind, height and phase speed to the sea and its whitecaps, for many records."""
    limit = None if config.breaking_wavenumber is None else jnp.asarray(config.breaking_wavenumber)
    thresholds = config.threshold + config.threshold_error * jnp.asarray([-1.0, 0.0, 1.0])
    projected, rest = jo.whitecaps.ExactClosure("projected"), jo.whitecaps.ExactClosure("rest")
    found_laws = [_build.law(name) for name in config.laws]
    drag = _build.drag(config.drag)

    def covariance(spectrum: jo.spectra.AbstractSpectrum) -> jax.Array:
        return jo.whitecaps.strain_statistics(
            spectrum, config.choppiness, band=config.band, breaking_wavenumber=limit
        ).covariance

    def one(speed, wave_height, peak_speed, warmer) -> Sea:
        # Towards +x, whatever its direction was: only the angle to the swell counts.
        wind = jo.Wind(speed, drag=drag, sea_air_temperature_difference=warmer)
        parts = jo.spectra.wind_sea_and_swell(
            wind,
            significant_wave_height=wave_height,
            peak_speed=peak_speed,
            swell_direction=wind.direction + config.swell.angle,
            swell_width=config.swell.width,
            swell_spreading=_build.spreading(config.swell.spreading, wind),
            band=config.band,
        )
        oldest = jnp.clip(speed / peak_speed, wind.inverse_wave_age(), jo.spectra.YOUNGEST)

        def wind_sea(omega):
            sea = jo.spectra.Elfouhaily(wind, omega)
            share = wave_height**2 / 16 / jo.spectra.height_variance(sea, band=config.band)
            return jnp.minimum(share, 1.0) * covariance(sea), share

        def swell(angle):
            return covariance(eqx.tree_at(lambda s: s.direction, parts.swell, parts.swell.direction + angle))

        # Independent waves: their covariances add. One closure for all seas, at the middle ε but for the first three.
        (alone, scaled), (share, _) = jax.vmap(wind_sea)(jnp.stack([parts.inverse_wave_age, oldest]))
        along, across = jax.vmap(swell)(jnp.asarray([0.0, 0.5 * jnp.pi]))
        seas = jnp.stack([alone + along, alone + along, alone + along, alone, alone + across, scaled])
        stats = jo.whitecaps.StrainStatistics(jnp.zeros_like(seas[:, 0]), seas)
        coverage = projected(stats, jnp.append(thresholds, jnp.broadcast_to(thresholds[1], 3)))
        both = jo.whitecaps.StrainStatistics(jnp.zeros(3), alone + along)
        return Sea(
            wind_speed=speed,
            inverse_wave_age=parts.inverse_wave_age,
            younger=parts.younger,
            wind_sea_height=wave_height / jnp.sqrt(jnp.maximum(share, 1.0)),
            swell_height=parts.swell.significant_wave_height,
            swell_period=parts.swell.peak_period,
            projected=coverage[:3],
            rest=rest(both, thresholds[1]),
            without_swell=coverage[3],
            swell_across=coverage[4],
            scaled=coverage[5],
            laws=jnp.stack([law.coverage(wind) for law in found_laws]),
        )

    return jax.jit(jax.vmap(one))


def _blocks(day: np.ndarray, length: float) -> np.ndarray:
    """The block of each record; without times, records follow each other every ten minutes."""
    known = np.where(np.isfinite(day), day, np.arange(day.size) / 144.0)
    return np.floor((known - known.min()) / length)


def _compare(
    name: str,
    predicted: np.ndarray,
    law: np.ndarray,
    wind: np.ndarray,
    block: np.ndarray,
    config: schema.ShipRecordsConfig,
) -> Comparison:
    """Rank correlation over all records; bias of log10 W where there are whitecaps to be seen by both."""
    white = (law >= SEEN) & (predicted >= SEEN)
    ratio = np.log10(np.where(white, predicted, 1.0) / np.where(white, law, 1.0))
    inside = [white & (wind >= low) & (wind < high) for low, high in itertools.pairwise(BINS)]

    def numbers(places: np.ndarray) -> np.ndarray:
        ranks = statistics.rankdata(predicted[places]), statistics.rankdata(law[places])
        varies = all(np.ptp(rank) > 0 for rank in ranks)
        means = [_mean(ratio[places], chosen[places]) for chosen in (white, *inside)]
        return np.array([np.corrcoef(*ranks)[0, 1] if varies else np.nan, *means])

    value = numbers(np.arange(predicted.size))
    low, high = block_interval(
        numbers, block, resamples=config.resamples, confidence=config.confidence, seed=config.seed
    )
    triples = tuple(zip(value.tolist(), low.tolist(), high.tolist(), strict=True))
    return Comparison(name, int(white.sum()), triples[0], triples[1], triples[2:])


def _mean(values: np.ndarray, chosen: np.ndarray) -> float:
    return float(np.mean(values[chosen])) if chosen.any() else float("nan")


def _values(
    sea: Sea,
    ship: io.ShipRecords,
    where: np.ndarray,
    left_out: int,
    compared: list[Comparison],
    config: schema.ShipRecordsConfig,
) -> dict[str, Any]:
    """All numbers by names that tell their units."""
    predicted = sea.projected[:, 1]
    with_swell = sea.swell_height > 0
    younger = sea.younger
    values = {
        "records": where.size,
        "records_left_out": left_out,
        "records_with_swell": int(with_swell.sum()),
        "records_younger": int(younger.sum()),
        "swell_share": float(np.mean(sea.wind_speed / ship.peak_speed[where] < 0.84)),
        "wind_ratio": float(np.mean(sea.wind_speed / ship.wind_speed[where])),
        "mean_wind_speed_m_per_s": float(np.mean(sea.wind_speed)),
        "mean_significant_wave_height_m": float(np.mean(ship.significant_wave_height[where])),
        "mean_swell_height_m": float(np.mean(sea.swell_height)),
        "mean_coverage_projected": float(np.mean(predicted)),
        "mean_coverage_rest": float(np.mean(sea.rest)),
        "median_coverage_projected": float(np.median(predicted)),
        "swell_effect_percent": _effect(predicted, sea.without_swell, with_swell),
        "swell_effect_across_percent": _effect(sea.swell_across, sea.without_swell, with_swell),
        "scaled_instead_of_younger_percent": _effect(sea.scaled, predicted, younger),
        "scatter_at_one_wind": _scatter(sea.wind_speed, predicted),
        "threshold": config.threshold,
        "choppiness": config.choppiness,
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
    }
    for one in compared:
        for name, triple in (("rank_correlation", one.rank_correlation), ("bias_log10", one.bias)):
            key = f"{name}_{one.law}"
            values |= {key: triple[0], f"{key}_low": triple[1], f"{key}_high": triple[2]}
    for i, name in enumerate(config.laws):
        values[f"mean_coverage_{name}"] = float(np.mean(sea.laws[:, i]))
    return values


def _effect(changed: np.ndarray, original: np.ndarray, where: np.ndarray) -> float:
    """Median change [%] over some of the records."""
    chosen = where & (original > 0)
    return float(100 * np.median(changed[chosen] / original[chosen] - 1)) if chosen.any() else float("nan")


def _scatter(wind: np.ndarray, coverage: np.ndarray) -> float:
    """Standard deviation of log10 W around its course with the wind, a polynomial of third degree."""
    white = coverage > 0
    if white.sum() < 10:
        return float("nan")
    x, y = np.log(wind[white]), np.log10(coverage[white])
    course = np.polynomial.Polynomial.fit(x, y, 3)
    return float(np.std(y - course(x)))
