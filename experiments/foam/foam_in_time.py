"""`foam_in_time`: whitecaps outlive breaking. Active and total coverage on a world tile, and without it."""

import math
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix

import fitting
import jaxocean as jo
from jaxocean.whitecaps import Measure, foam
from jaxocean.whitecaps.laws import RangeWarning

from .. import schema
from ..common import _build
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _foam_data, _foam_map, _foam_report, _foam_views
from ._foam_events import Events, follow, read_measured
from ._foam_results import Calibration, Growth, Picture, Points, View

MEASURES: tuple[Measure, ...] = ("rest", "projected")

START = 3.0
"""Decay time [s] where its fit begins."""

HORIZON = 12.0
"""Longest lag of the recurrence of breaking in decay times."""


FINEST = 2048
"""Points along the tile that is drawn, at most."""

EVERY = 5
"""Steps between counts of coverage at all decay times."""


def run(config: schema.FoamInTimeConfig, progress: Reporter, store: Files) -> Result:
    """Calibrate ε and τ, then let foam live on a tile; see `schema.FoamInTimeConfig`."""
    measured = None if (path := config.events_file()) is None else read_measured(path)
    _check_tile(config)
    with jax.enable_x64(True):
        calibration = _calibrate(config, progress)
    growths = _grow_all(config, calibration, progress)
    progress.step("Drawing")
    view = View(config, calibration, growths, measured)
    _foam_views.plot(store, view)
    _foam_map.plot_map(store, view)
    _foam_data.save(store, view)
    result = _foam_report.report(view)
    store.text("report.md", _foam_report.markdown(view, result))
    return result


def _cascade(config: schema.FoamInTimeConfig) -> jo.surface.Cascade:
    return jo.surface.tiling_cascade(_build.cascade(config.cascade), config.tile.size)


def _winds(config: schema.FoamInTimeConfig, speeds: Any) -> jo.Wind:
    return eqx.filter_vmap(lambda u: _build.wind(config.wind, speed=u))(jnp.asarray(speeds))


def _target(config: schema.FoamInTimeConfig, law: str) -> fitting.CoverageLaw:
    with warnings.catch_warnings():
        # The fit's own warnings say it again, once.
        warnings.simplefilter("ignore", RangeWarning)
        return fitting.CoverageLaw(_build.law(law), _winds(config, config.wind.speed))


def _calibrate(config: schema.FoamInTimeConfig, progress: Reporter) -> Calibration:
    """ε from the active law, then τ from the total law: shared, for each wind, and for other k_b; closed forms."""
    winds = _winds(config, config.wind.speed)
    progress.step("Calibrating the threshold to the active law")
    active, threshold = _fit_threshold(
        config, _active_model(config, config.breaking_wavenumber, _waves(config))
    )
    progress.step("Calibrating the decay time to the total law")
    total, decay_time = _fit_decay_time(config, active)
    if config.decay_time is not None:
        total = eqx.tree_at(lambda m: m.decay_time, total, jnp.asarray(config.decay_time))
    points = _points(total, winds, jnp.full(winds.speed.shape, active.threshold))
    progress.step("Closed forms at every decay time")
    tau = jnp.asarray(sorted({*config.decay_times, float(total.decay_time)}))
    closed = {
        (name, measure): np.asarray(eqx.filter_vmap(closure(measure), in_axes=(0, None))(points, tau))
        for name, closure in (("renewal", foam.RenewalFoam), ("poisson", foam.PoissonFoam))
        for measure in MEASURES
    }
    progress.step("A threshold and a decay time for each wind")
    each = fitting.Parameter(lambda m: m.threshold, per_wind=True)
    own = fitting.fit(active, each, _target(config, config.active_law)).values["threshold"]
    total_law = _law(config, config.total_law)
    progress.step("Decay times against the breaking wavenumber")
    return Calibration(
        threshold=threshold,
        decay_time=decay_time,
        used=(float(active.threshold), float(total.decay_time)),
        own_threshold=np.asarray(own),
        own_decay_time=np.asarray(
            _decay_times(_points(total, winds, jnp.asarray(own)), jnp.asarray(total_law))
        ),
        points=Points.of(points),
        decay_times=np.asarray(tau),
        closed=closed,
        active_law=_law(config, config.active_law),
        total_law=total_law,
        table=_table(config, winds),
    )


@eqx.filter_jit
def _points(model: fitting.TotalCoverageModel, winds: jo.Wind, thresholds: jax.Array) -> foam.PointBreaking:
    """How a point breaks in each wind at its own ε."""

    def prepare(wind: jo.Wind, threshold: jax.Array) -> foam.PointBreaking:
        return eqx.tree_at(lambda m: m.active.threshold, model, threshold).prepare(wind)

    return eqx.filter_vmap(prepare)(winds, thresholds)


