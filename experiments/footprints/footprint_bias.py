"""`footprint_bias`: how wrong closures are in footprints of every size, and how normal the sea is inside them."""

from concurrent.futures import ThreadPoolExecutor, as_completed

import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo

from .. import schema
from ..common import _build, _tiles
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import (
    _footprint_data,
    _footprint_errors,
    _footprint_report,
    _footprint_storage,
    _footprint_views,
    _normality,
)
from ._footprint_views import Found, Sea

AT_ONCE = 2
"""Seas that are worked on together: much of it runs on one core."""

WITHIN = 0.25
LEVELS = np.linspace(0.0, 1.0, 401)


def run(config: schema.FootprintBiasConfig, progress: Reporter, store: Files) -> Result:
    """Hold closures against counted footprints; see `schema.FootprintBiasConfig`."""
    tile = _tiles.Tile(config.tile.points, config.tile.spacing)
    progress.step("Integrating the spectra")
    planes = [_whole_plane(config, speed) for speed in config.wind.speed]
    advance = progress.count("Footprints of seas", len(config.wind.speed) * config.realisations)
    seas = []
    with ThreadPoolExecutor(AT_ONCE) as pool:
        for w, speed in enumerate(config.wind.speed):
            numbers = range(w * config.realisations, (w + 1) * config.realisations)
            futures = [pool.submit(_measure, config, speed, number, tile) for number in numbers]
            for future in as_completed(futures):
                future.result()
                advance()
            errors, shapes = zip(*(future.result() for future in futures), strict=True)
            seas.append(Sea(speed, *planes[w], list(errors), np.stack(shapes)))
    progress.step("Rounding pyramids")
    last = len(config.wind.speed) * config.realisations - 1
    fields = _fields(config, config.wind.speed[-1], last)
    storage = _footprint_storage.compare(fields, _build.cascade(config.cascade), config.thresholds[-1], tile)
    progress.step("Drawing")
    found = Found(tile, tuple(config.thresholds), tuple(seas), storage)
    _footprint_views.plot_bias(store, found)
    _footprint_views.plot_normality(store, found)
    _footprint_data.save(store, found, config)
    return _footprint_report.report(store, found, config)


def _fields(config: schema.FootprintBiasConfig, speed: float, number: int) -> jo.surface.Fields:
    """One sea on its patterns."""
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind, speed=speed))
    key = jax.random.fold_in(jax.random.key(config.seed), number)
    sea = jo.surface.realise(spectrum, _build.cascade(config.cascade), key=key)
    return sea.fields(0.0, config.choppiness, config.breaking_wavenumber)


def _measure(
    config: schema.FootprintBiasConfig, speed: float, number: int, tile: _tiles.Tile
) -> tuple[_footprint_errors.Errors, np.ndarray]:
    """Errors of the closures on one sea, and how normal it is in footprints."""
    cascade, fields = _build.cascade(config.cascade), _fields(config, speed, number)
    footprints = _tiles.gather(fields.strain, cascade, tile)
    errors = _footprint_errors.measure(footprints, fields, cascade, tile, config.thresholds)
    slope = sum(_tiles.sample(fields.slope, cascade, tile), start=jnp.zeros((), fields.slope.dtype))
    return errors, _normality.measure(slope, footprints.strain, tile)


def _whole_plane(config: schema.FootprintBiasConfig, speed: float) -> tuple[np.ndarray, float, float]:
    """Exact coverage of the whole plane, the skewness of its j, and the ε above which Gaussian j is good enough."""
    with jax.enable_x64(True):
        stats = _build.strain_statistics(config, speed)
        exact, gaussian = jo.whitecaps.ExactClosure("rest"), jo.whitecaps.GaussianClosure("rest")
        coverage = np.asarray(exact(stats, jnp.asarray(config.thresholds)))
        levels = jnp.asarray(LEVELS)
        logs = [np.asarray(jax.vmap(lambda x, c=c: c.log(stats, x))(levels)) for c in (gaussian, exact)]
        ratio = np.exp(logs[0] - logs[1])
        wrong = np.flatnonzero(np.abs(ratio - 1) > WITHIN)
        trusted = float(LEVELS[min(wrong[-1] + 1, len(LEVELS) - 1)]) if wrong.size else float(LEVELS[0])
        return coverage, float(stats.jacobian_skewness()), trusted
