"""What a wavespectra-style dataset must look like: its conventions, checked, and its directions turned."""

from typing import Any

import numpy as np

BLOCK = 256
"""Records that are looked at together."""


def checked_variable(dataset: Any) -> Any:
    if "efth" not in dataset:
        names = ", ".join(f"`{name}`" for name in list(dataset.data_vars)[:6]) or "none"
        raise ValueError(
            f"The dataset has no variable `efth` (it has {names}): it is not a directional wave spectrum in "
            "wavespectra's convention."
        )
    efth = dataset["efth"]
    for name, meaning in (("freq", "frequency [Hz]"), ("dir", "direction [degrees]")):
        if name not in efth.dims or name not in dataset.coords:
            raise ValueError(
                f"Variable `efth` has no coordinate `{name}`, the {meaning}: "
                "it must have the dimensions (…, freq, dir), each with its coordinate."
            )
    units = str(efth.attrs.get("units", ""))
    if "rad" in units:
        raise ValueError(
            f"Variable `efth` is in {units}, but must be in m² s degree⁻¹: "
            "multiply it by π/180 and rename its units."
        )
    return efth


def frequencies(efth: Any) -> np.ndarray:
    frequency = np.asarray(efth["freq"].values, np.float64)
    if (
        not np.isfinite(frequency).all()
        or (frequency < 0).any()
        or np.unique(frequency).size < frequency.size
    ):
        raise ValueError("Coordinate `freq` must hold different numbers of at least 0 Hz, but does not.")
    return frequency


def directions(efth: Any) -> np.ndarray:
    """Directions in degrees, after a check of everything that betrays another convention."""
    coordinate = efth["dir"]
    name, units = (str(coordinate.attrs.get(key, "")).lower() for key in ("standard_name", "units"))
    text = f"{name} {str(coordinate.attrs.get('long_name', '')).lower()}".replace("_", " ")
    if "to direction" in text or "going to" in text or "towards" in text:
        raise ValueError(
            f"Coordinate `dir` holds directions that waves go to ({name or text.strip()}), but must hold "
            "those that they come from: replace it by (dir + 180) % 360 and correct its attributes."
        )
    degrees = np.asarray(coordinate.values, np.float64)
    if "rad" in units or (degrees.size > 4 and np.ptp(degrees) <= 2 * np.pi + 1e-3):
        raise ValueError(
            "Coordinate `dir` seems to be in radians, but must be in degrees clockwise from north: "
            "multiply it by 180/π, and `efth` by π/180."
        )
    if not np.isfinite(degrees).all() or degrees.min() < 0 or degrees.max() > 360:
        raise ValueError(
            "Coordinate `dir` must lie between 0 and 360 degrees clockwise from north, "
            f"but runs from {degrees.min():g} to {degrees.max():g}: take it modulo 360."
        )
    return degrees


def columns_by_angle(degrees: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which columns to take, in counter-clockwise order of the direction towards, and those directions [rad]."""
    columns = np.arange(degrees.size)
    if 0 in degrees and 360 in degrees:  # the same direction twice
        columns = columns[degrees != 360]
    towards = np.mod(270 - degrees[columns], 360)
    order = np.argsort(towards)
    steps = np.diff(np.append(towards[order], towards[order[0]] + 360))
    if order.size < 5 or np.ptp(steps) > 0.01 * 360 / order.size:
        raise ValueError(
            "Coordinate `dir` must cover the circle in at least 5 equal steps, but its "
            f"{order.size} directions have steps from {steps.min():g} to {steps.max():g} degrees: "
            "interpolate `efth` first."
        )
    first = np.deg2rad(towards[order[0]])
    return columns[order], first + 2 * np.pi / order.size * np.arange(order.size)


def highest_with_energy(efth: Any, frequency: np.ndarray) -> float:
    """The highest frequency [Hz] at which any record has energy; a block of records at a time."""
    along = [name for name in efth.dims if name not in ("freq", "dir")]
    table = efth.transpose(*along, "freq", "dir").values
    table = table.reshape(-1, *table.shape[-2:])  # a view, for the order in which files are read
    energy = np.zeros(frequency.size, bool)
    for start in range(0, table.shape[0], BLOCK):
        energy |= (np.nansum(table[start : start + BLOCK], axis=-1) > 0).any(axis=0)
    if not energy.any():
        raise ValueError("Variable `efth` is 0 everywhere: there is no sea in it.")
    return float(frequency[energy].max())
