"""What `foam_in_time` found, in numbers and in words."""

import numpy as np

from ..common import _build
from ..common._words import low_pass
from ..harness._result import Result, Table
from ._foam_results import View
from ._foam_views import CALLAGHAN, MONAHAN


def report(view: View) -> Result:
    """Result, tables and the answer in words."""
    config, calibration = view.config, view.calibration
    means = {
        name: view.mean(name)
        for name in ("active_rest", "active_projected", "total_rest", "total_projected", "birth_rate")
    }
    errors = {name: view.closure_error(name) for name in ("renewal", "poisson")}
    events = {
        key: [growth.events.mean(shortest) for growth in view.growths]
        for key, shortest in (("all", 0.0), ("seen", config.events.shortest))
    }
    values = {
        "threshold": calibration.used[0],
        "threshold_fitted": None if calibration.threshold is None else calibration.threshold.as_dict(),
        "decay_time_s": calibration.used[1],
        "decay_time_fitted": calibration.decay_time.as_dict(),
        "decay_time_per_wind_s": calibration.own_decay_time,
        "threshold_per_wind": calibration.own_threshold,
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
        "choppiness": config.choppiness,
        "wind_speed_m_per_s": config.wind.speed,
        "spin_up_s": view.growths[0].spin * config.step,
        "tile": {name: {"mean": mean, "standard_error": error} for name, (mean, error) in means.items()},
        "closed": {f"{closure}_{measure}": value for (closure, measure), value in calibration.closed.items()},
        "decay_times_s": calibration.decay_times,
        "active_closure_rest": calibration.points.rest,
        "active_closure_projected": calibration.points.projected,
        "crossing_rate_per_s": calibration.points.rate,
        "error_of_closure": {
            name: {"mean": mean, "standard_error": error} for name, (mean, error) in errors.items()
        },
        "point_duration_s": calibration.points.duration,
        "event_duration_s": {key: np.array(value)[:, 0] for key, value in events.items()},
        "event_duration_error_s": {key: np.array(value)[:, 1] for key, value in events.items()},
        "events_followed": [len(growth.events.duration) for growth in view.growths],
        "measured_event_duration_s": None if view.measured is None else float(view.measured.duration.mean()),
        "by_breaking_wavenumber": [
            dict(
                zip(
                    (
                        "breaking_wavenumber",
                        "threshold",
                        "decay_time",
                        "decay_time_error",
                        "shortest",
                        "longest",
                    ),
                    row,
                    strict=True,
                )
            )
            for row in calibration.table
        ],
        "active_law": calibration.active_law,
        "total_law": calibration.total_law,
    }
    tables = [_coverage_table(view, means), _duration_table(view, events)]
    if calibration.table:
        tables.append(_table_by_wavenumber(view))
    return Result(values=values, tables=tuple(tables), notes=tuple(_notes(view, means, errors, events)))


def _coverage_table(view: View, means: dict) -> Table:
    calibration, at = view.calibration, view.calibration.place
    rows = [
        (
            speed,
            f"{means['active_projected'][0, i]:.3g} ± {means['active_projected'][1, i]:.1g}",
            float(calibration.points.projected[i]),
            float(calibration.active_law[i]),
            f"{means['total_projected'][0, i]:.3g} ± {means['total_projected'][1, i]:.1g}",
            float(calibration.closed["renewal", "projected"][i, at]),
            float(calibration.closed["poisson", "projected"][i, at]),
            float(calibration.total_law[i]),
        )
        for i, speed in enumerate(view.config.wind.speed)
    ]
    columns = ("U10 (m/s)", "active: tile", "exact", "law", "total: tile", "renewal", "Poisson", "law ")
    sees = low_pass(view.config.breaking_wavenumber)
    title = (
        f"Coverage, projected area, ε = {calibration.used[0]:.3f}, τ = {calibration.used[1]:.3g} s, {sees}"
    )
    return Table(title, columns, rows)


def _duration_table(view: View, events: dict) -> Table:
    calibration = view.calibration
    rows = [
        (
            speed,
            float(calibration.points.duration[i]),
            _with_error(*events["all"][i]),
            _with_error(*events["seen"][i]),
            len(view.growths[i].events.duration),
            float(calibration.own_decay_time[i]),
        )
        for i, speed in enumerate(view.config.wind.speed)
    ]
    seen = f"≥ {view.config.events.shortest:.2g} s"
    columns = (
        "U10 (m/s)",
        "a point breaks (s)",
        "an event lasts (s)",
        seen,
        "events",
        "foam: τ of this wind (s)",
    )
    return Table("Times", columns, rows)


def _table_by_wavenumber(view: View) -> Table:
    speeds = view.config.wind.speed
    columns = (
        "k_b (rad/m)",
        "ε",
        "τ (s)",
        "±",
        f"T at {speeds[0]:g} m/s (s)",
        f"T at {speeds[-1]:g} m/s (s)",
    )
    return Table(
        "The decay time depends on the band of waves that foam sees", columns, view.calibration.table
    )


