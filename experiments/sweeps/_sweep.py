"""A sweep from its plan to a finished folder, resumed where an earlier command stopped."""

import errno
import json
import os
import shutil
import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from typing import Any

import yaml

from ..harness._errors import Interrupted, UserError
from ..harness._lock import locked
from ..harness._provenance import provenance
from ..harness._report import render
from ..harness._result import Result, jsonable
from ..harness._store import FinishedRun, find
from ._drive import drive
from ._effects import main_results
from ._export import export
from ._meter import Advance
from ._plan import Sweep
from ._results import Results, create
from ._summary import report, summarise
from ._task import Task

STORE, EXPORT, ABOUT, SCRATCH = "results.zarr", "results.nc", "sweep.json", "scratch"
PICTURE = "sweep.png"
FINAL = ("result.json", "summary.txt", "report.md", PICTURE, EXPORT)
"""Files that only a finished sweep has; the first one is written last."""

CHUNKS, SMALLEST, LARGEST, SINGLE = 32, 512, 16384, 256
"""A store has at least so many chunks, of sizes between these; points that are runs have chunks of `SINGLE`."""

Open = Callable[[], AbstractContextManager[tuple[Executor, int]]]
Watch = Callable[[int, int], AbstractContextManager[Advance]]


def find_finished(sweep: Sweep) -> FinishedRun | None:
    """The finished folder of this sweep, or None; imports no JAX."""
    found = find(sweep.folder)
    return found if found and (sweep.folder / EXPORT).is_file() and _is_of(sweep) else None


def failures(finished: FinishedRun) -> int:
    """How many points of a finished sweep failed."""
    return int(json.loads((finished.folder / FINAL[0]).read_text(encoding="utf-8"))["failed"])


def run(sweep: Sweep, open_executor: Open, watch: Watch, *, retry_failed: bool, force: bool) -> FinishedRun:
    """Compute what is missing of a sweep, and write its tables and its netCDF file.

    **Arguments:** `open_executor`: opens an executor and tells how many tasks it shall have at a time; `watch`: is
    told the numbers of points that are there and of those that failed, and shows the progress; `retry_failed`:
    compute failed points again; `force`: throw away what is there.

    **Raises:** `UserError` for a store that belongs to another sweep or that another process is writing, a full
    disk, a lost scheduler, or if no point could be computed; `Interrupted` after Ctrl-C, with what is kept.
    """
    began = time.perf_counter()
    try:
        sweep.folder.parent.mkdir(parents=True, exist_ok=True)
        with locked(sweep.folder):
            if force and sweep.folder.exists():
                shutil.rmtree(sweep.folder)
            if not sweep.folder.exists():
                _found(sweep)
            results = _open(sweep)
            notes, speed = _compute(sweep, results, open_executor, watch, retry_failed=retry_failed)
            result = summarise(sweep, results, notes)
            _refuse_nothing(sweep, result)
            export(results, sweep.points.design, sweep.base, sweep.folder / EXPORT)
            origin = provenance(sweep.base, sweep.digest, time.perf_counter() - began)
            _finish(sweep, result, origin | speed, picture=_draw(sweep, results, result))
    except OSError as error:
        raise UserError(_unwritable(sweep, error)) from error
    except KeyboardInterrupt:
        raise Interrupted(f"Interrupted: {_kept(sweep)}") from None
    return FinishedRun(sweep.folder)


def _found(sweep: Sweep) -> None:
    """Make the folder with an empty store, as a whole."""
    design = sweep.points.design
    making = sweep.folder.with_name(f".{sweep.folder.name}.making")
    shutil.rmtree(making, ignore_errors=True)
    making.mkdir(parents=True)
    about = {"hash": sweep.digest, "config": sweep.base.name, "points": design.count, **design.canonical()}
    (making / ABOUT).write_text(json.dumps(about) + "\n", encoding="utf-8")
    config = sweep.base.config.model_dump(mode="json", exclude={"output"})
    (making / "config.yaml").write_text(
        yaml.safe_dump(config, sort_keys=False, allow_unicode=True), encoding="utf-8"
    )
    create(making / STORE, design, sweep.base, _chunk(sweep))
    os.replace(making, sweep.folder)


