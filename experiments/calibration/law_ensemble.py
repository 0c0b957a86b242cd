"""`law_ensemble`: one sea calibrated to one whitecap law after the other; how far the answers lie apart."""

import jax

import fitting

from .. import schema
from ..common import _build, _calibrated_sea
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _ensemble_report, _ensemble_views
from ._ensemble_views import View

FIXED = 1e-4
"""Deviation of the prior on a choppiness that is not to move: the same program as with a real prior."""


def run(config: schema.LawEnsembleConfig, progress: Reporter, store: Files) -> Result:
    """Calibrate to each law; see `schema.LawEnsembleConfig`."""
    names = config.laws or tuple(_build.LAWS)
    progress.step(f"Calibrating to {len(names)} laws")
    with jax.enable_x64(True):
        laws = [_build.law(name) for name in names]
        free, held = (_calibrate(config, laws, width) for width in (config.choppiness_prior.deviation, FIXED))
        progress.step("Drawing ε and λ from the errors of each fit")
        foamy = [member.law.foam != "active" for member in free.members]
        whole = free.only(foamy if any(foamy) else [True] * len(foamy))
        band = whole.band(config.draws, jax.random.key(config.seed), config.level)
    view = View(config, free, held, whole, band)
    progress.step("Drawing the figure")
    _ensemble_views.plot(store, view)
    _ensemble_views.save(store, view)
    return _ensemble_report.report(store, view)


def _calibrate(config: schema.LawEnsembleConfig, laws: list, deviation: float) -> fitting.Ensemble:
    return fitting.ensemble(
        _calibrated_sea.model(config),
        _calibrated_sea.free(config, deviation),
        laws,
        _calibrated_sea.winds(config),
        scatter=config.scatter,
        least=config.least,
    )