def _notes(view: View, means: dict, errors: dict, events: dict) -> list[str]:
    """The answer in words."""
    config, calibration = view.config, view.calibration
    speeds, at = config.wind.speed, calibration.place
    ratio = means["total_projected"][0] / means["active_projected"][0]
    notes = [
        f"Foam makes total coverage {_range(ratio, 'times')} the active one in projected area at "
        f"τ = {calibration.used[1]:.3g} s (tile, {_winds(speeds)})."
    ]
    fit = calibration.decay_time
    tau, error = fit.values["decay_time"], fit.errors["decay_time"]
    laws = (_build.law(config.active_law).name, _build.law(config.total_law).name)
    place = "inside" if CALLAGHAN[0] <= tau <= CALLAGHAN[1] else "outside"
    sees = low_pass(view.config.breaking_wavenumber)
    notes.append(
        f"Active coverage after {laws[0]} and total coverage after {laws[1]} agree best at one τ = {tau:.2f} ± "
        f"{error:.2f} s for all winds ({sees}, projected area): {place} the {CALLAGHAN[0]:g} to {CALLAGHAN[1]:g} s of "
        f"the literature, beside Monahan's {MONAHAN:g} s. It leaves {fit.rms[laws[1]]:.2f} in log10 W, and the error "
        f"is that of laws that scatter by half a decade. With ε and τ of its own, each wind obeys both laws at "
        f"τ = {_range(calibration.own_decay_time, 's')}."
    )
    if len(calibration.table) > 1:
        first, last = calibration.table[0], calibration.table[-1]
        notes.append(
            f"τ belongs to k_b like ε does: from k_b = {first[0]:g} to {last[0]:g} rad/m it goes from {first[2]:.2f} "
            f"to {last[2]:.2f} s, because shorter waves break for shorter times."
        )
    for name, text in (("renewal", "renewal foam"), ("poisson", "Poisson foam")):
        mean, spread = errors[name]
        worst = np.unravel_index(np.argmax(np.abs(mean)), mean.shape)
        here = 100 * mean[:, at]
        notes.append(
            f"Without a tile, {text} is at most {100 * np.abs(mean[worst]):.1f} ± {100 * spread[worst]:.1f} % off (at "
            f"{speeds[worst[0]]:g} m/s and τ = {calibration.decay_times[worst[1]]:.3g} s), and {here.min():+.1f} to "
            f"{here.max():+.1f} % at the τ in use, given how much and how often the tile breaks (rest area)."
        )
    raw = 100 * (calibration.closed["renewal", "projected"][:, at] / means["total_projected"][0] - 1)
    error = 100 * means["total_projected"][1] / means["total_projected"][0]
    notes.append(
        f"Straight from the spectrum it differs from the mean of {config.seas} seas by {raw.min():+.1f} to "
        f"{raw.max():+.1f} % (standard errors of these {error.min():.1f} to {error.max():.1f} %, projected area)."
    )
    loss = np.pi / 12 * (config.step / np.asarray(calibration.points.duration)) ** 2
    notes.append(
        f"Steps of {config.step:g} s miss about {100 * loss.max():.1g} % of the times that a point breaks, the "
        "shortest ones."
    )
    notes.append(_event_note(view, events))
    notes += _build.outside_validity(config.spectrum, config.wind)
    return notes + _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)


def _event_note(view: View, events: dict) -> str:
    seen = np.array(events["seen"])[:, 0]
    point = np.asarray(view.calibration.points.duration)
    words = (
        f"Three times must not be mixed up. A point of the water breaks for {_range(point, 's')}; a breaker, followed "
        f"from its first point to its last, lasts {_range(seen, 's')} (those of at least "
        f"{view.config.events.shortest:.2g} s); its foam decays with τ = {view.calibration.used[1]:.3g} s."
    )
    if view.measured is None:
        return (
            words
            + " There are no measured events to compare with (JAXOCEAN_DATA/breaking/breaking_events.csv)."
        )
    mean = float(view.measured.duration.mean())
    error = float(view.measured.duration.std(ddof=1) / np.sqrt(len(view.measured.duration)))
    return words + (
        f" Cameras measured {mean:.3f} ± {error:.3f} s ({len(view.measured.duration)} events, none shorter than "
        f"{view.measured.duration.min():.2f} s): that is the life of a breaker, not of its foam."
    )


def markdown(view: View, result: Result) -> str:
    """`report.md`."""
    lines = ["# Foam in time", ""]
    for note in result.notes:
        lines += [note, ""]
    lines += [
        "Rest area counts parcels of water, projected area what is seen from above; laws are compared with the "
        f"latter. Means leave out the first {view.growths[0].spin * view.config.step:g} s. Errors of coverage come "
        f"from the scatter of {view.config.seas} seas of each wind, those of the closed forms from blocks of "
        f"{view.config.block:g} s.",
        "",
    ]
    for table in result.tables:
        lines += [
            f"## {table.title}",
            "",
            "| " + " | ".join(table.columns) + " |",
            "|" + "---|" * len(table.columns),
        ]
        lines += ["| " + " | ".join(row) + " |" for row in table.cells()]
        lines.append("")
    return "\n".join(lines)


def _winds(speeds: tuple[float, ...]) -> str:
    return f"U10 = {speeds[0]:g} to {speeds[-1]:g} m/s"


def _range(values: np.ndarray, unit: str) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    return f"{low:.3g} to {high:.3g} {unit}"


def _with_error(value: float, error: float) -> str:
    return "-" if np.isnan(value) else f"{value:.2f} ± {error:.2f}"
