"""`calibrate_monahan`: fit ε and λ to whitecap laws, and check the result on realised seas."""

import warnings
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import fitting
import jaxocean as jo
from jaxocean.whitecaps import Measure
from jaxocean.whitecaps.laws import RangeWarning

from . import _build, _calibration_report, _calibration_views, schema
from ._columns import read_columns
from ._files import Files
from ._progress import Reporter
from ._result import Result

CLOSURES = {"exact": jo.whitecaps.ExactClosure, "gaussian": jo.whitecaps.GaussianClosure}
MEASURES: tuple[Measure, ...] = ("projected", "rest")
BATCH = 8
MEMORY, BYTES = 5e8, 24
"""Bytes for the seas of one wind, and what a sample of one needs until its fields are made."""

FIXED = 1e-4
"""Deviation of the prior on a choppiness that is not to move."""


@dataclass(frozen=True)
class Calibration:
    """Everything that one closure says: one threshold for all winds, and one for each wind."""

    shared: fitting.Fit
    per_wind: fitting.Fit


@dataclass(frozen=True)
class Check:
    """Coverage counted on realised seas at the fitted values, beside the closure's."""

    counted: np.ndarray
    error: np.ndarray
    expected: np.ndarray

    @property
    def deviations(self) -> np.ndarray:
        """Counted minus expected, in standard errors."""
        return (self.counted - self.expected) / self.error


def run(config: schema.CalibrationConfig, progress: Reporter, store: Files) -> Result:
    """Calibrate a sea to whitecap laws; see `schema.CalibrationConfig`."""
    with jax.enable_x64(True):
        targets = _targets(config)
    calibrations, table, check = _compute(config, targets, progress)
    progress.step("Drawing")
    view = _calibration_views.View(config, calibrations, table, check)
    _calibration_views.plot(store, view)
    _calibration_views.save(store, view)
    return _calibration_report.report(view)


def _targets(config: schema.CalibrationConfig) -> list[fitting.AbstractTarget]:
    """One target for each law, and one for the measured points."""
    scatter = fitting.FreeScatter(config.scatter) if config.free.scatter else config.scatter
    winds = _winds(config, np.asarray(config.wind.speed))
    with warnings.catch_warnings():
        # The fit's own warnings say it again, once.
        warnings.simplefilter("ignore", RangeWarning)
        targets: list[fitting.AbstractTarget] = [
            fitting.CoverageLaw(_build.law(name), winds, scatter) for name in config.laws
        ]
    if config.points.file is not None:
        columns = read_columns(config.points.file, (config.points.wind, config.points.coverage))
        points = fitting.CoveragePoints.from_columns(
            columns,
            wind=config.points.wind,
            coverage=config.points.coverage,
            percent=config.points.percent,
            scatter=scatter,
        )
        targets.append(eqx.tree_at(lambda p: p.winds, points, _winds(config, np.asarray(points.winds.speed))))
    return targets


def _winds(config: schema.CalibrationConfig, speeds: np.ndarray) -> jo.Wind:
    """The config's wind at each of these speeds, stacked."""
    return eqx.filter_vmap(lambda u: _build.wind(config.wind, speed=u))(jnp.asarray(speeds))


def _model(
    config: schema.CalibrationConfig, closure: str, measure: Measure, **changes: float
) -> fitting.SpectralModel:
    leaves = {"choppiness": config.choppiness, "breaking_wavenumber": config.breaking_wavenumber} | changes
    return fitting.SpectralModel(
        config.threshold,
        leaves["choppiness"],
        spectrum=_build.ConfiguredSea(config.spectrum),
        breaking_wavenumber=leaves["breaking_wavenumber"],
        closure=CLOSURES[closure](measure),
        band=config.band,
        cascade=_build.cascade(config.cascade) if config.band is None else None,
    )


def _calibrate(config: schema.CalibrationConfig, closure: str, targets: list) -> Calibration:
    """One ε (and λ, and k_b) for all winds; then, with these, one ε for each wind."""
    free = _free(config, config.choppiness_prior.deviation)
    if config.free.breaking_wavenumber and config.breaking_wavenumber is not None:
        prior = fitting.LogNormal(config.breaking_wavenumber, 0.5)
        free.append(fitting.Parameter(lambda m: m.breaking_wavenumber, prior=prior))
    model = _model(config, closure, config.measure)
    solve = partial(fitting.fit, solver=_build.solver(config.solver))
    key = jax.random.key(config.seed)
    shared = solve(model, free, targets, starts=config.starts, key=key)
    each = fitting.Parameter(lambda m: m.threshold, per_wind=True)
    return Calibration(shared, solve(shared.model, each, targets))


def _free(config: schema.CalibrationConfig, deviation: float) -> list[fitting.Parameter]:
    """ε, and λ with this much freedom around the centre of its prior."""
    free = [fitting.Parameter(lambda m: m.threshold)]
    if config.free.choppiness:
        prior = fitting.Normal(config.choppiness_prior.mean, deviation)
        free.append(fitting.Parameter(lambda m: m.choppiness, prior=prior))
    return free


