"""What `jaxocean list` and `jaxocean show` print."""

import typing
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined
from rich.box import SIMPLE_HEAD
from rich.console import Group
from rich.table import Table
from rich.text import Text

from ._registry import EXPERIMENTS
from .harness._errors import UserError
from .harness._loading import CHOOSING, Loaded, load, shipped
from .harness._messages import sections_of

BOUNDS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
Row = tuple[str, Any, FieldInfo, str]
"""Dotted key, value, field, range in words."""


def configs_table() -> Group:
    """Every shipped config with its experiment and title, then every experiment."""
    configs = _empty(
        "Config", "Experiment", "What it does", title="Configs: jaxocean run CONFIG [key.path=value …]"
    )
    for path in shipped():
        try:
            loaded = load(str(path))
        except UserError as error:
            configs.add_row(path.stem, "-", Text(str(error)))
            continue
        configs.add_row(path.stem, loaded.experiment.name, Text(loaded.config.title))
    experiments = _empty("Experiment", "What it does", title="Experiments: the key `experiment` of a config")
    for experiment in EXPERIMENTS:
        experiments.add_row(experiment.name, Text(experiment.summary))
    return Group(configs, experiments)


def keys_table(loaded: Loaded) -> Table:
    """Every key of a config: its value here, its unit, default, range and meaning."""
    table = _empty(
        "Key", "Value", "Unit", "Default", "Range", "Meaning", title=f"{loaded.name} ({loaded.path})"
    )
    for path, value, field, within in _rows(loaded.config):
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        cells = (
            path,
            _text(value),
            str(extra.get("unit", "")),
            _default(field),
            within,
            field.description or "",
        )
        table.add_row(*(Text(cell) for cell in cells))
    return table


def _rows(section: BaseModel, prefix: str = "", tags: dict[str, str] | None = None) -> Iterator[Row]:
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if isinstance(value, BaseModel):
            yield from _rows(value, f"{prefix}{name}.", _choices(field))
        else:
            yield prefix + name, value, field, (tags or {}).get(name, "") or _range(field)


def _choices(field: FieldInfo) -> dict[str, str]:
    """For a section that comes in several kinds: the key that chooses, and all that it may be."""
    kinds = sections_of(field.annotation)
    return {
        tag: " | ".join(str(kind.model_fields[tag].default) for kind in kinds)
        for tag in CHOOSING
        if len(kinds) > 1 and all(tag in kind.model_fields for kind in kinds)
    }


def _default(field: FieldInfo) -> str:
    return "(must be given)" if field.default is PydanticUndefined else _text(field.default)


def _range(field: FieldInfo) -> str:
    """Bounds or choices in words; what `key` was told where a check across keys decides."""
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    if extra.get("within"):
        return str(extra["within"])
    if typing.get_origin(field.annotation) is typing.Literal:
        return " | ".join(map(str, typing.get_args(field.annotation)))
    if field.annotation is bool:
        return "true | false"
    limits = {
        name: getattr(bound, name) for bound in field.metadata for name in BOUNDS if hasattr(bound, name)
    }
    return " and ".join(f"{BOUNDS[name]} {_text(limit)}" for name, limit in limits.items())


def _text(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_text, value)) + "]"
    return str(value)


def _empty(*columns: str, title: str) -> Table:
    table = Table(title=Text(title, style="bold"), title_justify="left", box=SIMPLE_HEAD)
    for column in columns:
        table.add_column(column, overflow="fold")
    return table
