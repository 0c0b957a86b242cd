"""What `footprint_bias` found, in numbers and in words."""

import numpy as np

from .. import schema
from ..common import _build
from ..harness._files import Files
from ..harness._result import Result, Table
from . import _normality
from ._footprint_errors import CLOSURES
from ._footprint_storage import PAPER, shown
from ._footprint_views import Found, Sea
from ._footprint_words import TRUSTED, answers, good_up_to, judge, megabytes, worst_exact


def report(store: Files, found: Found, config: schema.FootprintBiasConfig) -> Result:
    """Result, tables, and `report.md`."""
    claim = judge(found)
    notes = answers(found, claim)
    notes += _build.outside_validity(config.spectrum, config.wind)
    notes += _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)
    tables = (
        _trust_table(found),
        *(_bias_table(found, t) for t in range(len(found.thresholds))),
        _storage_table(found),
    )
    store.text("report.md", _markdown(found, config, notes, tables))
    return Result(values=_values(found, claim), tables=tables, notes=notes)


def _trust_table(found: Found) -> Table:
    columns = (
        "U10 (m/s)",
        "ε",
        "counted W",
        "plane W",
        f"Gaussian within {100 * TRUSTED:g} % up to (m)",
        "its bias/W at most",
        "exact: bias/W at most",
    )
    rows = []
    for sea in found.seas:
        truth, error = sea.truth
        for t, threshold in enumerate(found.thresholds):
            counted = sea.counted[t]
            gaussian = np.max(sea.bias("gaussian")[0][t]) / truth[t] if counted else np.nan
            rows.append(
                (
                    sea.speed,
                    threshold,
                    f"{truth[t]:.2g} ± {error[t]:.1g}",
                    f"{sea.plane[t]:.2g}",
                    good_up_to(found, sea, t) if counted else float("nan"),
                    f"{gaussian:+.2g}" if counted else "-",
                    f"{worst_exact(found, sea, t)[0]:+.2g}" if counted else "-",
                )
            )
    return Table("Where Gaussian j can be trusted", columns, rows)


def _bias_table(found: Found, t: int) -> Table:
    columns = (
        "U10 (m/s)",
        "size (m)",
        "W",
        "exact",
        "Gaussian",
        "program",
        "printed undefined (%)",
        "exact RMS",
    )
    rows = []
    for sea in found.seas:
        truth, error = (each[t] for each in sea.truth)
        for s in range(0, len(found.tile.sides), 2 if len(found.tile.sides) > 8 else 1):
            rows.append(
                (
                    sea.speed,
                    float(found.tile.lengths[s]),
                    f"{truth:.2g} ± {error:.1g}",
                    *(_bias(sea, name, t, s) for name in ("exact", "gaussian", "program")),
                    float(100 * (1 - sea.defined("printed")[s])),
                    f"{sea.root_mean_square('exact')[0][t, s]:.1e}",
                )
            )
    return Table(
        f"Bias of W at ε = {found.thresholds[t]:g}, rest area, ± standard error over seas", columns, rows
    )


def _bias(sea: Sea, name: str, t: int, s: int) -> str:
    mean, error = (each[t, s] for each in sea.bias(name))
    return f"{mean:+.2g} ± {error:.1g}"


def _storage_table(found: Found) -> Table:
    columns = (
        "stored",
        "MB",
        *(f"W at {found.tile.lengths[i]:.3g} m (%)" for i in shown(found.tile)),
        "worst change of W",
    )
    rows = [
        (
            form.name,
            megabytes(form.bytes),
            *(f"{100 * x:+.2g}" if np.isfinite(x) else "-" for x in form.change),
            float(form.worst.max()),
        )
        for form in found.storage
    ]
    return Table("Pyramids of slopes and strain, and what rounding does to W", columns, rows)


def _values(found: Found, claim: dict) -> dict:
    return {
        "measure": "rest",
        "sizes_m": found.tile.lengths,
        "thresholds": found.thresholds,
        "claim": claim,
        "seas": [
            {
                "wind_speed_m_per_s": sea.speed,
                "coverage": sea.truth[0],
                "coverage_standard_error": sea.truth[1],
                "plane_coverage": sea.plane,
                "skewness": sea.skewness,
                "gaussian_within_25_percent_above": sea.trusted,
                "bias": {name: sea.bias(name)[0] for name in CLOSURES},
                "bias_standard_error": {name: sea.bias(name)[1] for name in CLOSURES},
                "root_mean_square_error": {name: sea.root_mean_square(name)[0] for name in CLOSURES},
                "printed_defined": sea.defined("printed"),
                "normality": {
                    quantity: dict(zip(_normality.STATISTICS, sea.shapes.mean(axis=0)[i], strict=True))
                    for i, quantity in enumerate(_normality.QUANTITIES)
                },
            }
            for sea in found.seas
        ],
        "storage": [
            {"name": f.name, "bytes": f.bytes, "change": f.change, "worst": f.worst} for f in found.storage
        ],
        "paper_bytes": PAPER,
    }


def _markdown(found: Found, config: schema.FootprintBiasConfig, notes: list[str], tables) -> str:
    limit = (
        "no low-pass"
        if config.breaking_wavenumber is None
        else f"breaking wavenumber {config.breaking_wavenumber:.4g} rad/m"
    )
    lines = [
        "# Closures in footprints",
        "",
        f"{config.realisations} seas for each wind, tiles of {found.tile.points * found.tile.spacing:.4g} m sampled "
        f"every {found.tile.spacing:g} m, λ = {config.choppiness}, {limit}, area at rest. Truth is the share of a "
        "footprint's own samples with j < ε, with j from the sum of the patterns.",
        "",
    ]
    for note in notes:
        lines += [note, ""]
    for table in tables:
        lines += [
            f"## {table.title}",
            "",
            "| " + " | ".join(table.columns) + " |",
            "|---" * len(table.columns) + "|",
        ]
        lines += ["| " + " | ".join(row) + " |" for row in table.cells()]
        lines.append("")
    return "\n".join(lines)
