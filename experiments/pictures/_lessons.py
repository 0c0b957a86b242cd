"""What pictures of a camera teach, kept so that an interrupted run need not learn it again."""

import os
from itertools import count, takewhile
from pathlib import Path

import numpy as np

from fitting.pictures import DRAWN, ImageStatistics, Lesson, teach
from jaxocean.render import Camera

from ..harness import _records
from ..harness._errors import UserError
from ..harness._progress import Reporter
from . import _photographs


def learned(
    camera: Camera,
    size: tuple[int, int],
    mask: np.ndarray | None,
    config: _photographs.PhotographsConfig,
    *,
    keep: Path,
    progress: Reporter | None = None,
) -> Lesson:
    """What pictures of a camera teach, or have taught an interrupted run.

    **Arguments:** `size`, `mask`: of the images; `keep`: file that holds it; what is drawn before it is known is kept
    beside. `progress`: told of every few scouts that are drawn.

    **Raises:** `UserError` if what is kept is of other statistics.
    """
    before, known = _scouts_before(keep), _read(keep)
    names = ImageStatistics(camera, size, mask).names
    widths = {each.shape[-1] for each in before} | ({known.summaries.middle.size} if known else set())
    if widths - {len(names)}:
        raise UserError(
            f"What an interrupted run has kept in {keep.parent} is of another version of jaxocean: repeat the run with "
            "--force, which throws it away."
        )
    if known is not None:
        return known
    numbers = count(len(before))
    advance = None
    if progress is not None:
        left = -(-config.inference.scouts // DRAWN) - len(before)
        advance = progress.count("Random states; the first picture compiles, for a minute", left)

    def scouted(statistics: np.ndarray) -> None:
        _records.append(_scouts(keep), {"batch": next(numbers), "statistics": statistics.tolist()})
        if advance is not None:
            advance()

    taught = teach(
        _photographs.start(camera, config.camera, config.cascade, config.seed),
        _photographs.free(config.inference),
        size,
        mask=mask,
        vary=_photographs.varied(config.camera.height_spread, config.camera.view_spread),
        scouts=config.inference.scouts,
        seed=config.seed,
        scouts_before=before,
        scouted=scouted,
    )
    _save(keep, taught)
    return taught


def _scouts_before(keep: Path) -> list[np.ndarray]:
    """Statistics of the scouts that an interrupted run has drawn, batch by batch."""
    # By number: two runs of the same config may both have kept theirs.
    found = {each["batch"]: each["statistics"] for each in _records.read(_scouts(keep))}
    return [np.asarray(found[number], float) for number in takewhile(found.__contains__, count())]


def _scouts(keep: Path) -> Path:
    return keep.with_suffix(".scouts.jsonl")


def _save(path: Path, lesson: Lesson) -> None:
    """Keep what scouts taught; the file appears whole."""
    partial = path.with_suffix(".part.npz")
    np.savez(partial, allow_pickle=False, **lesson.arrays)
    os.replace(partial, path)


def _read(path: Path) -> Lesson | None:
    """What an interrupted run has learned, or None."""
    if not path.is_file():
        return None
    with np.load(path, allow_pickle=False) as kept:
        return Lesson.of(dict(kept))