@eqx.filter_jit
def _decay_times(points: foam.PointBreaking, coverage: jax.Array) -> jax.Array:
    """The τ at which each wind has a given total coverage; NaN where none between 1 ms and 1000 s does."""

    def solve(point: foam.PointBreaking, wanted: jax.Array) -> jax.Array:
        def excess(log_tau: jax.Array, _: None) -> jax.Array:
            return foam.RenewalFoam()(point, jnp.exp(log_tau)) - wanted

        ends = {"lower": jnp.log(1e-3), "upper": jnp.log(1e3)}
        bisection = optimistix.Bisection(rtol=1e-9, atol=1e-9)
        start = jnp.asarray(np.log(START), wanted.dtype)
        found = optimistix.root_find(excess, bisection, start, options=ends, throw=False)
        there = (excess(ends["lower"], None) < 0) & (excess(ends["upper"], None) > 0)
        return jnp.where(there, jnp.exp(found.value), jnp.nan)

    return eqx.filter_vmap(solve)(points, coverage)


def _law(config: schema.FoamInTimeConfig, name: str) -> np.ndarray:
    return np.asarray(jax.vmap(_build.law(name).coverage)(_winds(config, config.wind.speed)))


def _waves(config: schema.FoamInTimeConfig) -> dict[str, Any]:
    """The waves of the tile, as the models want them."""
    cascade, limit = _cascade(config), config.breaking_wavenumber
    if isinstance(config.choppiness, tuple) or limit is None or limit > cascade.wavenumber_limit:
        return {"cascade": cascade}
    # Beyond k_b nothing is seen: the wider band is the same sea, and its fits share the table's programs.
    return {"band": _whole_band(config)}


def _whole_band(config: schema.FoamInTimeConfig) -> tuple[float, float]:
    lower, upper = _cascade(config).band
    return lower, max(upper, *config.breaking_wavenumbers, 0.0)


def _active_model(config, breaking_wavenumber: float | None, waves: dict[str, Any]) -> fitting.SpectralModel:
    return fitting.SpectralModel(
        0.6 if config.threshold is None else config.threshold,
        jnp.asarray(config.choppiness),
        spectrum=_build.ConfiguredSea(config.spectrum),
        breaking_wavenumber=breaking_wavenumber,
        **waves,
    )


def _fit_threshold(config, model: fitting.SpectralModel) -> tuple[fitting.SpectralModel, fitting.Fit | None]:
    if config.threshold is not None:
        return model, None
    fit = fitting.fit(model, lambda m: m.threshold, _target(config, config.active_law))
    return fit.model, fit


def _fit_decay_time(config, active: fitting.SpectralModel) -> tuple[fitting.TotalCoverageModel, fitting.Fit]:
    horizon = HORIZON * max(*config.decay_times, config.decay_time or START)
    model = fitting.TotalCoverageModel(
        active, START, horizon=horizon, dispersion=_build.dispersion(config.spectrum)
    )
    # log W is nearly straight in log τ: undamped steps are few, where damped ones may stall on rounding.
    solver = fitting.GaussNewton()
    fit = fitting.fit(model, lambda m: m.decay_time, _target(config, config.total_law), solver=solver)
    return fit.model, fit


def _table(config: schema.FoamInTimeConfig, winds: jo.Wind) -> list[tuple[float, ...]]:
    """For each k_b: ε, τ and its error, and for how long a point breaks in the first and the last wind."""
    rows = []
    if isinstance(config.choppiness, tuple):
        return rows
    for k in config.breaking_wavenumbers:
        active, _ = _fit_threshold(config, _active_model(config, k, {"band": _whole_band(config)}))
        model, fit = _fit_decay_time(config, active)
        lasts = np.asarray(_points(model, winds, jnp.full(winds.speed.shape, active.threshold)).duration)
        found = fit.values["decay_time"], fit.errors["decay_time"]
        rows.append((k, float(active.threshold), *map(float, found), float(lasts[0]), float(lasts[-1])))
    return rows


class Observer(eqx.Module):
    """Keeps of each step the coverages, every so often total rest coverage at all decay times, and what breaks."""

    decay_times: jax.Array

    def __call__(self, moment: foam.Moment) -> tuple[foam.Coverage, jax.Array, jax.Array]:
        def count() -> jax.Array:
            # With a hard threshold the age tells the coverage at any τ.
            age = jnp.where(moment.foam.coverage > 0, moment.foam.age, jnp.inf)
            return jax.lax.map(lambda tau: jnp.mean(jnp.exp(-age / tau)), self.decay_times)

        due = jnp.round(moment.time / moment.step) % EVERY == 0
        totals = jax.lax.cond(due, count, lambda: jnp.full_like(self.decay_times, jnp.nan))
        return foam.observe_coverage(moment), totals, moment.jacobian < moment.model.threshold


