"""What `picture_recovery` says: how many seas were found, how well, and whether the errors hold."""

from collections.abc import Sequence

import numpy as np

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table
from ._recovery_scenes import Number, numbers


def result(config: schema.PictureRecoveryConfig, recoveries: Sequence) -> Result:
    """Numbers, and tables of numbers and of seas."""
    sought = numbers(config)
    names = [number.name for number in sought]
    found = [each for each in recoveries if not each.failure]
    whole = [bool(np.all(each.inside)) for each in found]
    holds = np.asarray([each.holds(config.level) for each in found]).reshape(-1, len(sought))
    off = np.abs(np.asarray([each.found - each.truth for each in found])).reshape(-1, len(sought))
    inside = np.asarray([each.inside for each in found]).reshape(-1, len(sought))
    holding, middle = _means(holds), _medians(off)
    warm = [each.seconds for each in found if not each.compiled]
    values = {
        "seas": len(recoveries),
        "recovered": int(np.sum(whole)),
        "recovered_by_rays": sum(ok for ok, each in zip(whole, found, strict=True) if each.rays),
        "seas_by_rays": sum(each.rays for each in recoveries),
        "failed": len(recoveries) - len(found),
        "interval_coverage": float(np.mean(holds)) if found else float("nan"),
        "interval_coverage_of": dict(zip(names, holding, strict=True)),
        "median_error_of": dict(zip(names, middle, strict=True)),
        "seconds_median": float(np.median(warm)) if warm else float("nan"),
        "seconds_most": float(np.max(warm)) if warm else float("nan"),
    }
    rows = [
        (
            number.name,
            number.unit,
            _bound(number.bound),
            float(np.sum(inside[:, n])),
            middle[n],
            float(np.max(off[:, n])) if found else float("nan"),
            holding[n],
        )
        for n, number in enumerate(sought)
    ]
    columns = (
        "number",
        "unit",
        "asked",
        "seas within that",
        "median error",
        "largest error",
        f"share of {100 * config.level:g} % intervals that hold the truth",
    )
    tables = Table("Numbers", columns, rows), _seas(sought, recoveries)
    return Result(values=values, tables=tables)


def _bound(bound: tuple[float, bool] | None) -> str:
    if bound is None:
        return "-"
    most, relative = bound
    return f"± {100 * most:g} %" if relative else f"± {most:.3g}"


def _means(values: np.ndarray) -> list[float]:
    return [float(np.mean(column)) if column.size else float("nan") for column in values.T]


def _medians(values: np.ndarray) -> list[float]:
    return [float(np.median(column)) if column.size else float("nan") for column in values.T]


def _seas(sought: Sequence[Number], recoveries: Sequence) -> Table:
    columns = (
        "sea",
        "drawn by",
        "true U10",
        "foam [%]",
        *(f"{number.short} [{number.unit}]" for number in sought),
        "time [s]",
        "found",
    )
    rows = []
    for each in recoveries:
        off = ["-" if each.failure else f"{value:+.3f}" for value in each.found - each.truth]
        verdict = "no fit" if each.failure else "yes" if np.all(each.inside) else "no"
        # The first of a process holds the compilation.
        seconds = "-" if each.failure or each.compiled else f"{each.seconds:.0f}"
        about = f"{each.truth[0]:.1f}", f"{100 * each.coverage:.1f}"
        rows.append(
            (
                str(each.number),
                "rays" if each.rays else "mesh",
                *about,
                *off,
                seconds,
                verdict,
            )
        )
    return Table("Seas: found − true", columns, rows)


def report(config: schema.PictureRecoveryConfig, recoveries: Sequence, result: Result) -> str:
    """One page."""
    v = result.values
    words = [
        f"**{v['recovered']} of {v['seas']} seas** were found again in pictures of {config.width} by {config.height} "
        f"pixels, every number within its bound, from starts that were {100 * config.truths.nearest_start:g} to "
        f"{100 * config.truths.furthest_start:g} % off (directions in radians, exposures twice that in stops).",
        f"**{100 * v['interval_coverage']:.0f} %** of the {100 * config.level:g} % intervals hold the truth. They "
        "count how differently parts of the image pull, and how far the numbers would move if the picture were "
        "drawn by the other method, or with a single look at each pixel.",
        f"A fit takes {v['seconds_median']:.0f} s in the median and {v['seconds_most']:.0f} s at most, without "
        "compilation.",
    ]
    finish = (
        "The last pictures of a fit are drawn as a mesh and by rays, of which those count that explain the picture "
        "better."
        if config.finish == "better"
        else "Fits draw nothing but meshes: what draws pictures by rays is unknown to them, but for its part in the "
        "errors."
    )
    failures = [f"Sea {each.number}: {each.failure}" for each in recoveries if each.failure]
    setting = (
        f"targets with {config.detail}² times as many pixels, averaged; seed {config.seed}; the random numbers of "
        "the waves, the camera and the sun's azimuth are known"
    )
    page_words = [*words, finish, *failures, "![Target, start, found, and what remains](pictures.png)"]
    return page(
        "Seas found again in pictures", page_words, result.tables, picture="recovered", setting=setting
    )
