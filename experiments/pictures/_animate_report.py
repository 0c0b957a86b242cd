"""What `animate` says: numbers, tables, one page."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import jaxocean as jo

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table
from . import _scene
from ._flicker import flicker, relative_flicker
from ._frames import Frames
from ._path import Path


@dataclass(frozen=True)
class Found:
    """A finished sequence in numbers.

    **Arguments:** `time` [s]; `place`: that of the camera at each (see `Place`); `numbers`: of each
    rendering, by name and quantity, at each time; `plane`: coverage of the whole plane; `flicker`: of each rendering by
    image row, [255ths of a code value], `error`: of its difference to the supersampled one; `notes`.
    """

    time: np.ndarray
    place: np.ndarray
    numbers: dict[str, dict[str, np.ndarray]]
    plane: float
    flicker: dict[str, np.ndarray]
    error: dict[str, np.ndarray]
    notes: Sequence[str]


def collect(
    config: schema.AnimateConfig,
    ocean: jo.Ocean,
    path: Path,
    times: Sequence[float],
    sequences: dict[str, Frames],
) -> Found:
    """Gather the numbers of the frames, and see how they flicker."""
    numbers = {}
    for name, sequence in sequences.items():
        records = list(sequence.numbers().values())
        numbers[name] = {
            each: np.asarray([record[each] for record in records])
            for each in ("coverage", "sea", "exposure", "seconds")
        }
    compared = sequences if config.compare else {}
    reference = sequences["supersampled"].files() if "supersampled" in sequences else None
    return Found(
        time=np.asarray(times),
        place=np.asarray([path.place(time) for time in times]),
        numbers=numbers,
        plane=float(ocean.coverage()),
        flicker={name: flicker(sequence.files()) for name, sequence in compared.items()},
        error={
            name: flicker(sequence.files(), reference)
            for name, sequence in compared.items()
            if reference is not None and name != "supersampled"
        },
        notes=_scene.limits(config, ocean),
    )


def result(config: schema.AnimateConfig, found: Found, notes: Sequence[str]) -> Result:
    """Numbers and tables."""
    own = found.numbers["filtered"]
    # The first frame of a process compiles.
    warm = float(np.median(own["seconds"]))
    seen = own["coverage"]
    table = Table(
        "Sequence",
        ("", "value", "unit"),
        (
            ("frames", config.frames, "-"),
            ("duration", config.frames / config.frames_per_second, "s"),
            ("exposure of all frames", float(own["exposure"][0]), "-"),
            ("whitecap coverage of the visible sea, mean over the frames", float(np.mean(seen)), "-"),
            ("  least of a frame", float(np.min(seen)), "-"),
            ("  most of a frame", float(np.max(seen)), "-"),
            ("whitecap coverage of the whole plane", found.plane, "-"),
            ("time to render a frame, median", warm, "s"),
        ),
    )
    values = {
        "frames": config.frames,
        "exposure": own["exposure"][0],
        "coverage_seen": float(np.mean(seen)),
        "coverage_plane": found.plane,
        "seconds_per_frame": warm,
        "flicker": {name: _whole(rows) for name, rows in found.flicker.items()},
        "flicker_of_error": {name: _whole(rows) for name, rows in found.error.items()},
        "flicker_of_coverage": {
            name: relative_flicker(found.numbers[name]["coverage"]) for name in found.flicker
        },
    }
    tables = (table, _flicker_table(found)) if found.flicker else (table,)
    return Result(values=values, tables=tables, notes=(*found.notes, *notes))


def _whole(rows: np.ndarray) -> float:
    return float(np.sqrt(np.mean(rows**2)))


def _flicker_table(found: Found) -> Table:
    rows = [
        (
            name,
            _whole(found.flicker[name]),
            _whole(found.error[name]) if name in found.error else float("nan"),
            100 * relative_flicker(found.numbers[name]["coverage"]),
            float(np.mean(found.numbers[name]["coverage"])),
        )
        for name in found.flicker
    ]
    columns = (
        "rendering",
        "flicker [1/255]",
        "flicker of the error [1/255]",
        "of the mean coverage [%]",
        "mean coverage [-]",
    )
    return Table("Flicker: root-mean-square second difference from frame to frame", columns, rows)


def report(config: schema.AnimateConfig, found: Found, result: Result) -> str:
    """One page."""
    seen = result.values["coverage_seen"]
    words = [
        f"{config.frames} frames at {config.frames_per_second:g} per second, from {config.start:g} s on, "
        f"U10 = {config.wind.speed:g} m/s, all with one exposure: {100 * seen:.3g} % of the sea in view is foam, "
        f"{100 * found.plane:.3g} % of the whole plane.",
    ]
    if found.flicker:
        whole = {name: _whole(rows) for name, rows in found.flicker.items()}
        words.append(
            "From frame to frame pixels flicker by "
            + ", ".join(f"{value:.3g}/255 {name}" for name, value in whole.items())
            + " (root-mean-square second difference of the code values, all pixels). Waves that move are part of it: "
            "how much is what the supersampled sequence has, where there is one. Look-ups at points read the fields "
            "bilinearly, and so miss some of the shortest waves, and with them some whitecaps near the camera; "
            "filtered ones know what they leave out."
        )
    setting = f"this one realisation (seed {config.seed}), threshold {config.threshold:g}, projected area"
    return page("A sequence of the sea", words, result.tables, picture="sequence", setting=setting)
