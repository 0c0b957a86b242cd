"""`flyover`: the camera climbs from metres to kilometres; what a frame costs, and what whitecaps it shows."""

import time as clock
from dataclasses import dataclass

import numpy as np

import jaxocean as jo
from jaxocean import render

from .. import schema
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _flyover_report, _flyover_views, _scene


@dataclass(frozen=True)
class Level:
    """What is seen from one height above the water.

    **Arguments:** `height` [m]; `footprint`: side [m] of the square that is as large as the median pixel's view of the
    sea; `seconds`, `coverage`: of each frame; `picture`: code values of the first.
    """

    height: float
    footprint: float
    seconds: np.ndarray
    coverage: np.ndarray
    picture: np.ndarray


def run(config: schema.FlyoverConfig, progress: Reporter, store: Files) -> Result:
    """Climb; see `schema.FlyoverConfig`."""
    progress.step("Realising the sea")
    ocean = _scene.ocean(config)
    heights = np.geomspace(config.lowest, config.highest, config.heights)
    progress.step("Compiling")
    _frame(config, ocean, float(heights[0]), 0)
    advance = progress.count("Frames", config.heights * config.repeats)
    exposure, levels = None, []
    for height in heights:
        seconds, coverage, prints, picture = [], [], [], None
        for number in range(config.repeats):
            layers, spent = _frame(config, ocean, float(height), number)
            seconds.append(spent)
            coverage.append(_scene.seen_whitecaps(layers))
            prints.append(_footprint(layers))
            if picture is None:
                radiance = np.asarray(layers.radiance)
                exposure = exposure or _scene.exposure(config, radiance)
                picture = _scene.code(config, exposure, radiance)
            advance()
        levels.append(
            Level(
                float(height),
                float(np.median(prints)),
                np.asarray(seconds),
                np.asarray(coverage),
                np.asarray(picture),
            )
        )
    progress.step("Drawing")
    plane = float(ocean.coverage())
    _flyover_views.plot(store, levels, plane)
    _flyover_views.save(store, levels, plane)
    notes = _scene.limits(config, ocean)
    result = _flyover_report.result(config, levels, plane, notes)
    store.text("report.md", _flyover_report.report(config, levels, plane, result))
    return result


def _frame(
    config: schema.FlyoverConfig, ocean: jo.Ocean, height: float, number: int
) -> tuple[render.Layers, float]:
    """One frame from a height above the water there, and the seconds that it took."""
    x, y, _ = config.camera.position
    heading = float(_scene.camera(config.camera).heading)
    aside = number * config.apart
    place = np.asarray([x - aside * np.sin(heading), y + aside * np.cos(heading)])
    time = config.start + number
    water = float(ocean.sea.height_at(place, time, ocean.choppiness))
    moved = config.camera.model_copy(update={"position": (*place.tolist(), water + height)})
    began = clock.perf_counter()
    layers = render.render_layers(
        ocean,
        _scene.camera(moved),
        time,
        _scene.size(config.image),
        method=_scene.mesh(config.image),
        curvature=_scene.curvature(config),
    )
    layers.radiance.block_until_ready()
    return layers, clock.perf_counter() - began


def _footprint(layers: render.Layers) -> float:
    """Side [m] of a square as large as what the median pixel sees of the plane at rest."""
    points, sea = np.asarray(layers.rest_point, np.float64), np.asarray(layers.sea) > 0.99
    whole = sea[:-1, :-1] & sea[1:, :-1] & sea[:-1, 1:]
    across, down = (points[:-1, 1:] - points[:-1, :-1])[whole], (points[1:, :-1] - points[:-1, :-1])[whole]
    area = np.abs(across[:, 0] * down[:, 1] - across[:, 1] * down[:, 0])
    return float(np.sqrt(np.median(area))) if area.size else float("nan")
