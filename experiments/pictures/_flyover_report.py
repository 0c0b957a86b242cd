"""What `flyover` says: numbers, tables, one page."""

from collections.abc import Sequence

import numpy as np

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table


def result(config: schema.FlyoverConfig, levels: Sequence, plane: float, notes: Sequence[str]) -> Result:
    """Numbers and tables, one row for each height."""
    del config
    medians = np.asarray([np.median(level.seconds) for level in levels])
    seen = np.asarray([np.mean(level.coverage) for level in levels])
    errors = np.asarray([standard_error(level.coverage) for level in levels])
    columns = (
        "height [m]",
        "footprint [m]",
        "time per frame [ms]",
        "least [ms]",
        "most [ms]",
        "coverage seen [-]",
        "± [-]",
        "seen / plane",
    )
    rows = [
        (
            level.height,
            level.footprint,
            1e3 * float(median),
            1e3 * float(np.min(level.seconds)),
            1e3 * float(np.max(level.seconds)),
            float(mean),
            float(error),
            float(mean) / plane if plane > 0 else float("nan"),
        )
        for level, median, mean, error in zip(levels, medians, seen, errors, strict=True)
    ]
    values = {
        "height": [level.height for level in levels],
        "footprint": [level.footprint for level in levels],
        "seconds_per_frame": medians,
        "coverage_seen": seen,
        "coverage_error": errors,
        "coverage_plane": plane,
        "dearest_over_cheapest": float(np.max(medians) / np.min(medians)),
        "farthest_from_mean_time": float(np.max(np.abs(medians / np.mean(medians) - 1))),
    }
    return Result(values=values, tables=(Table("Heights", columns, rows),), notes=tuple(notes))


def standard_error(values: np.ndarray) -> float:
    """Of the mean; NaN for one value."""
    return float(np.std(values, ddof=1) / np.sqrt(values.size)) if values.size > 1 else float("nan")


def report(config: schema.FlyoverConfig, levels: Sequence, plane: float, result: Result) -> str:
    """One page."""
    low, high = levels[0], levels[-1]
    span = result.values["farthest_from_mean_time"]
    ratio = result.values["dearest_over_cheapest"]
    seen = np.asarray(result.values["coverage_seen"])
    words = [
        f"From {low.height:g} m to {high.height:g} m above the water the median pixel's footprint on the sea grows "
        f"from {low.footprint:.2g} m to {high.footprint:.3g} m. A frame of {config.image.width} by "
        f"{config.image.height} pixels, with new fields and all layers, takes {_span(levels)} ms (medians of "
        f"{config.repeats}); every median lies within {100 * span:.0f} % of their mean, the dearest is {ratio:.2f} "
        "times the cheapest.",
        f"Whitecaps cover {100 * plane:.3g} % of the whole plane by the closed form; seen from these heights they "
        f"cover {100 * seen.min():.3g} to {100 * seen.max():.3g} % of the sea in view (means over {config.repeats} "
        "views of other water, each pixel counting alike; their errors as if the views were independent). From low "
        "down a view holds few waves, and crests hide troughs.",
    ]
    setting = f"this one realisation (seed {config.seed}), threshold {config.threshold:g}, projected area"
    return page("From metres to kilometres", words, result.tables, picture="flyover", setting=setting)


def _span(levels: Sequence) -> str:
    medians = [1e3 * float(np.median(level.seconds)) for level in levels]
    return f"{min(medians):.0f} to {max(medians):.0f}"
