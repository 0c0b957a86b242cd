"""What `wave_recovery` says: how well the waves are known."""

from collections.abc import Sequence

import numpy as np

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table
from ._waves_views import off


def result(config: schema.WaveRecoveryConfig, height: np.ndarray, found: Sequence) -> Result:
    """Errors for each number of pictures."""
    deviation = float(np.std(height))
    errors = [float(np.std(off(each.height, height))) for each in found]
    alike = [float(np.corrcoef(each.height.ravel(), height.ravel())[0, 1]) for each in found]
    columns = (
        "pictures",
        "rms error [m]",
        "rms error / rms height",
        "correlation with the truth",
        "steps",
        "at rest",
        "time [s]",
    )
    rows = [
        (
            str(each.views),
            error,
            error / deviation,
            f"{same:.4f}",
            str(max(each.cost)),
            "yes" if each.converged else "no",
            each.seconds,
        )
        for each, error, same in zip(found, errors, alike, strict=True)
    ]
    values = {
        "unknowns": 2 * config.resolution**2,
        "height_deviation": deviation,
        "views": [each.views for each in found],
        "error": errors,
        "correlation": alike,
        "converged": [each.converged for each in found],
        "seconds": [each.seconds for each in found],
    }
    return Result(values=values, tables=(Table("Waves", columns, rows),))


def report(config: schema.WaveRecoveryConfig, height: np.ndarray, found: Sequence, result: Result) -> str:
    """One page."""
    v = result.values
    each = "; ".join(
        f"from {count} picture{'s' if count > 1 else ''} to {100 * error:.2g} cm "
        f"({100 * error / v['height_deviation']:.2g} % of it, correlation {same:.4f})"
        for count, error, same in zip(v["views"], v["error"], v["correlation"], strict=True)
    )
    words = [
        f"The height of a patch of {config.side:g} m with a root mean square of {100 * v['height_deviation']:.3g} cm "
        f"is found {each}. {v['unknowns']} random numbers were free, and the search began on a flat sea.",
        f"Targets were drawn by rays with {config.detail}² times as many pixels; the fit draws a mesh. Wind, light, "
        "exposure and cameras are known.",
    ]
    waiting = [str(one.views) for one in found if not one.converged]
    if waiting:
        words.append(
            f"With {' and '.join(waiting)} of the pictures the search had not come to rest after {config.steps} "
            "steps: more of them would still lower the cost."
        )
    setting = (
        f"U10 = {config.wind.speed:g} m/s, {config.resolution}² waves, pictures of {config.width} by "
        f"{config.height} pixels, seed {config.seed}"
    )
    words.append("![The pictures](pictures.png)")
    return page("Waves from pictures", words, result.tables, picture="waves", setting=setting)
