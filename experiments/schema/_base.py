"""What every config is made of: strict frozen sections whose numbers carry unit, range and meaning."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

QUARTER_TURN, HALF_TURN, TURN = 1.571, 3.142, 6.284
"""π/2, π and 2π [rad], rounded up: whoever types 1.5708 means π/2."""


class Section(BaseModel):
    """A group of keys. Unknown keys, numbers in quotes, `true` for 1.0, NaN and infinity are all refused."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


def key(default: Any = ..., *, unit: str = "", meaning: str, within: str = "", **bounds: Any) -> Any:
    """A key of a config.

    **Arguments:** `default`: its value when absent, or `...` if it must be given; `unit`: SI, `"-"` for a
    pure number, empty where there is none; `meaning`: one line for `jaxocean show`; `within`: the range in
    words where a validator checks it; `bounds`: `ge`, `gt`, `le`, `lt`, `min_length`, `max_length`.
    """
    return Field(default, description=meaning, json_schema_extra={"unit": unit, "within": within}, **bounds)


def wrong(path: str, must: str) -> PydanticCustomError:
    """The error of a check across keys: `path` from the section that checks, `must` completes "must …"."""
    return PydanticCustomError("config", "{must}", {"key": path, "must": must})


class ExperimentConfig(Section):
    """The keys of every experiment. A subclass adds `experiment: Literal["its_name"]` and its own keys."""

    experiment: str = key(meaning="which experiment this config runs")
    title: str = key("", meaning="one line for `jaxocean list`")
    seed: int = key(0, meaning="seed of every random number", ge=0, le=2**31 - 1)
    output: str = key("runs", meaning="folder that receives the runs", min_length=1)

    def identity(self) -> dict[str, Any]:
        """The values that decide the outcome: what the run's hash covers."""
        return self.model_dump(mode="json", exclude={"title", "output"})

    def inputs(self) -> tuple[str, ...]:
        """Paths of files that the experiment reads; their contents are part of the run's identity."""
        return ()

    @classmethod
    def varies(cls) -> frozenset[str]:
        """Keys whose numbers may differ within one compiled batch of a sweep; none: each point is a run.

        Whether a config with other numbers there is valid may depend on each number's own range and on which keys
        are given, on nothing else.
        """
        return frozenset()
