"""From pydantic's errors to one sentence: which key, what it must be, what it is, where it stands."""

import json
import types
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ._errors import nearest

_NUMBER_RANGE = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
_KINDS = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "a text",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "tuple_type": "a list",
    "model_type": "a section of keys",
    "model_attributes_type": "a section of keys",
    "dict_type": "a section of keys",
    "none_required": "null",
    "finite_number": "a finite number",
}


def sections_of(annotation: Any) -> tuple[type[BaseModel], ...]:
    """The section classes that a key may hold: several for a choice like `spectrum`, none for a value."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return (annotation,)
    if typing.get_origin(annotation) is typing.Annotated:
        return sections_of(typing.get_args(annotation)[0])
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        return tuple(found for part in typing.get_args(annotation) for found in sections_of(part))
    return ()


def paths(model: type[BaseModel], prefix: str = "") -> Iterator[tuple[str, FieldInfo]]:
    """Every dotted key that a config may have, of every choice, with its field."""
    for name, field in model.model_fields.items():
        yield prefix + name, field
        for section in sections_of(field.annotation):
            yield from paths(section, f"{prefix}{name}.")


def sentence(
    error: ValidationError, model: type[BaseModel], data: Mapping[str, Any], where: Callable[[str], str]
) -> str:
    """One sentence about the first problem; `where` tells for a dotted key where it was given."""
    problems = [(_location(problem["loc"], data), problem) for problem in error.errors()]
    # A key that nobody knows explains everything else; among the readings of one value the deepest is meant.
    problems.sort(key=lambda item: (item[1]["type"] != "extra_forbidden", -len(item[0])))
    location, problem = problems[0]
    same = [other for where, other in problems if where == location]
    key = ".".join(map(str, location))
    context = problem.get("ctx", {})
    if problem["type"] == "config":
        key = f"{key}.{context['key']}" if key else context["key"]
    elif problem["type"].startswith("union_tag"):
        key = f"{key}.{context['discriminator'].strip(chr(39))}"
    if problem["type"] == "extra_forbidden":
        return f"Unknown key `{key}` {where(key)}{_suggestion(key, model)}"
    return f"Key `{key}` {where(key)} {_clause(key, problem, same, model)}."


def _clause(key: str, problem: Any, same: Sequence[Any], model: type[BaseModel]) -> str:
    """What the key must be and what it is."""
    kind, context, shown = problem["type"], problem.get("ctx", {}), _show(problem["input"])
    if kind == "config":
        return f"must {context['must']}"
    if kind == "missing":
        return "is missing"
    if kind == "union_tag_not_found":
        return f"is missing: it chooses among the kinds of `{key.rpartition('.')[0]}`"
    if kind == "union_tag_invalid":
        return f"must be one of {_quoted(context['expected_tags'])}, but is {_show(context['tag'])}"
    if kind == "literal_error":
        return f"must be {_quoted(context['expected'])}, but is {shown}"
    if kind in _NUMBER_RANGE:
        words, bound = _NUMBER_RANGE[kind]
        return f"must be {words} {context[bound]:g}{unit_of(key, model)}, but is {shown}"
    if kind in ("too_short", "too_long", "string_too_short"):
        limit = context.get("min_length", context.get("max_length"))
        return f"must hold at {'most' if kind == 'too_long' else 'least'} {limit}, but is {shown}"
    if kind in _KINDS:
        kinds = list(dict.fromkeys(_KINDS[other["type"]] for other in same if other["type"] in _KINDS))
        return f"must be {' or '.join(kinds)}, but is {shown}"
    return f"is not accepted ({problem['msg'].rstrip('.')}), it is {shown}"


def _quoted(choices: str) -> str:
    return choices.replace("'", "`")


def unit_of(key: str, model: type[BaseModel]) -> str:
    """The unit of a key, with a space before it; empty for pure numbers."""
    for path, field in paths(model):
        if path == key and isinstance(field.json_schema_extra, dict):
            unit = str(field.json_schema_extra.get("unit", ""))
            return "" if unit in ("", "-") else f" {unit}"
    return ""


def _location(loc: tuple[int | str, ...], data: Any) -> tuple[int | str, ...]:
    """pydantic's location without the names of union members, which are no keys."""
    real: list[int | str] = []
    for position, part in enumerate(loc):
        last = position == len(loc) - 1
        if isinstance(data, Mapping) and (part in data or last):
            real.append(part)
            data = data.get(part)
        elif isinstance(data, Sequence) and not isinstance(data, str) and isinstance(part, int):
            real.append(part)
            data = data[part] if part < len(data) else None
    return tuple(real)


def _suggestion(key: str, model: type[BaseModel]) -> str:
    """The nearest key: the same name elsewhere, then its sisters, then anything alike."""
    section, _, name = key.rpartition(".")
    known = [path for path, _ in paths(model)]
    if key in known:
        # It exists, but in another member of the choice.
        choice = next(
            (f"{section}.{tag}" for tag in ("family", "law") if f"{section}.{tag}" in known), section
        )
        return f": it belongs to another choice of `{choice}`."
    names = {path.rpartition(".")[2]: path for path in reversed(known)}
    sisters = {path.rpartition(".")[2]: path for path in known if path.rpartition(".")[0] == section}
    found = names.get(name) or sisters.get(nearest(name, sisters) or "") or nearest(key, known)
    found = found or names.get(nearest(name, names) or "")
    return f": did you mean `{found}`?" if found else "."


def _show(value: Any) -> str:
    """A value as it stands in YAML, not too long."""
    text = json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
