"""Tables and words of `dupuy_scenes`."""

import math
from collections.abc import Mapping

import numpy as np

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table
from ._dupuy_views import NAMES, Field

SHORT = {"foam": "foam field", "jacobian": "true Jacobian", "spectrum": "as specified"}
KNOWN = {
    "printed_variance": ("foam: eq. 8", -0.54),
    "gaussian_foam": ("foam: Gaussian", 0.041),
    "exact_foam": ("foam: counted", 0.019),
    "gaussian": ("true: Gaussian", 0.111),
    "exact": ("true: counted", 0.089),
}
"""What is known of scene 1, with the program's variance in the Gaussian formula."""


def result(fields: list[Field], definitions: Mapping, config: schema.DupuyScenesConfig) -> Result:
    """Numbers, tables and the answer in words."""
    tables = [_variance_table(fields), _coverage_table(fields), _projected_table(fields)]
    if definitions:
        tables.append(_known_table(fields, definitions))
    return Result(
        values={"scenes": [_numbers(field) for field in fields], "known": _known_values(fields, definitions)},
        tables=tuple(tables),
        notes=tuple(_notes(fields, definitions)),
    )


def report(
    result: Result, fields: list[Field], definitions: Mapping, config: schema.DupuyScenesConfig
) -> str:
    """`report.md`."""
    del definitions
    setting = (
        f"N = {config.resolution}, {len(fields[0].rest)} seas with {config.shifts} arrangements of their patterns "
        "each, ± one standard error, all waves of the patterns (no breaking wavenumber); the paper's eq. 5 counts the "
        "area of the plane at rest"
    )
    answer = "\n".join(f"- {note}" for note in result.notes)
    return page("The paper's own seas", (answer,), result.tables, picture="scenes", setting=setting)


def _numbers(field: Field) -> dict:
    closed = field.closed
    return {
        "scene": field.number,
        "field": field.name,
        "wind_speed_m_per_s": field.scene.wind,
        "threshold": field.scene.threshold,
        "printed_variance": float(closed.printed_variance),
        "printed_is_defined": field.defined,
        "program_variance": float(closed.program_variance),
        "variance": float(closed.variance),
        "skewness": float(closed.skewness),
        **{f"coverage_{name}": field.at(name) for name in ("printed", "program", "gaussian", "exact")},
        "coverage_counted": field.counted[0],
        "coverage_counted_standard_error": field.counted[1],
        "projected_exact": float(closed.projected["exact"]),
        "projected_gaussian": float(closed.projected["gaussian"]),
        "projected_counted": field.counted_projected[0],
        "projected_counted_standard_error": field.counted_projected[1],
    }


def _known_values(fields: list[Field], definitions: Mapping) -> dict:
    return {name: definition._asdict() for name, definition in definitions.items()} if definitions else {}


def _variance_table(fields: list[Field]) -> Table:
    rows = [
        (
            _label(f),
            float(f.closed.printed_variance),
            float(f.closed.program_variance),
            float(f.closed.variance),
            float(f.closed.skewness),
        )
        for f in fields
    ]
    return Table("Variance of j", ("scene", "eq. 8", "program", "right", "skewness"), rows)


def _coverage_table(fields: list[Field]) -> Table:
    rows = [
        (
            _label(f),
            f.scene.threshold,
            f"{f.at('printed'):.4g}" if f.defined else "undefined",
            _three(f.at("program")),
            _three(f.at("gaussian")),
            _three(f.at("exact")),
            _with_error(*f.counted),
        )
        for f in fields
    ]
    columns = ("scene", "ε", "eqs 6-8", "program", "Gaussian", "exact", "counted")
    return Table("Coverage W of the plane at rest (the paper's eq. 5)", columns, rows)


def _projected_table(fields: list[Field]) -> Table:
    rows = [
        (
            _label(f),
            _three(float(f.closed.projected["gaussian"])),
            _three(float(f.closed.projected["exact"])),
            _with_error(*f.counted_projected),
            _three(float(f.closed.projected["exact"]) / f.at("exact")),
        )
        for f in fields
    ]
    columns = ("scene", "Gaussian", "exact", "counted", "projected / rest")
    return Table("Coverage W seen from above", columns, rows)


