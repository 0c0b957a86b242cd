"""`picture_recovery`: seas found again in pictures of them, and whether the errors of the fits can be trusted."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import jax
import numpy as np

from fitting import FitError
from fitting.pictures import PictureFit, PictureTarget, SceneModel, fit_picture
from jaxocean.render import Rays

from .. import schema
from ..harness import _records
from ..harness._errors import Interrupted, UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _recovery_report, _recovery_scenes, _recovery_views

SCOUTS = 90
"""Scenes that are looked at before a fit begins."""

SHOWN = 3
"""Seas whose pictures are shown."""


@dataclass(frozen=True)
class Recovery:
    """A sea that was looked for.

    **Arguments:** `sought`: what of it was; `number`: which; `rays`: whether these drew its picture; `coverage`: its
    whitecaps; `truth`, `start`, `found`, `errors`: in the order of `sought`; `steps`, `seconds`: of the fit;
    `compiled`: whether these hold the compilation; `failure`: why nothing was found, else empty.
    """

    sought: tuple[_recovery_scenes.Number, ...]
    number: int
    rays: bool
    coverage: float
    truth: np.ndarray
    start: np.ndarray
    found: np.ndarray
    errors: np.ndarray
    steps: int
    seconds: float
    compiled: bool
    failure: str

    @cached_property
    def inside(self) -> np.ndarray:
        """Whether each number was recovered."""
        return _recovery_scenes.recovered(self.sought, self.truth, self.found)

    def holds(self, level: float) -> np.ndarray:
        """Whether each number's interval of that probability holds the truth."""
        return np.abs(self.found - self.truth) <= _recovery_scenes.half_width(level) * self.errors


def run(config: schema.PictureRecoveryConfig, progress: Reporter, store: Files) -> Result:
    """Look for all seas; see `schema.PictureRecoveryConfig`."""
    kept = store.unfinished() / "recovered.jsonl"
    done = {record["number"]: record for record in _records.read(kept)}
    advance = progress.count(
        "Seas looked for in their pictures; the first compiles, for minutes", config.truths.count
    )
    compiled = True
    try:
        for number in range(config.truths.count):
            if number not in done:
                done[number] = _recover(config, number, compiled)
                _records.append(kept, done[number])
                compiled = False
            advance()
    except KeyboardInterrupt:
        raise Interrupted(
            f"Interrupted: {len(done)} of {config.truths.count} seas are kept, and the same command goes on with the "
            "others."
        ) from None
    sought = _recovery_scenes.numbers(config)
    recoveries = [_read(done[number], sought) for number in range(config.truths.count)]
    progress.step("Drawing")
    _recovery_views.plot(store, config, recoveries)
    shown = [each for each in recoveries if not each.failure][:SHOWN]
    _recovery_views.show(store, [_pictures(config, each) for each in shown], shown)
    _recovery_views.save(store, config, recoveries)
    result = _recovery_report.result(config, recoveries)
    store.text("report.md", _recovery_report.report(config, recoveries, result))
    return result


def _drawn(config: schema.PictureRecoveryConfig, number: int) -> tuple[SceneModel, SceneModel, float]:
    drawn = _recovery_scenes.draw(config, number)
    if drawn is None:
        limits = config.truths
        raise UserError(
            f"Keys `truths.least_coverage` and `truths.most_coverage`: of {_recovery_scenes.DRAWS} seas none has a "
            f"coverage between {limits.least_coverage:g} and {limits.most_coverage:g}: set them further apart."
        )
    return drawn


def _recover(config: schema.PictureRecoveryConfig, number: int, compiled: bool) -> dict:
    truth, start, coverage = _drawn(config, number)
    method = _recovery_scenes.method(config, number)
    image = _recovery_scenes.target(truth, (config.height, config.width), config.detail, method)
    found, failure = None, ""
    try:
        found = fit_picture(
            start,
            _recovery_scenes.free,
            PictureTarget(image),
            finish=_recovery_scenes.FINISHES[: 1 if config.finish == "raster" else None],
            detail=_recovery_scenes.FINER,
            doubts=_recovery_scenes.DOUBTS,
            scouts=SCOUTS,
            most_steps=60,
        )
    except FitError as problem:
        failure = str(problem)
    true = _recovery_scenes.values(truth)
    values, errors = _numbers(found, len(true))
    return {
        "number": number,
        "rays": isinstance(method, Rays),
        "coverage": coverage,
        "truth": true,
        "start": _recovery_scenes.values(start),
        "found": values,
        "errors": errors,
        "steps": len(found.steps) if found else 0,
        "seconds": found.seconds if found else None,
        "compiled": compiled,
        "failure": failure,
    }


def _numbers(found: PictureFit | None, count: int) -> tuple[list[float | None], list[float | None]]:
    if found is None:
        nothing: list[float | None] = [None] * count
        return nothing, nothing
    return _flat(found.values), _flat(found.errors)


def _flat(named: Mapping) -> list[float | None]:
    return [float(each) for value in named.values() for each in np.ravel(value)]


def _read(record: dict, sought: tuple[_recovery_scenes.Number, ...]) -> Recovery:
    arrays = {
        name: np.asarray([np.nan if each is None else each for each in record[name]], float)
        for name in ("truth", "start", "found", "errors")
    }
    seconds = np.nan if record["seconds"] is None else record["seconds"]
    return Recovery(sought, **{**record, **arrays, "seconds": seconds})


def _pictures(config: schema.PictureRecoveryConfig, each: Recovery) -> list[np.ndarray]:
    """Light of the target, of the start and of what was found."""
    truth, start, _ = _drawn(config, each.number)
    size = config.height, config.width
    method = _recovery_scenes.method(config, each.number)
    images = [_recovery_scenes.target(truth, size, config.detail, method)]
    for values in (each.start, each.found):
        scene = _recovery_scenes.with_numbers(start, values)
        images.append(
            _recovery_scenes.target(scene, size, _recovery_scenes.FINER, _recovery_scenes.FINISHES[0])
        )
    return [np.asarray(image) for image in jax.block_until_ready(images)]