def _chunk(sweep: Sweep) -> int:
    count = sweep.points.design.count
    if not sweep.base.experiment.config.varies():
        return min(count, SINGLE)
    return min(count, SMALLEST * max(1, min(count // (CHUNKS * SMALLEST), LARGEST // SMALLEST)))


def _open(sweep: Sweep) -> Results:
    """The store of this sweep and of no other."""
    about = _about(sweep)
    if not about:
        raise UserError(
            f"The folder {sweep.folder} holds no sweep that can be read: move it away, or --force replaces it."
        )
    if not _is_of(sweep):
        raise UserError(
            f"The store in {sweep.folder} belongs to another sweep (of {about.get('config')}, "
            f"{about.get('points')} points): choose another folder with --output, or --force replaces it."
        )
    return Results(sweep.folder / STORE)


def _about(sweep: Sweep) -> dict[str, Any]:
    try:
        return json.loads((sweep.folder / ABOUT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def _is_of(sweep: Sweep) -> bool:
    return _about(sweep).get("hash") == sweep.digest


def _compute(
    sweep: Sweep, results: Results, open_executor: Open, watch: Watch, *, retry_failed: bool
) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Compute what is missing; notes, and how many points it took how long."""
    scratch = sweep.folder / SCRATCH
    shutil.rmtree(scratch, ignore_errors=True)
    done, failed = results.tally()
    before = done if retry_failed else done + failed
    if before == results.count:
        return (), {"points_computed": 0, "computing_s": 0.0}
    scratch.mkdir()
    task = Task(sweep.points, sweep.base.experiment, 0, 0, str(scratch.resolve()))
    began = time.perf_counter()
    try:
        with open_executor() as (executor, lanes), watch(before, 0 if retry_failed else failed) as advance:
            for name in FINAL:
                (sweep.folder / name).unlink(missing_ok=True)
            notes = drive(results, task, executor, lanes, retry_failed=retry_failed, advance=advance)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    took = round(time.perf_counter() - began, 3)
    return notes, {"points_computed": results.count - before, "computing_s": took}


def _draw(sweep: Sweep, results: Results, result: Result) -> str | None:
    """The picture, if there is a single number to draw."""
    ranges = {
        name: (ends["least"], ends["mean"], ends["most"]) for name, ends in result.values["ranges"].items()
    }
    names = main_results(results, ranges)
    if not names:
        return None
    # Only now: matplotlib.
    from ..harness._files import Files
    from ._picture import draw

    draw(sweep.points.design, sweep.base, results, names, Files(sweep.folder, sweep.base))
    return PICTURE


def _finish(sweep: Sweep, result: Result, origin: dict[str, Any], *, picture: str | None) -> None:
    """Tables, words and provenance; `result.json` last: it says that all the others are there."""
    contents = {
        "provenance.json": json.dumps(origin, indent=2, ensure_ascii=False),
        "report.md": report(sweep, result, picture=picture),
        "summary.txt": render(result),
        "result.json": json.dumps(jsonable(result.values), indent=2, allow_nan=False, ensure_ascii=False),
    }
    for name, content in contents.items():
        partial = sweep.folder / f".{name}.partial"
        partial.write_text(content.rstrip("\n") + "\n", encoding="utf-8")
        os.replace(partial, sweep.folder / name)


def _refuse_nothing(sweep: Sweep, result: Result) -> None:
    if not result.values["done"]:
        first = next(iter(result.values["reasons"]), "nothing was tried.")
        raise UserError(f"None of the {sweep.points.design.count:,} points could be computed: {first}")


def _kept(sweep: Sweep) -> str:
    try:
        done, failed = Results(sweep.folder / STORE).tally()
    except UserError:
        return "nothing had been computed."
    return (
        f"{done + failed:,} of {sweep.points.design.count:,} points are kept in {sweep.folder}; "
        "the same command goes on from there."
    )


def _unwritable(sweep: Sweep, error: OSError) -> str:
    full = error.errno in (errno.ENOSPC, errno.EDQUOT)
    what = "the disk is full" if full else (error.strerror or str(error)).rstrip(".")
    return f"The sweep in {sweep.folder} cannot be written ({what}): {_kept(sweep)}"