def _limits(config: schema.CalibrationConfig) -> list[float]:
    """The breaking wavenumbers of the table that the sea's waves reach."""
    highest = _build.cascade(config.cascade).wavenumber_limit if config.band is None else config.band[1]
    return [k for k in config.breaking_wavenumbers if k <= highest * (1 + 1e-9)]


def _threshold_row(
    config: schema.CalibrationConfig, measure: Measure, limits: list[float], targets: list
) -> list:
    """(k_b, ε, its error, RMS) for one area, with λ where the fit has its prior and one ε for all winds."""
    rows = []
    for k in limits:
        changes = {"choppiness": _calibration_views.table_choppiness(config), "breaking_wavenumber": k}
        model = _model(config, "exact", measure, **changes)
        # λ is held by a narrow prior instead of being fixed: this is the shared fit's compiled program once more.
        fit = fitting.fit(model, _free(config, FIXED), targets, solver=_build.solver(config.solver))
        rms = float(np.sqrt(np.mean(np.concatenate(list(fit.residuals.values())) ** 2)))
        rows.append((k, fit.values["threshold"], fit.errors["threshold"], rms))
    return rows


def _compute(
    config: schema.CalibrationConfig, targets: list, progress: Reporter
) -> tuple[dict[str, Calibration], dict[str, list], Check | None]:
    """All fits, and the check, side by side: most of a first fit is compilation, which keeps one core busy."""
    limits = _limits(config)
    checked = config.realisations > 0 and config.band is None
    parts = len(CLOSURES) + (len(MEASURES) if limits else 0) + (len(config.wind.speed) if checked else 0)
    advance = progress.count("Fitting, and counting whitecaps on FFT seas" if checked else "Fitting", parts)

    def double(task: Callable, *arguments: Any) -> Any:
        with jax.enable_x64(True):
            result = task(*arguments)
        advance()
        return result

    executor = ThreadPoolExecutor(max_workers=2)
    try:
        fits = {name: executor.submit(double, _calibrate, config, name, targets) for name in CLOSURES}
        rows: dict[Measure, Future] = {}
        # The row of the fit's own measure comes last, because it uses the program that the exact fit compiles.
        for measure in sorted(MEASURES, key=lambda m: m == config.measure) if limits else ():
            if measure == config.measure:
                fits["exact"].result()
            rows[measure] = executor.submit(double, _threshold_row, config, measure, limits, targets)
        check = _check(config, fits["exact"].result().shared, advance) if checked else None
        calibrations = {name: future.result() for name, future in fits.items()}
        return calibrations, {m: rows[m].result() if m in rows else [] for m in MEASURES}, check
    finally:
        executor.shutdown(wait=False, cancel_futures=True)


def _check(config: schema.CalibrationConfig, fit: fitting.Fit, advance: Callable[[], None]) -> Check:
    """Count the coverage of realised seas with the shared values, and compare with the closure."""
    cascade = _build.cascade(config.cascade)
    model = jax.tree.map(lambda x: jnp.asarray(x, jnp.float32) if eqx.is_inexact_array(x) else x, fit.model)
    speeds = config.wind.speed
    winds = [_build.wind(config.wind, speed=speed) for speed in speeds]
    keys = jax.random.split(jax.random.key(config.seed), config.realisations)
    # As many seas at once as memory holds; the same random numbers at every wind, so that its points are comparable.
    size = max(1, int(MEMORY / (BYTES * cascade.count * cascade.resolution**2)))
    chunks = [keys[start : start + size] for start in range(0, config.realisations, size)]
    counted = []
    for chunk in chunks:
        noise = jax.lax.map(partial(jo.surface.draw_noise, cascade), chunk, batch_size=BATCH)

        def count(wind: jo.Wind, noise=noise) -> np.ndarray:
            return np.asarray(_count(model, wind, cascade, noise, config.measure, config.shifts), float)

        # The first wind compiles; of the others two go side by side, since a sea by itself does not fill two cores.
        values = [count(winds[0])]
        with ThreadPoolExecutor(max_workers=2) as pool:
            values += pool.map(count, winds[1:])
        counted.append(np.stack(values))
    for _ in winds:
        advance()
    with jax.enable_x64(True):
        expected = [float(fit.model.coverage(_build.wind(config.wind, speed=speed))) for speed in speeds]
    seas = np.concatenate(counted, axis=1)
    return Check(seas.mean(axis=1), seas.std(axis=1, ddof=1) / np.sqrt(seas.shape[1]), np.asarray(expected))


@eqx.filter_jit
def _count(model: fitting.SpectralModel, wind: jo.Wind, cascade, noise, measure: Measure, shifts: int):
    spectrum = model.spectrum(wind)
    # All seas at once up to their amplitudes, so that the spectrum is sampled once; then one after the other.
    seas = eqx.filter_vmap(lambda one: jo.surface.realise(spectrum, cascade, noise=one))(noise)
    arrays, rest = eqx.partition(seas, eqx.is_array)

    def coverage(one):
        fields = eqx.combine(one, rest).fields(0.0, model.choppiness, model.breaking_wavenumber)
        return jo.whitecaps.realised_coverage(fields.strain, model.threshold, measure=measure, shifts=shifts)

    return jax.lax.map(coverage, arrays)
