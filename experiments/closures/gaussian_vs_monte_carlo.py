"""`gaussian_vs_monte_carlo`: is the Jacobian Gaussian? What three closures say, and what counting says."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo

from .. import schema
from ..common import _build, _counting
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _gaussian_report, _gaussian_views
from ._gaussian_views import Closed, Comparison, Curves

BINS, FINE = 160, 241


def run(config: schema.GaussianVsMonteCarloConfig, progress: Reporter, store: Files) -> Result:
    """Compare closures with counts; see `schema.GaussianVsMonteCarloConfig`."""
    progress.step("Integrating the spectra")
    with jax.enable_x64(True):
        # The closures in double precision; for counting single precision is enough.
        stats = [_build.strain_statistics(config, speed) for speed in config.wind.speed]
        edges = _edges(stats)
        centres = 0.5 * (edges[1:] + edges[:-1])
        closed = [
            jax.tree.map(np.asarray, _close(each, np.asarray(config.thresholds), centres, config.measure))
            for each in stats
        ]
    seas = []
    for i, speed in enumerate(config.wind.speed):
        draws = _draw(config, i, stats[i], edges, progress)
        realised = _realise(config, i, progress)
        seas.append(Comparison(speed, closed[i], draws, realised))
    progress.step("Drawing")
    _gaussian_views.plot_coverage(store, seas, config)
    _gaussian_views.plot_densities(store, seas, centres)
    _gaussian_views.save(store, seas, centres, config)
    return _gaussian_report.report(store, seas, config)


def _edges(stats: list[jo.whitecaps.StrainStatistics]) -> np.ndarray:
    """Edges of the bins of j, wide enough for the roughest sea."""
    deviation = max(float(each.jacobian_variance()) for each in stats) ** 0.5
    return np.linspace(1 - 6 * deviation, 1 + 8 * deviation, BINS + 1)


@eqx.filter_jit
def _close(stats: jo.whitecaps.StrainStatistics, thresholds, centres, measure) -> Closed:
    """What the library says without sampling."""
    published = jo.whitecaps.PublishedClosure()
    closures = (jo.whitecaps.ExactClosure(measure), jo.whitecaps.GaussianClosure(measure), published)

    # All thresholds in one call of each closure, compiled once.
    levels = jnp.concatenate([thresholds, jnp.linspace(thresholds[0], thresholds[-1], FINE)])
    exact, gaussian, printed = (jax.vmap(lambda x, c=c: c.log(stats, x))(levels) for c in closures)
    everywhere = Curves(
        levels, jnp.exp(exact), jnp.exp(gaussian), jnp.exp(printed), ratio=jnp.exp(gaussian - exact)
    )
    # The coverage of the plane at rest is the distribution function of j: its derivative is the density.
    densities = [
        jax.vmap(jax.grad(lambda level, closure=closure: closure(stats, level)))(centres)
        for closure in (jo.whitecaps.ExactClosure("rest"), jo.whitecaps.GaussianClosure("rest"))
    ]
    return Closed(
        at=jax.tree.map(lambda each: each[:-FINE], everywhere),
        fine=jax.tree.map(lambda each: each[-FINE:], everywhere),
        published_variance=published.moments(stats)[1],
        variance=stats.jacobian_variance(),
        skewness=stats.jacobian_skewness(),
        density=densities[0],
        gaussian_density=densities[1],
    )


def _draw(config, index: int, stats, edges: np.ndarray, progress: Reporter) -> _counting.Draws:
    count, _ = _counting.batches(config.draws)
    what = f"Monte Carlo at {config.wind.speed[index]:g} m/s: {config.draws:.3g} draws"
    return _counting.draw(
        stats,
        np.asarray(config.thresholds),
        edges,
        draws=config.draws,
        measure=config.measure,
        key=jax.random.fold_in(jax.random.key(config.seed), 2 * index),
        advance=progress.count(what, count),
    )


def _realise(config, index: int, progress: Reporter) -> _counting.Counted:
    speed = config.wind.speed[index]
    what = f"FFT seas at {speed:g} m/s"
    return _counting.realise(
        _build.spectrum(config.spectrum, _build.wind(config.wind, speed=speed)),
        _build.cascade(config.cascade),
        np.asarray(config.thresholds),
        choppiness=config.choppiness,
        breaking_wavenumber=config.breaking_wavenumber,
        realisations=config.realisations,
        shifts=config.shifts,
        measure=config.measure,
        key=jax.random.fold_in(jax.random.key(config.seed), 2 * index + 1),
        advance=progress.count(what, _counting.groups_of(config.realisations)),
    )
