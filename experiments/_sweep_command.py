"""What `jaxocean sweep` does, once its arguments are read."""

import sys
from functools import partial

from rich.console import Console

from . import sweeps
from .harness._errors import UserError
from .sweeps._design import Kind
from .sweeps._executors import available_cores
from .sweeps._meter import in_words

DESIGNS: tuple[Kind, ...] = ("sobol", "random")


def sweep_command(
    config: str,
    values: list[str],
    *,
    workers: int | None,
    zipped: bool,
    design: str | None,
    points: int | None,
    scheduler: str | None,
    output: str | None,
    retry_failed: bool,
    force: bool,
) -> None:
    """Plan, find or compute, and show a sweep.

    **Raises:** `UserError` for options that exclude each other and for whatever a sweep refuses.
    """
    if workers is not None and scheduler is not None:
        raise UserError("Give at most one of --workers and --scheduler: a cluster has its own workers.")
    plan = sweeps.plan(config, values, kind=_kind(zipped, design), points=points, output=output)
    found = None if force else sweeps.find_finished(plan)
    finished = found if found and not (retry_failed and sweeps.failures(found)) else None
    if finished is None:
        found = None
        many = workers or available_cores()
        open_executor = (
            partial(sweeps.local, many) if scheduler is None else partial(sweeps.cluster, scheduler)
        )
        what, total = plan.base.name, plan.points.design.count
        watch = partial(sweeps.meter, Console(stderr=True), what, total)
        finished = sweeps.run(plan, open_executor, watch, retry_failed=retry_failed, force=force)
    sys.stdout.write(finished.summary())
    origin = finished.provenance()
    if found:
        print(f"\nFound again, finished {origin['date']} (--force repeats it): {finished.folder}")
    else:
        rate = in_words(origin["points_computed"] / max(origin["computing_s"], 1e-3))
        print(f"\nFinished in {origin['duration_s']:.1f} s ({rate} while computing): {finished.folder}")
    left = ("results.nc", "results.zarr", "report.md", "sweep.png")
    print("  " + "  ".join(name for name in left if (finished.folder / name).exists()))


def _kind(zipped: bool, design: str | None) -> Kind:
    if design is None:
        return "zip" if zipped else "cartesian"
    if zipped:
        raise UserError("Give at most one of --zip and --design.")
    for known in DESIGNS:
        if design == known:
            return known
    raise UserError(f"The option --design must be sobol or random, but is {design}.")
