"""From a config's name or path, and overrides, to a checked config."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException
from pydantic import BaseModel, ValidationError
from yaml import MarkedYAMLError, YAMLError

from .._registry import EXPERIMENTS, Experiment, find
from ..schema import ExperimentConfig
from ._errors import UserError, nearest
from ._messages import sections_of, sentence

SUFFIXES = (".yaml", ".yml")
CHOOSING = ("family", "law", "kind")
"""Keys that decide which other keys their section has."""


@dataclass(frozen=True)
class Loaded:
    """A checked config, with its name, its file and its experiment."""

    name: str
    path: Path
    experiment: Experiment
    config: ExperimentConfig


def configs_folder() -> Path:
    """Where the shipped configs lie: inside the wheel, or next to the rooms in a checkout."""
    inside = Path(__file__).resolve().parent.parent / "configs"
    return inside if inside.is_dir() else inside.parent.parent / "configs"


def shipped() -> list[Path]:
    """The shipped configs, by name."""
    return sorted(path for path in configs_folder().glob("*") if path.suffix in SUFFIXES)


def locate(config: str) -> Path:
    """The file of a config that is given by name or by path."""
    path = Path(config).expanduser()
    if path.suffix not in SUFFIXES and len(path.parts) == 1:
        names = {known.stem: known for known in shipped()}
        if config in names:
            return names[config]
        near = nearest(config, names)
        hint = f"did you mean `{near}`?" if near else "`jaxocean list` shows all of them."
        raise UserError(
            f"There is no config `{config}`: {hint} A file of your own is given by its path (….yaml)."
        )
    if path.is_dir():
        raise UserError(f"The config {path} is a folder: give the path of a YAML file.")
    if not path.is_file():
        raise UserError(f"The config file {path} does not exist: check the path, or see `jaxocean list`.")
    if path.suffix not in SUFFIXES:
        raise UserError(f"The config {path} must be a YAML file whose name ends in .yaml.")
    return path


def load(
    config: str,
    overrides: Sequence[str] = (),
    *,
    output: str | None = None,
    experiments: Sequence[Experiment] = EXPERIMENTS,
) -> Loaded:
    """Read a config, apply `key.path=value` overrides and check everything.

    **Raises:** `UserError` for whatever is wrong, naming the key, where it stands, and what to do.
    """
    path = locate(config)
    return resolve(path, read_text(path), overrides, output=output, experiments=experiments)


def resolve(
    path: Path,
    text: str,
    overrides: Sequence[str] = (),
    *,
    output: str | None = None,
    experiments: Sequence[Experiment] = EXPERIMENTS,
) -> Loaded:
    """`load` of a config file whose text is at hand; `path` only names it.

    **Raises:** `UserError` as `load` does.
    """
    tree = _parse(path, text)
    if "experiment" not in tree:
        raise UserError(
            f"The config {path} lacks the key `experiment`, which says what it runs "
            f"({', '.join(known.name for known in experiments)})."
        )
    changed = [_split(override) for override in overrides]
    name = next((value for key, value in reversed(changed) if key == "experiment"), tree.get("experiment"))
    experiment = find(str(name), experiments)
    for override, (key, _) in zip(overrides, changed, strict=True):
        _apply(tree, override, key, experiment.config)
    if output is not None:
        tree["output"] = output
    data: Any = OmegaConf.to_container(tree, resolve=False)
    try:
        text = json.dumps(data)
    except (TypeError, ValueError) as error:
        raise UserError(
            f"The config {path} holds a value that is neither number, text, list nor section: {error}."
        ) from error
    try:
        return Loaded(path.stem, path, experiment, experiment.config.model_validate_json(text))
    except ValidationError as error:
        given = [key for key, _ in changed]

        def where(key: str) -> str:
            return "on the command line" if _was_given(key, given) else f"in {path}"

        message = sentence(error, experiment.config, json.loads(text), where)
        raise UserError(f"{message} `jaxocean show {called(path)}` lists every key with its range.") from None


def called(path: Path) -> str:
    """What one types to have this config: its name if it is a shipped one, else its path."""
    return path.stem if path.parent == configs_folder() else str(path)


def read_text(path: Path) -> str:
    """The text of a config file, for `resolve`."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"The config {path} is not a text file in UTF-8.") from error
    except OSError as error:
        raise UserError(f"The config {path} cannot be read: {error.strerror}.") from error


def _parse(path: Path, text: str) -> DictConfig:
    try:
        # Parsed from text, not by name: a folder or a special file then fails as an ordinary read.
        tree = OmegaConf.create(text)
    except (YAMLError, OmegaConfBaseException) as error:
        raise UserError(f"The config {path} is not valid YAML: {_first_line(error)}.") from error
    if not isinstance(tree, DictConfig):
        raise UserError(f"The config {path} must hold `key: value` lines, but holds a list.")
    return tree


def _split(override: str) -> tuple[str, str]:
    key, equals, value = override.partition("=")
    if not equals or not key.strip():
        raise UserError(f"The override `{override}` must read key.path=value, for example wind.speed=12.")
    return key.strip(), value


def _apply(tree: DictConfig, override: str, key: str, model: type[BaseModel]) -> None:
    """Apply one override; one that chooses another kind of section starts that section from its defaults."""
    section, _, tag = key.rpartition(".")
    if section and _chooses(model, section, tag):
        before = OmegaConf.select(tree, section)
        if isinstance(before, DictConfig) and str(before.get(tag)) != override.partition("=")[2]:
            OmegaConf.update(tree, section, {}, merge=False)
    try:
        tree.merge_with_dotlist([override])
    except (OmegaConfBaseException, YAMLError, ValueError, IndexError, TypeError, AssertionError) as error:
        raise UserError(
            f"The override `{override}` cannot be applied: {_first_line(error)}. "
            "It must read key.path=value, for example wind.speed=12 or choppiness=[1,1,0.8,0.8]."
        ) from error


def _chooses(model: type[BaseModel], section: str, tag: str) -> bool:
    """Whether the key `tag` of a section decides which other keys the section has."""
    models: tuple[type[BaseModel], ...] = (model,)
    for name in section.split("."):
        field = next((m.model_fields[name] for m in models if name in m.model_fields), None)
        if field is None:
            return False
        models = sections_of(field.annotation)
    return len(models) > 1 and tag in CHOOSING


def _was_given(key: str, given: Sequence[str]) -> bool:
    return any(key == other or key.startswith(f"{other}.") or other.startswith(f"{key}.") for other in given)


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    if isinstance(error, MarkedYAMLError) and error.problem and error.problem_mark:
        return f"{error.problem} at line {error.problem_mark.line + 1}"
    return (lines[0] if lines else type(error).__name__).rstrip(".")