def _known_table(fields: list[Field], definitions: Mapping) -> Table:
    foam, true = (_of(fields, 1, name).counted for name in ("foam", "jacobian"))
    counted = {"exact_foam": _with_error(*foam), "exact": _with_error(*true)}
    rows = [("known", *(f"{known:g}" for _, known in KNOWN.values()))]
    rows += [
        (f"γ with {reading}", *(f"{getattr(definition, name):.4f}" for name in KNOWN))
        for reading, definition in definitions.items()
    ]
    rows.append(("counted in this run", *(counted.get(name, "-") for name in KNOWN)))
    return Table(
        "Scene 1, by the reading of its sea (W counted: by the exact closure)",
        ("reading", *(text for text, _ in KNOWN.values())),
        rows,
    )


def _notes(fields: list[Field], definitions: Mapping) -> list[str]:
    numbers = sorted({f.number for f in fields})
    undefined = [f for f in fields if not f.defined]
    variances = [float(f.closed.printed_variance) for f in undefined]
    notes = []
    if undefined:
        notes.append(
            f"Equation 8 as printed has a negative variance in {len(undefined)} of {len(fields)} fields "
            f"({min(variances):.2f} to {max(variances):.2f}): the published coverage is undefined there."
        )
    worst = {name: [_of(fields, n, name) for n in numbers] for name in ("foam", "jacobian")}
    for name, each in worst.items():
        notes.append(
            f"{NAMES[name][0].upper()}{NAMES[name][1:]}: the program's formula gives {_ratios(each, 'program')} times "
            f"the exact coverage ({_listed(numbers)}). The right variance does not mend that "
            f"({_ratios(each, 'gaussian')}): j is not Gaussian, its skewness is "
            f"{float(each[0].closed.skewness):+.2f} in scene {each[0].number}."
        )
    notes.append(_agreement(fields))
    more = ", ".join(
        f"{_of(fields, n, 'jacobian').counted[0] / _of(fields, n, 'foam').counted[0]:.3g}" for n in numbers
    )
    notes.append(
        f"The foam field has half of the strain's variance: by its true Jacobian the rendered sea breaks on {more} "
        f"times as much of its area ({_listed(numbers)}; counted)."
    )
    notes.append(_ours(fields, numbers))
    if definitions:
        notes.append(_reading(definitions))
    return notes


def _agreement(fields: list[Field]) -> str:
    offs = [(abs(f.counted[0] / f.at("exact") - 1), f) for f in fields if f.counted[0] > 0]
    worst, where = max(offs, key=lambda pair: pair[0])
    mean, error = where.counted
    return (
        f"The exact closure is within {100 * worst:.2g} % of what is counted in all fields of all scenes (farthest: "
        f"scene {where.number}, {NAMES[where.name]}, {where.at('exact'):.4g} against {mean:.4g} ± {error:.2g})."
    )


def _ours(fields: list[Field], numbers: list[int]) -> str:
    each = [_of(fields, n, "spectrum") for n in numbers]
    listed = ", ".join(f"{100 * f.at('exact'):.3g}" for f in each)
    return (
        "The sea as specified (no extra √2 in the amplitudes, γ with log10, annuli for bands, true Jacobian) breaks on "
        f"{listed} % of the plane at rest ({_listed(numbers)}; exact)."
    )


def _reading(definitions: Mapping) -> str:
    def distance(definition) -> float:
        return max(abs(getattr(definition, name) / known - 1) for name, (_, known) in KNOWN.items())

    best = min(definitions, key=lambda name: distance(definitions[name]))
    listed = ", ".join(f"{name} {100 * distance(each):.2g} %" for name, each in definitions.items())
    return (
        f"The known figures of scene 1 belong to the program's own sea: γ with {best}, variance twice the spectrum's, "
        "and the program's variance in the Gaussian formula. "
        f"Farthest of the five figures from the known ones: {listed}."
    )


def _listed(numbers: list[int]) -> str:
    return f"scene{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"


def _ratios(fields: list[Field], formula: str) -> str:
    return ", ".join(f"{f.at(formula) / f.at('exact'):.3g}" for f in fields)


def _of(fields: list[Field], number: int, name: str) -> Field:
    return next(f for f in fields if f.number == number and f.name == name)


def _label(field: Field) -> str:
    return f"{field.number}, {SHORT[field.name]}"


def _three(number: float) -> str:
    return f"{number:.3g}"


def _with_error(mean: float, error: float) -> str:
    if not np.isfinite(error) or error <= 0:
        return f"{mean:.4g}"
    digits = max(0, -math.floor(math.log10(error)))
    return f"{mean:.{digits}f} ± {error:.{digits}f}"
