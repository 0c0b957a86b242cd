"""`calibration_uncertainty`: the errors of a calibration against its posterior, its profiles, and known truths."""

import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import jax
import numpy as np

import fitting
from jaxocean.whitecaps.laws import RangeWarning

from .. import schema
from ..common import _build, _calibrated_sea
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _uncertainty_report, _uncertainty_views
from ._uncertainty_views import View

NO_PRIOR = 1e3
"""Deviation of a prior that says nothing: the same program as with one that does."""

CAREFUL = 0.95
"""Acceptance of the sampler where the prior is weak: small steps for a posterior that narrows towards λ = 0."""

EDGES = (0.05, 2.95)
"""Where λ is profiled without a prior: nearly all of its range from 0 to 3."""

DEEPEST = -1.0
"""The lowest ε of that profile."""


def run(config: schema.UncertaintyConfig, progress: Reporter, store: Files) -> Result:
    """Sample, profile and repeat a calibration; see `schema.UncertaintyConfig`."""
    posteriors, profiles, repeated = _compute(config, progress)
    view = View(config, posteriors, profiles, repeated)
    progress.step("Drawing the figure")
    _uncertainty_views.plot(store, view)
    _uncertainty_views.save(store, view)
    return _uncertainty_report.report(store, view)


def _compute(
    config: schema.UncertaintyConfig, progress: Reporter
) -> tuple[dict[str, fitting.Posterior], dict[str, dict[str, fitting.Profile]], fitting.CoverageProbability]:
    """All parts, two at a time: most of a first run is compilation, which keeps one core busy."""
    with jax.enable_x64(True):
        known, unknown = _target(config, config.scatter), _target(config, fitting.FreeScatter(config.scatter))
        model = _calibrated_sea.model(config)
        prior, weak, none = (
            _calibrated_sea.free(config, width)
            for width in (config.choppiness_prior.deviation, config.weak_deviation, NO_PRIOR)
        )
    chunks = -(-config.sets // fitting.SETS_AT_ONCE) + config.sampled
    advance = progress.count("Sampling, profiling, and repeating the calibration", 3 + 6 + chunks)

    def double(task: Callable, *arguments: Any, **options: Any) -> Any:
        with jax.enable_x64(True):
            result = task(*arguments, **options)
        advance()
        return result

    sample = partial(
        double,
        fitting.posterior,
        model,
        chains=config.chains,
        draws=config.draws,
        warmup=config.warmup,
        key=jax.random.key(config.seed),
    )
    executor = ThreadPoolExecutor(max_workers=2)
    try:
        free_scatter = executor.submit(sample, prior, unknown)
        first = executor.submit(sample, prior, known).result()
        # These use the programs that the first one has compiled, in part.
        loose = executor.submit(sample, weak, known, acceptance=CAREFUL)
        profiles = executor.submit(
            _profiles, config, double, model, {"prior": prior, "weak": weak, "none": none}, known
        )
        truth = first.fit.model
        repeated = fitting.coverage_probability(
            truth,
            prior,
            known,
            sets=config.sets,
            sampled=config.sampled,
            warmup=config.warmup,
            key=jax.random.key(config.seed),
            advance=advance,
        )
        posteriors = {"prior": first, "weak": loose.result(), "scatter": free_scatter.result()}
        return posteriors, profiles.result(), repeated
    finally:
        executor.shutdown(wait=False, cancel_futures=True)


def _target(config: schema.UncertaintyConfig, scatter: Any) -> fitting.CoverageLaw:
    with warnings.catch_warnings():
        # The fit's own warnings say it again.
        warnings.simplefilter("ignore", RangeWarning)
        return fitting.CoverageLaw(_build.law(config.law), _calibrated_sea.winds(config), scatter)


def _profiles(
    config: schema.UncertaintyConfig, double: Callable, model: Any, frees: dict[str, list], target: Any
) -> dict[str, dict[str, fitting.Profile]]:
    """ε and λ, with the prior, with a weak one and without any."""
    # As many values as the default grids have beside the best one: one program for all.
    wide = {
        "threshold": np.linspace(DEEPEST, 0.99, config.points - 1),
        "choppiness": np.linspace(*EDGES, config.points - 1),
    }
    return {
        kind: {
            name: double(
                fitting.profile,
                model,
                free,
                target,
                parameter=name,
                grid=wide[name] if kind == "none" else None,
                points=config.points,
            )
            for name in wide
        }
        for kind, free in frees.items()
    }
