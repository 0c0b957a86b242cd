"""`unknown_seas`: winds from pictures of seas whose waves are not known, and whether their intervals can be trusted."""

from dataclasses import asdict
from pathlib import Path

import numpy as np

from fitting import FitError
from fitting.pictures import Lesson

from .. import schema
from ..common._markdown import page
from ..harness import _records
from ..harness._errors import Interrupted, UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _image_views, _lessons, _photographs, _unknown_scenes, _winds

SHOWN = 4
"""Seas whose pictures are shown."""

DRAWN = {"raster": "a fine mesh", "rays": "rays"}


def run(config: schema.UnknownSeasConfig, progress: Reporter, store: Files) -> Result:
    """Look for all winds; see `schema.UnknownSeasConfig`."""
    kept, learned = store.unfinished() / "inferred.jsonl", store.unfinished() / "lesson.npz"
    done = {record["number"]: record for record in _records.read(kept)}
    try:
        lesson = _lesson(config, progress, learned)
        advance = progress.count("Winds looked for; the first compiles, for minutes", config.count)
        for number in range(config.count):
            if number not in done:
                done[number] = _infer(config, number, lesson)
                _records.append(kept, done[number])
            advance()
    except KeyboardInterrupt:
        raise Interrupted(
            f"Interrupted: what is learned and {len(done)} of {config.count} seas are kept, and the same command goes "
            "on with the others."
        ) from None
    inferred = [_winds.Inferred(**done[number]["inferred"]) for number in range(config.count)]
    progress.step("Drawing")
    level = config.inference.level
    _winds.plot(store, inferred, level, labels=False)
    _winds.save(store, inferred, "Winds found in pictures of seas whose waves are not known")
    _show(store, config, [done[number] for number in range(config.count)])
    found = _winds.scores(inferred)
    tables = _winds.score_table(found, level), _winds.wind_table(inferred, "sea", level)
    values = {
        "seas": len(inferred),
        "failed": sum(bool(each.failure) for each in inferred),
        "median_error": float(np.expm1(found[0].median_error)),
        "interval_coverage": found[0].holding,
        "rank_correlation": found[0].rank,
        "bias": found[0].bias,
        "median_error_of_the_regression": float(np.expm1(found[1].median_error)),
        "seconds_median": float(np.nanmedian([each.seconds for each in inferred] or [np.nan])),
    }
    notes = [f"Sea {each.name}: {each.failure}" for each in inferred if each.failure]
    result = Result(values=values, tables=tables, notes=notes)
    store.text("report.md", _report(config, result))
    return result


def _lesson(config: schema.UnknownSeasConfig, progress: Reporter, learned: Path) -> Lesson:
    rows = config.inference.rows
    size = rows, _unknown_scenes.columns(rows)
    return _lessons.learned(
        _unknown_scenes.camera(config), size, None, config, keep=learned, progress=progress
    )


def _infer(config: schema.UnknownSeasConfig, number: int, lesson: Lesson) -> dict:
    state = _unknown_scenes.draw(config, number)
    true = float(state.scene.wind.speed)
    try:
        image = _unknown_scenes.taken(config, state)
        fit = _photographs.fit(image, config, lesson)
    except (FitError, UserError) as problem:
        failed = _winds.Inferred.failed(str(number), true, problem)
        return {"number": number, "inferred": asdict(failed), "values": {}}
    foam = _winds.bright_share(image.light, image.camera, None)
    inferred = _winds.Inferred.of(str(number), true, fit, config.inference.level, foam)
    return {"number": number, "inferred": asdict(inferred), "values": fit.values}


def _show(store: Files, config: schema.UnknownSeasConfig, records: list[dict]) -> None:
    """`pictures.png`: some pictures, and beside each a sea of the state found."""
    found = [record for record in records if not record["inferred"]["failure"]]
    chosen = (
        [found[i] for i in np.unique(np.linspace(0, len(found) - 1, SHOWN).round().astype(int))]
        if found
        else []
    )
    parts = []
    for record in chosen:
        image = _unknown_scenes.taken(config, _unknown_scenes.draw(config, record["number"]))
        picture = _photographs.found_picture(image, config, record["values"])
        true, wind = record["inferred"]["true"], record["inferred"]["found"]
        parts.append(
            (image.light, picture, (f"Picture, {true:.1f} m/s", f"A sea of the state found, {wind:.1f} m/s"))
        )
    _image_views.pairs(store, parts)


def _report(config: schema.UnknownSeasConfig, result: Result) -> str:
    v = result.values
    level = 100 * config.inference.level
    words = [
        f"**The median error of U10 is {100 * v['median_error']:.0f} %** over {v['seas']} seas of "
        f"{config.lowest_wind:g} to {config.highest_wind:g} m/s, and {100 * v['interval_coverage']:.0f} % of the "
        f"{level:g} % intervals hold the truth. The regression with which the fit begins has "
        f"{100 * v['median_error_of_the_regression']:.0f} %.",
        f"The pictures are of JONSWAP seas, drawn by {DRAWN[config.targets]} with {config.detail}² times as many "
        "pixels and averaged; the fit draws eight rays for each pixel, and knows another family of spectra and other "
        "waves. Tilt is from the horizon; sun, clouds, direction, age of the sea, λ, haze, water and coverage are "
        "unknown to it. The camera's height and field of view are known, and the median and spread of the winds. A fit "
        f"takes {v['seconds_median']:.0f} s in the median.",
        "![Pictures, and what was found in them](pictures.png)",
    ]
    return page(
        "Winds from pictures of unknown waves",
        words,
        result.tables,
        picture="winds",
        setting=f"seed {config.seed}",
    )
