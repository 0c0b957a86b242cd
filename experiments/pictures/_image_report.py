"""What `fit_image` says: the wind, how sure it is, and what the model does not explain."""

import numpy as np

from fitting.pictures import PhotographFit

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table
from ._photographs import FREE, UNITS, WIND, unsure
from ._taken import Taken

FAR = 3.0
"""Standard deviations beyond which a statistic is named."""

BADLY = 3.0
"""Misfit from which the photograph counts as unlike the model's."""


def result(config: schema.FitImageConfig, found: PhotographFit, truth: float | None) -> Result:
    """Numbers, and tables of them."""
    level = config.inference.level
    low, high = found.interval(WIND, level)
    values = {
        "wind_speed": found.values[WIND],
        "wind_speed_interval": [low, high],
        "wind_speed_of_the_regression": found.guess[WIND],
        "misfit": found.misfit,
        "true_wind_speed": truth,
        "seconds": found.seconds,
        **{name: found.values[name] for name in found.labels if name != WIND},
    }
    rows = []
    for label, name, unit in zip(found.labels, FREE, UNITS, strict=True):
        lower, upper = found.interval(label, level)
        rows.append((name, unit, found.values[label], f"{lower:.3g} to {upper:.3g}", found.guess[label]))
    columns = "number", "unit", "found", f"{100 * level:g} % interval", "by regression alone"
    seen = [
        (name, observed, predicted, chance, (observed - predicted) / chance if chance > 0 else float("nan"))
        for name, observed, predicted, chance in zip(
            found.names, found.observed, found.predicted, found.chance, strict=True
        )
    ]
    statistics = Table(
        "Statistics of the image", ("statistic", "image", "model", "chance", "off (in chances)"), seen
    )
    notes = []
    if found.misfit > BADLY:
        notes.append(
            f"The image is unlike any that the model draws (misfit {found.misfit:.1f}, 1 would be chance): the wind is "
            "worth less than the interval says."
        )
    return Result(values=values, tables=(Table("What was found", columns, rows), statistics), notes=notes)


def report(
    config: schema.FitImageConfig, found: PhotographFit, taken: Taken, result: Result, truth: float | None
) -> str:
    """One page."""
    v = result.values
    low, high = v["wind_speed_interval"]
    words = [
        f"**U10 = {v['wind_speed']:.1f} m/s**, with {100 * config.inference.level:g} % probability between "
        f"{low:.1f} and {high:.1f} m/s"
        + ("." if truth is None else f"; the picture was made here with {truth:.1f} m/s."),
        f"The regression alone, from which the fit went down, says {v['wind_speed_of_the_regression']:.1f} m/s. "
        f"The misfit is {v['misfit']:.2g}: mean square distance of what the image's statistics are from what they are "
        "in pictures of the state found, in units of chance.",
    ]
    distance = (found.observed - found.predicted) / np.maximum(found.chance, 1e-9)
    off = [(name, float(z)) for name, z in zip(found.names, distance, strict=True) if abs(z) > FAR]
    if off:
        worst = sorted(off, key=lambda each: -abs(each[1]))[:6]
        words.append(
            "The model does not explain: "
            + ", ".join(f"{name} ({z:+.1f} chances)" for name, z in worst)
            + "."
        )
    words += ["![The way down](filmstrip.png)", "![Statistics](statistics.png)"]
    camera = taken.camera
    setting = (
        f"camera {config.camera.height:g} m above the water{' it floats on' if config.camera.afloat else ''}, pitch "
        f"{float(camera.pitch):.3f} rad, roll {float(camera.roll):.3f} rad, field of view "
        f"{float(camera.field_of_view):.3f} rad, {unsure(config.camera)}; "
        f"whitecaps as Monahan 1980 within a factor e^±0.46; seed {config.seed}"
    )
    return page("The wind from a photograph", words, result.tables, picture="fitted", setting=setting)
