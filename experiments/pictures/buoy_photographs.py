"""`buoy_photographs`: winds from photographs of buoys, beside what the buoys measured and what needs no model."""

import csv
import re
from dataclasses import asdict
from pathlib import Path

import jaxocean as jo
from fitting import FitError

from .. import schema
from ..common._markdown import page
from ..harness import _records
from ..harness._errors import Interrupted, UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from ..schema._data import DATA_VARIABLE
from . import _image_views, _lessons, _photographs, _winds
from ._taken import Taken, taken_from


def run(config: schema.BuoyPhotographsConfig, progress: Reporter, store: Files) -> Result:
    """Look for the wind in every photograph; see `schema.BuoyPhotographsConfig`."""
    folder = config.photographs()
    winds = _labels(config, folder)
    kept = store.unfinished() / "inferred.jsonl"
    done = {record["file"]: record for record in _records.read(kept)}
    advance = progress.count("Photographs; each learns for minutes, and the first compiles", len(winds))
    try:
        for file, wind in winds.items():
            if file not in done:
                done[file] = _infer(config, folder, file, wind, store.unfinished())
                _records.append(kept, done[file])
            advance()
    except KeyboardInterrupt:
        raise Interrupted(
            f"Interrupted: {len(done)} of {len(winds)} photographs are kept, and what is learned of another, and the "
            "same command goes on from there."
        ) from None
    inferred = [_winds.Inferred(**done[file]["inferred"]) for file in winds]
    progress.step("Drawing")
    level = config.inference.level
    _winds.plot(store, inferred, level, labels=True)
    _winds.save(store, inferred, "Winds found in photographs of buoys")
    _show(store, config, folder, [done[file] for file in winds])
    found = _winds.scores(inferred)
    tables = _winds.score_table(found, level), _winds.wind_table(inferred, "photograph", level)
    values = {
        "photographs": len(inferred),
        "failed": sum(bool(each.failure) for each in inferred),
        **{
            name: {score.name: getattr(score, name) for score in found}
            for name in ("median_error", "bias", "rms", "rank")
        },
        "interval_coverage": found[0].holding,
    }
    notes = [f"{each.name}: {each.failure}" for each in inferred if each.failure]
    result = Result(values=values, tables=tables, notes=notes)
    store.text("report.md", _report(config, found, result))
    return result


def _labels(config: schema.BuoyPhotographsConfig, folder: Path) -> dict[str, float]:
    """U10 [m/s] by file."""
    labels = folder / "labels.csv"
    if not labels.is_file():
        raise UserError(
            f"Key `folder`: there is no `{labels}`: set it, or the environment variable {DATA_VARIABLE}, to "
            "where photographs lie with a labels.csv of the columns file and wind_speed_m_s."
        )
    with labels.open(encoding="utf-8-sig", newline="") as lines:
        rows = list(csv.DictReader(lines))
    try:
        measured = {row["file"]: float(row["wind_speed_m_s"]) for row in rows}
    except (KeyError, TypeError, ValueError) as problem:
        raise UserError(
            f"Key `folder`: `{labels}` must have the columns file and wind_speed_m_s, a number in each row."
        ) from problem
    if not measured:
        raise UserError(f"Key `folder`: `{labels}` lists no photograph.")
    return {
        file: float(jo.Wind.from_meteorological(wind, from_degrees=0.0, height=config.anemometer).speed)
        for file, wind in measured.items()
    }


def _taken(config: schema.BuoyPhotographsConfig, path: Path) -> Taken:
    return taken_from(path, None, config.camera, config.inference.rows, "folder")


def _infer(
    config: schema.BuoyPhotographsConfig, folder: Path, file: str, true: float, unfinished: Path
) -> dict:
    name = Path(file).stem.split("_")[0]
    try:
        image = _taken(config, folder / file)
    except UserError as problem:
        return _failed(file, name, true, problem)
    # A `UserError` from here on is about what is kept, and ends the run.
    learned = unfinished / f"{re.sub(r'[^A-Za-z0-9.-]', '_', file)}.npz"
    try:
        lesson = _lessons.learned(image.camera, image.size, image.mask, config, keep=learned)
        fit = _photographs.fit(image, config, lesson)
    except FitError as problem:
        return _failed(file, name, true, problem)
    foam = _winds.bright_share(image.light, image.camera, None)
    inferred = _winds.Inferred.of(name, true, fit, config.inference.level, foam)
    return {"file": file, "inferred": asdict(inferred), "values": fit.values}


def _failed(file: str, name: str, true: float, problem: Exception) -> dict:
    return {"file": file, "inferred": asdict(_winds.Inferred.failed(name, true, problem)), "values": {}}


def _show(store: Files, config: schema.BuoyPhotographsConfig, folder: Path, records: list[dict]) -> None:
    """`pictures.png`: each photograph, and beside it a sea of the state found."""
    parts = []
    for record in records:
        each = record["inferred"]
        if each["failure"]:
            continue
        image = _taken(config, folder / record["file"])
        picture = _photographs.found_picture(image, config, record["values"])
        titles = (
            f"{each['name']}: measured {each['true']:.1f} m/s",
            f"found {each['found']:.1f} ({each['low']:.1f} to {each['high']:.1f}) m/s",
        )
        parts.append((image.shown, picture, titles))
    _image_views.pairs(store, parts)


def _report(config: schema.BuoyPhotographsConfig, found: list[_winds.Score], result: Result) -> str:
    fit, _, median, foam = found
    level = 100 * config.inference.level
    words = [
        f"**Rank correlation with the measured wind {fit.rank:.2f}, bias {fit.bias:+.1f} m/s, rms error "
        f"{fit.rms:.1f} m/s; {100 * fit.holding:.0f} % of the {level:g} % intervals hold the measured wind.** The "
        f"constant median wind is off by {median.rms:.1f} m/s (rms), bright pixels through Monahan's "
        f"law by {foam.rms:.1f} m/s (rank correlation {foam.rank:.2f}).",
        "The camera is not known: its height and field of view are assumed, its tilt is from the horizon. The clouds "
        "of the photographs are in the model only as a mean over where they are. Measured winds are brought to 10 m "
        f"along the logarithmic profile from {config.anemometer:g} m.",
        "![Photographs, and seas of the states found](pictures.png)",
    ]
    setting = (
        f"camera {config.camera.height:g} m above the water, 60° from side to side unless said, "
        f"{_photographs.unsure(config.camera)}; seed {config.seed}"
    )
    return page("Winds from photographs of buoys", words, result.tables, picture="winds", setting=setting)
