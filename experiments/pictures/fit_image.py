"""`fit_image`: the wind and the light from one photograph of the sea, with an interval."""

from pathlib import Path

import jax
import numpy as np

from fitting import FitError
from fitting.pictures import PhotographFit, PictureStep

from .. import schema
from ..harness import _records
from ..harness._errors import Interrupted, UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _image_report, _image_views, _lessons, _photographs, _unknown_scenes
from ._taken import Taken, taken_from

LEVEL = 0.08, 0.03
"""Pitch and roll [rad] of a picture that is made here."""

FRAMES = 6
"""Of the filmstrip, at most."""

STEPS = "steps.jsonl"
"""Keeps each step of the way until the run is finished."""


def run(config: schema.FitImageConfig, progress: Reporter, store: Files) -> Result:
    """Fit an image; see `schema.FitImageConfig`."""
    truth = None
    if config.image is None:
        progress.step("Drawing a picture, since none is given")
        taken, truth = _made(config)
    else:
        progress.step("Reading the image")
        mask = None if config.mask is None else Path(config.mask)
        taken = taken_from(Path(config.image), mask, config.camera, config.inference.rows)
    try:
        found = _fitted(config, taken, progress, store)
    except KeyboardInterrupt:
        raise Interrupted(
            "Interrupted: what is drawn of the random states, what they taught and each step is kept, and the same "
            "command goes on from there."
        ) from None
    except FitError as problem:
        raise UserError(f"Key `image`: {problem}") from problem
    progress.step("Drawing what was found")
    _image_views.plot(store, config, taken, found)
    _image_views.strip(store, taken, _frames(found, _photographs.before(config), _way(store)), found)
    _image_views.plot_statistics(store, found)
    _image_views.save(store, found)
    result = _image_report.result(config, found, truth)
    store.text("report.md", _image_report.report(config, found, taken, result, truth))
    return result


def _made(config: schema.FitImageConfig) -> tuple[Taken, float]:
    """A picture of a sea, and its wind."""
    camera = config.camera
    if camera.pitch is None:
        camera = camera.model_copy(update={"pitch": LEVEL[0], "roll": LEVEL[1]})
    known = schema.UnknownSeasConfig(
        seed=config.seed, inference=config.inference, camera=camera, cascade=config.cascade
    )
    state = _unknown_scenes.draw(known, 0)
    return _unknown_scenes.taken(known, state), float(state.scene.wind.speed)


def _fitted(config: schema.FitImageConfig, taken: Taken, progress: Reporter, store: Files) -> PhotographFit:
    """The fit, from where an interrupted one left off."""
    kept, learned = store.unfinished() / STEPS, store.unfinished() / "lesson.npz"
    before = _records.read(kept)
    taught = learned.is_file()
    done = max(len(before) - 1, 0)

    def report(step: PictureStep) -> None:
        values = {name: float(np.asarray(value)) for name, value in step.values.items()}
        _records.append(kept, {"cost": step.cost, "values": values})
        wind = f"U10 {values[_photographs.WIND]:.2f} m/s"
        # An interrupted fit goes on from its last step.
        progress.step(f"Step {done + step.number}: {wind}, cost {step.cost:.3g}")

    lesson = _lessons.learned(taken.camera, taken.size, taken.mask, config, keep=learned, progress=progress)
    progress.step("Going down; the first step compiles, for a minute or two")
    begin = before[-1]["values"] if before and taught else None
    if begin is not None:
        left = max(config.inference.steps - done, 1)
        inference = config.inference.model_copy(update={"steps": left})
        config = config.model_copy(update={"inference": inference})
    return _photographs.fit(taken, config, lesson, begin=begin, report=report)


def _way(store: Files) -> list[dict[str, float]]:
    """Values at each step, those before an interruption too: the step from which it went on is the last of them."""
    ways: list[dict[str, float]] = []
    for record in _records.read(store.unfinished() / STEPS):
        values = record["values"]
        if not ways or not np.allclose(list(values.values()), list(ways[-1].values()), rtol=1e-9):
            ways.append(values)
    return ways


def _frames(
    found: PhotographFit, before: dict[str, float], ways: list[dict[str, float]]
) -> list[tuple[str, np.ndarray]]:
    """What was expected, and some steps of the way, the last one what was found: pictures with the same waves."""
    chosen = np.unique(np.linspace(0, len(ways) - 1, FRAMES - 1).round().astype(int))
    rows, columns = found.size
    frames = []
    for words, values in [("expected", before), *((f"step {number}", ways[number]) for number in chosen)]:
        picture = _photographs.drawn(found.at(values), (2 * rows, 2 * columns))
        frames.append((f"{words}: {values[_photographs.WIND]:.1f} m/s", picture))
    return [(title, np.asarray(picture)) for title, picture in jax.block_until_ready(frames)]