def _grow_all(config, calibration: Calibration, progress: Reporter) -> list[Growth]:
    """All seas of all winds, two at a time."""
    spin = math.ceil(config.spin_up * float(calibration.decay_times[-1]) / config.step / config.chunk - 1e-9)
    chunks = spin + math.ceil(config.duration / config.step / config.chunk - 1e-9)
    jobs = [(i, sea) for i in range(len(config.wind.speed)) for sea in range(config.seas)]
    advance = progress.count("Foam on tiles", chunks * len(jobs))

    def grow(job: tuple[int, int]) -> tuple[np.ndarray, Events, Picture | None]:
        return _grow(config, calibration, *job, spin, chunks, advance)

    # The first one compiles for all.
    first = grow(jobs[0])
    with ThreadPoolExecutor(max_workers=2) as pool:
        grown = [first, *pool.map(grow, jobs[1:])]
    return [
        Growth.of_seas(
            [one for job, one in zip(jobs, grown, strict=True) if job[0] == i], spin * config.chunk
        )
        for i in range(len(config.wind.speed))
    ]


def _grow(
    config, calibration: Calibration, index: int, sea: int, spin: int, chunks: int, advance: Callable
) -> tuple[np.ndarray, Events, Picture | None]:
    """One sea from bare water on: series, the events of one window, and the last picture."""
    speed = config.wind.speed[index]
    tile = _tile(config, speed, jax.random.fold_in(jax.random.key(config.seed), config.seas * index + sea))
    model = foam.FoamModel(*calibration.used)
    observe = Observer(jnp.asarray(calibration.decay_times.tolist()))
    state = foam.Foam.bare(config.tile.resolution, config.tile.resolution)
    series, events = [], Events(np.zeros(0), np.zeros(0))
    for chunk in range(chunks):
        state, (coverage, totals, breaks) = foam.evolve(
            state,
            tile,
            model,
            start=jnp.asarray(chunk * config.chunk * config.step),
            step=jnp.asarray(config.step),
            count=config.chunk,
            choppiness=config.choppiness,
            breaking_wavenumber=config.breaking_wavenumber,
            observe=observe,
        )
        series.append(np.column_stack([*coverage, totals]))
        if chunk == spin:
            events = follow(np.asarray(breaks), config.step)
        advance()
    drawn = config.wind.speed[-1] if config.drawn_wind is None else config.drawn_wind
    picture = _picture(config, tile, model, chunks) if sea == 0 and speed == drawn else None
    return np.concatenate(series), events, picture


def _tile(config, speed: float, key) -> jo.surface.WorldTile:
    sea = jo.surface.realise(
        _build.spectrum(config.spectrum, _build.wind(config.wind, speed=speed)),
        _cascade(config),
        key=key,
        dispersion=_build.dispersion(config.spectrum),
    )
    return jo.surface.WorldTile(sea, config.tile.resolution, config.tile.size)


def _check_tile(config: schema.FoamInTimeConfig) -> None:
    """Raise what the tile would raise, before anything is computed."""

    def strain(key: jax.Array) -> jax.Array:
        tile = _tile(config, config.wind.speed[0], key)
        return tile.strain(0.0, config.choppiness, config.breaking_wavenumber)

    eqx.filter_eval_shape(strain, jax.random.key(0))


def _picture(config, tile: jo.surface.WorldTile, model: foam.FoamModel, chunks: int) -> Picture:
    """The foam of the last window, on a lattice twice as fine."""
    n = min(2 * tile.resolution, FINEST)
    fine = jo.surface.WorldTile(tile.sea, n, tile.size)
    time = chunks * config.chunk * config.step
    state, _ = foam.evolve(
        foam.Foam.bare(n, n),
        fine,
        model,
        start=jnp.asarray(time - config.chunk * config.step),
        step=jnp.asarray(config.step),
        count=config.chunk,
        choppiness=config.choppiness,
        breaking_wavenumber=config.breaking_wavenumber,
        observe=_nothing,
    )
    return Picture(
        time,
        coverage=np.asarray(state.coverage),
        age=np.asarray(state.age),
        displacement=np.asarray(fine.displacement(time, config.choppiness)),
        height=np.asarray(fine.height(time)),
    )


def _nothing(moment: foam.Moment) -> None:
    """Keeps nothing of a step."""
    del moment
