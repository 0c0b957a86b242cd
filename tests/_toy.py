"""An experiment without physics, to test the machinery around experiments; also a program of its own."""

import sys
import time
import warnings
from pathlib import Path
from typing import Literal

from experiments import schema
from experiments._registry import Experiment
from experiments.harness._execute import execute
from experiments.harness._files import variable
from experiments.harness._loading import load
from experiments.harness._result import Result, Table
from experiments.schema import key


class ToyConfig(schema.ExperimentConfig):
    experiment: Literal["toy"] = key("toy", meaning="which experiment")
    value: float = key(1.0, unit="m", meaning="a number", ge=0)
    behaviour: Literal["finish", "user", "bug", "warn", "sleep", "interrupt"] = key(
        "finish", meaning="what it does"
    )
    source: str | None = key(None, meaning="a file that it reads")

    def inputs(self) -> tuple[str, ...]:
        return () if self.source is None else (self.source,)


def run(config: ToyConfig, progress, store) -> Result:
    progress.step("Playing")
    store.data(
        "numbers",
        {"height": variable("x", [config.value, 2.0], units="m", long_name="height of a toy")},
        {"x": variable("x", [0.0, 1.0], units="m", long_name="place")},
        title="Numbers of a toy",
        attributes={"band": "none"},
    )
    if config.behaviour == "user":
        raise ValueError("Argument `value` must\n  please somebody.")
    if config.behaviour == "bug":
        raise KeyError("a mistake of ours")
    if config.behaviour == "warn":
        warnings.warn("The law is outside its range.", UserWarning, stacklevel=1)
    if config.behaviour == "interrupt":
        raise KeyboardInterrupt
    if config.behaviour == "sleep":
        print("asleep", flush=True)
        time.sleep(60)
    return Result(
        values={"value": config.value, "nothing": float("nan")},
        tables=(Table("Toys", ("name", "value (m)"), (("bear", config.value),)),),
        notes=("A note.",),
    )


TOY = Experiment("toy", "a toy", ToyConfig, __name__)
TOYS = (TOY,)


def load_toy(folder: Path, *overrides: str):
    """A toy config of that folder, whose runs also go there."""
    path = folder / "play.yaml"
    path.write_text("experiment: toy\nvalue: 3.0\n")
    return load(str(path), overrides, output=str(folder / "runs"), experiments=TOYS)


if __name__ == "__main__":
    execute(load_toy(Path(sys.argv[1]), *sys.argv[2:]))
