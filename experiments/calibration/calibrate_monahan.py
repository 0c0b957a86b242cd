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
from jaxtyping import Array, Complex, PRNGKeyArray

import fitting
import jaxocean as jo
from jaxocean.whitecaps import Measure
from jaxocean.whitecaps.laws import RangeWarning

from .. import schema
from ..common import _build
from ..common._columns import Allowed, read_columns
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _calibration_data, _calibration_report, _calibration_views
from ._calibration_views import View

CLOSURES = {"exact": jo.whitecaps.ExactClosure, "gaussian": jo.whitecaps.GaussianClosure}
MEASURES: tuple[Measure, ...] = ("projected", "rest")
BATCH = 8
MEMORY, BYTES = 5e8, 8
"""Bytes for the noise of the seas that are drawn at once, and for one of its complex numbers."""

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
    view = _compute(config, targets, progress)
    progress.step("Drawing")
    _calibration_views.plot(store, view)
    _calibration_data.save(store, view)
    return _calibration_report.report(store, view)


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
        columns = _points(config.points)
        points = fitting.CoveragePoints.from_columns(
            columns,
            wind=config.points.wind,
            coverage=config.points.coverage,
            percent=config.points.percent,
            scatter=scatter,
        )
        targets.append(eqx.tree_at(lambda p: p.winds, points, _winds(config, np.asarray(points.winds.speed))))
    return targets


def _points(points: schema.PointsConfig) -> dict[str, list[float]]:
    """Measured winds and coverage; what cannot be true is named with its line."""
    assert points.file is not None
    if points.percent:
        share = Allowed("percentages greater than 0 and at most 100", 100.0)
    else:
        share = Allowed("fractions greater than 0 and at most 1 (points.percent=true: percentages)", 1.0)
    speed = Allowed("a wind speed greater than 0 m/s")
    return read_columns(
        points.file, (points.wind, points.coverage), {points.wind: speed, points.coverage: share}
    )


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


def _fit_shared(config: schema.CalibrationConfig, closure: str, targets: list) -> fitting.Fit:
    """One ε (and λ, and k_b) for all winds."""
    free = _free(config, config.choppiness_prior.deviation)
    if config.free.breaking_wavenumber and config.breaking_wavenumber is not None:
        prior = fitting.LogNormal(config.breaking_wavenumber, 0.5)
        free.append(fitting.Parameter(lambda m: m.breaking_wavenumber, prior=prior))
    model = _model(config, closure, config.measure)
    key = jax.random.key(config.seed)
    return fitting.fit(
        model, free, targets, solver=_build.solver(config.solver), starts=config.starts, key=key
    )


def _fit_each(config: schema.CalibrationConfig, shared: "Future[fitting.Fit]", targets: list) -> Calibration:
    """With the shared fit's other values, one ε for each wind."""
    fit = shared.result()
    each = fitting.Parameter(lambda m: m.threshold, per_wind=True)
    return Calibration(fit, fitting.fit(fit.model, each, targets, solver=_build.solver(config.solver)))


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


def _compute(config: schema.CalibrationConfig, targets: list, progress: Reporter) -> View:
    """All fits, and the check, side by side: most of a first fit is compilation, which keeps one core busy."""
    limits = _limits(config)
    checked = config.realisations > 0 and config.band is None
    parts = 2 * len(CLOSURES) + (len(MEASURES) if limits else 0) + (len(config.wind.speed) if checked else 0)
    advance = progress.count("Fitting, and counting whitecaps on FFT seas" if checked else "Fitting", parts)

    def double(task: Callable, *arguments: Any) -> Any:
        with jax.enable_x64(True):
            result = task(*arguments)
        advance()
        return result

    executor = ThreadPoolExecutor(max_workers=2)
    try:
        shared = {name: executor.submit(double, _fit_shared, config, name, targets) for name in CLOSURES}
        seas = _Seas(config) if checked else None
        rows: dict[Measure, Future] = {}
        # The row of the fit's own measure comes last, because it uses the program that the exact fit compiles.
        for measure in sorted(MEASURES, key=lambda m: m == config.measure) if limits else ():
            rows[measure] = executor.submit(double, _threshold_row, config, measure, limits, targets)
        fits = {name: executor.submit(double, _fit_each, config, shared[name], targets) for name in CLOSURES}
        check = seas.check(shared["exact"].result(), advance) if seas else None
        calibrations = {name: future.result() for name, future in fits.items()}
        table = {m: rows[m].result() if m in rows else [] for m in MEASURES}
        return View(config, calibrations, table, check)
    finally:
        executor.shutdown(wait=False, cancel_futures=True)


class _Seas:
    """Realised seas on which a fit is checked: the same random numbers at every wind, so that it compares."""

    def __init__(self, config: schema.CalibrationConfig) -> None:
        self.config = config
        self.cascade = _build.cascade(config.cascade)
        keys = jax.random.split(jax.random.key(config.seed), config.realisations)
        # As much noise at once as memory holds. The first are drawn in the background, while the fit is traced.
        size = max(1, int(MEMORY / (BYTES * self.cascade.count * self.cascade.resolution**2)))
        self.chunks = [keys[start : start + size] for start in range(0, config.realisations, size)]
        self.first = _draw(self.cascade, self.chunks[0])

    def check(self, fit: fitting.Fit, advance: Callable[[], None]) -> Check:
        """Count the coverage with the shared values, and compare with the closure."""
        config = self.config
        model = jax.tree.map(
            lambda x: jnp.asarray(x, jnp.float32) if eqx.is_inexact_array(x) else x, fit.model
        )
        winds = [_build.wind(config.wind, speed=speed) for speed in config.wind.speed]
        counted = []
        for number, chunk in enumerate(self.chunks):
            noise = _draw(self.cascade, chunk) if number else self.first

            def count(wind: jo.Wind, noise=noise, last=chunk is self.chunks[-1]) -> np.ndarray:
                seas = np.asarray(
                    _count(model, wind, self.cascade, noise, config.measure, config.shifts), float
                )
                if last:
                    advance()
                return seas

            # The first wind compiles; of the others two go side by side: one sea does not fill two cores.
            values = [count(winds[0])]
            with ThreadPoolExecutor(max_workers=2) as pool:
                values += pool.map(count, winds[1:])
            counted.append(np.stack(values))
        seas = np.concatenate(counted, axis=1)
        expected = _calibration_views.fitted_coverage(config, fit)
        return Check(seas.mean(axis=1), seas.std(axis=1, ddof=1) / np.sqrt(seas.shape[1]), expected)


@eqx.filter_jit
def _draw(cascade: jo.surface.Cascade, keys: PRNGKeyArray) -> Complex[Array, "sea pattern y x"]:
    return jax.lax.map(partial(jo.surface.draw_noise, cascade), keys, batch_size=BATCH)


@eqx.filter_jit
def _count(model: fitting.SpectralModel, wind: jo.Wind, cascade, noise, measure: Measure, shifts: int):
    spectrum = model.spectrum(wind)

    def coverage(one: Array) -> Array:
        # The compiler takes what all seas share, the sampled spectrum, out of the loop.
        sea = jo.surface.realise(spectrum, cascade, noise=one)
        strain = sea.strains(0.0, model.choppiness, model.breaking_wavenumber)
        return jo.whitecaps.realised_coverage(strain, model.threshold, measure=measure, shifts=shifts)

    return jax.lax.map(coverage, noise)
