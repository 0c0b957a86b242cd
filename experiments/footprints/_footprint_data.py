"""Data files of closures in footprints."""

import numpy as np
import xarray as xr

from .. import schema
from ..harness._files import Files, variable
from . import _normality
from ._footprint_errors import CLOSURES
from ._footprint_views import Found


def save(store: Files, found: Found, config: schema.FootprintBiasConfig) -> None:
    """`footprint_bias.nc` and `normality.nc`."""
    seas = found.seas
    attributes = {
        "measure": "rest",
        "choppiness": np.atleast_1d(config.choppiness),
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
        "realisations": config.realisations,
        "tile_points": config.tile.points,
        "tile_spacing_m": config.tile.spacing,
    }
    speed = variable(
        "wind", [sea.speed for sea in seas], units="m s-1", long_name="U10", standard_name="wind_speed"
    )
    level = variable("threshold", list(found.thresholds), units="1", long_name="breaking threshold")
    length = variable("size", found.tile.lengths, units="m", long_name="side of the footprint")
    names = _names("closure", CLOSURES)
    seed = variable("realisation", np.arange(config.realisations), units="1", long_name="number of the sea")
    errors = [[sea.errors[i] for i in range(config.realisations)] for sea in seas]
    axes = ("wind", "realisation", "closure", "threshold", "size")

    def stacked(name: str) -> np.ndarray:
        return np.stack([np.stack([getattr(each, name) for each in row]) for row in errors])

    def one(dimensions, values, words):
        return variable(dimensions, values, units="1", long_name=words)

    store.data(
        "footprint_bias",
        {
            "coverage": one(
                axes[:2] + axes[3:4], stacked("truth"), "counted coverage of the tile, rest area"
            ),
            "plane_coverage": one(
                ("wind", "threshold"), np.stack([s.plane for s in seas]), "exact coverage of the whole plane"
            ),
            "bias": one(axes, stacked("bias"), "mean over footprints of closure minus counted coverage"),
            "root_mean_square_error": one(
                axes, np.sqrt(stacked("squared")), "root-mean-square of closure minus counted coverage"
            ),
            "defined": one(
                ("wind", "realisation", "closure", "size"),
                stacked("defined"),
                "share of footprints where the closure is defined",
            ),
        },
        {"wind": speed, "realisation": seed, "closure": names, "threshold": level, "size": length},
        title="Errors of whitecap closures in footprints",
        attributes=attributes,
    )
    sides = np.asarray(_normality.sizes(found.tile)) * found.tile.spacing
    quantity = _names("quantity", _normality.QUANTITIES)
    shapes = np.stack([sea.shapes for sea in seas])
    store.data(
        "normality",
        {
            name.replace(" ", "_"): one(
                ("wind", "realisation", "quantity", "size"),
                shapes[:, :, :, i],
                f"{name} inside footprints, mean over footprints",
            )
            for i, name in enumerate(_normality.STATISTICS)
        },
        {
            "wind": speed,
            "realisation": seed,
            "quantity": quantity,
            "size": variable("size", sides, units="m", long_name="side of the footprint"),
        },
        title="Distance of slopes and Jacobian from the normal distribution inside footprints",
        attributes=attributes,
    )


def _names(what: str, names: tuple[str, ...]) -> xr.Variable:
    """Numbers that stand for names, as CF has it."""
    numbers = np.arange(len(names), dtype=np.int32)
    meanings = " ".join(name.replace(" ", "_") for name in names)
    return variable(what, numbers, units="1", long_name=what, flag_values=numbers, flag_meanings=meanings)
