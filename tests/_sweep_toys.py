"""Experiments without physics to sweep, one run per point or vmapped; also the command line with them."""

import math
import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Literal, Self
from unittest import mock

import xarray as xr
from pydantic import model_validator

from experiments import __main__, schema, sweeps
from experiments._registry import Experiment
from experiments.harness._errors import UserError
from experiments.harness._quantity import Quantity
from experiments.harness._result import Result
from experiments.schema import key


class RunsConfig(schema.ExperimentConfig):
    """`runs`: writes down when it computes which point, and misbehaves at some."""

    experiment: Literal["runs"] = key("runs", meaning="which experiment")
    value: int = key(1, meaning="a number", ge=0, le=1_000_000)
    name: Literal["ant", "bee"] = key("ant", meaning="a name")
    log: str = key("", meaning="file that receives one line per computed point")
    wait: float = key(0.0, unit="s", meaning="time that a point takes", ge=0)
    refuses: int | None = key(None, meaning="the value at which it refuses, unless `mended` exists")
    breaks: int | None = key(None, meaning="the value at which it has a bug")
    kills: int | None = key(None, meaning="the value at which its process is killed")
    kills_once: int | None = key(None, meaning="the same, but only the first time")
    mended: str = key("", meaning="file whose existence mends `refuses`")


def run(config: RunsConfig, progress: Any, store: Any) -> Result:
    """Compute one point."""
    del progress
    value = config.value
    if config.log:
        with open(config.log, "a") as log:
            log.write(f"{os.getpid()} {value}\n")
    time.sleep(config.wait)
    if value == config.refuses and not Path(config.mended).is_file():
        raise UserError(f"The toy must not be {value}.")
    if value == config.breaks:
        raise KeyError("a mistake of ours")
    once = store.folder.parents[2] / "killed_once"
    if value == config.kills_once and not once.exists():
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if value == config.kills:
        os.kill(os.getpid(), signal.SIGKILL)
    return Result(
        values={
            "square_m": value**2,
            "nested": {"list, of numbers": [value, None, 3.0], "text": "no number", "nothing": None},
            "rows": [{"name": "a", "x": value}, {"name": "b", "x": -value}],
            "ragged": list(range(1 + value % 3)),
            "value": value,
            "is_bee": config.name == "bee",
            "wide": [math.sin(value + 0.1 * i) for i in range(64)],
        }
    )


class BatchConfig(schema.ExperimentConfig):
    """`batch`: vmapped over two numbers."""

    experiment: Literal["batch"] = key("batch", meaning="which experiment")
    x: float = key(1.0, unit="m/s", meaning="a number", ge=-1e6, le=1e6)
    y: float | tuple[float, ...] | None = key(1.0, unit="m", meaning="one number, several or none")
    power: int = key(2, meaning="decides about the program", ge=0, le=9)
    _most: ClassVar[float] = 1e6

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.x > self._most:
            raise schema.wrong("x", f"be at most {self._most:g}, but is {self.x:g}")
        return self

    @classmethod
    def varies(cls) -> frozenset[str]:
        return frozenset({"x", "y"})


QUANTITIES = {
    "result": Quantity("m", "x to its power plus the sum of y"),
    "root": Quantity("1", "square root of x", may_be_undefined=True),
    "log": Quantity("1", "logarithm of x + 100"),
}


def measure(config: BatchConfig) -> dict[str, Any]:
    """One point."""
    import jax.numpy as jnp

    y = jnp.zeros(1) if config.y is None else jnp.asarray(config.y)
    x = jnp.asarray(config.x)
    if config.power == 9:
        raise ValueError("Nine is too much.")
    return {"result": x**config.power + jnp.sum(y), "root": jnp.sqrt(x), "log": jnp.log(x + 100.0)}


RUNS = Experiment("runs", "a toy, run by run", RunsConfig, "_sweep_toys")
BATCH = Experiment("batch", "a toy, batch by batch", BatchConfig, "_sweep_toys")
TOYS = (RUNS, BATCH)


def plan(folder: Path, experiment: str, *values: str, **options: Any) -> sweeps.Sweep:
    """A sweep of a toy whose store goes into that folder."""
    path = folder / f"{experiment}.yaml"
    path.write_text(f"experiment: {experiment}\n")
    return sweeps.plan(str(path), values, output=str(folder / "sweeps"), experiments=TOYS, **options)


@contextmanager
def unwatched(before: int, failed: int) -> Iterator[Any]:
    """Shows nothing."""
    yield lambda points, failures: None


def compute(
    sweep: sweeps.Sweep, *, workers: int = 1, retry_failed: bool = False, force: bool = False
) -> xr.Dataset:
    """Compute a sweep on this machine; its netCDF file, loaded."""
    opened = partial(sweeps.local, workers)
    with mock.patch.dict(os.environ, {"JAXOCEAN_CACHE": "off"}):
        finished = sweeps.run(sweep, opened, unwatched, retry_failed=retry_failed, force=force)
    return xr.load_dataset(finished.folder / "results.nc")


def computed(log: Path) -> list[int]:
    """The values that were computed, in their order, from the log of `runs`."""
    return [int(line.split()[1]) for line in log.read_text().splitlines()] if log.exists() else []


def main() -> None:
    """The command line with toys."""
    original = sweeps.plan
    sweeps.plan = lambda *args, **kwargs: original(*args, experiments=TOYS, **kwargs)
    __main__.main()


if __name__ == "__main__":
    main()
