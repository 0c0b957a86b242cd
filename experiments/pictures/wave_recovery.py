"""`wave_recovery`: the height of a patch of sea from pictures of it, with maps of what is wrong."""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from fitting.pictures import PictureTarget, SceneModel, View, recover_waves
from jaxocean.render import Camera, Raster, Rays

from .. import schema
from ..common import _build
from ..harness import _records
from ..harness._errors import Interrupted
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _waves_report, _waves_views
from ._recovery_scenes import target

TURN = 2.1
"""Angle [rad] from one view to the next: none looks along the line of another."""


@dataclass(frozen=True)
class Recovered:
    """The waves from some views: `height` [m] of the patch [y, x]; `cost` by number of the `step`."""

    views: int
    height: np.ndarray
    cost: dict[int, float]
    converged: bool
    seconds: float


def run(config: schema.WaveRecoveryConfig, progress: Reporter, store: Files) -> Result:
    """Recover the waves; see `schema.WaveRecoveryConfig`."""
    progress.step("Drawing the targets")
    truth = _scene(config)
    views = [_view(config, truth, number) for number in range(max(config.views))]
    kept = store.unfinished() / "recovered.jsonl"
    done = {record["views"]: record for record in _records.read(kept)}
    for count in config.views:
        if count not in done:
            advance = progress.count(
                f"Steps with {count} of the views; the first compiles", config.steps // 10 + 1
            )
            try:
                done[count] = _recover(config, truth, views[:count], advance)
            except KeyboardInterrupt:
                raise Interrupted(
                    f"Interrupted: {len(done)} of {len(config.views)} searches are kept, and the same command goes on "
                    "with the others."
                ) from None
            _records.append(kept, done[count])
    found = [_read(done[count]) for count in config.views]
    progress.step("Drawing")
    height = _height(truth)
    pictures = [np.asarray(view.target.image) for view in views]
    _waves_views.plot(store, config, height, found, pictures)
    _waves_views.save(store, config, height, found)
    result = _waves_report.result(config, height, found)
    store.text("report.md", _waves_report.report(config, height, found, result))
    return result


def _scene(config: schema.WaveRecoveryConfig) -> SceneModel:
    cascade = jo.surface.Cascade((config.side,), config.resolution)
    return SceneModel(
        _build.wind(config.wind),
        _camera(config, 0),
        cascade=cascade,
        noise=jo.surface.draw_noise(cascade, key=jax.random.key(config.seed)),
        threshold=config.threshold,
        sky=jo.optics.sky.HosekWilkie(2.5, sun_elevation=config.sun_elevation, sun_azimuth=2.0),
    )


def _camera(config: schema.WaveRecoveryConfig, number: int) -> Camera:
    heading = 0.3 + TURN * number
    away = config.altitude / np.tan(config.pitch)
    return Camera(
        (-away * np.cos(heading), -away * np.sin(heading), config.altitude),
        heading=heading,
        pitch=config.pitch,
        field_of_view=config.field_of_view,
    )


def _view(config: schema.WaveRecoveryConfig, truth: SceneModel, number: int) -> View:
    camera = _camera(config, number)
    scene = eqx.tree_at(lambda s: s.camera, truth, camera)
    image = target(scene, (config.height, config.width), config.detail, Rays())
    return View(camera, 0.0, PictureTarget(image))


def _height(scene: SceneModel) -> np.ndarray:
    return np.asarray(scene.ocean().fields(0.0).height[0])


def _recover(
    config: schema.WaveRecoveryConfig, truth: SceneModel, views: list[View], advance: Callable[[], None]
) -> dict:
    calm = eqx.tree_at(lambda s: s.noise, truth, jnp.zeros_like(truth.noise))
    found = recover_waves(
        calm,
        views,
        scatter=config.scatter,
        method=Raster(2.0),
        most_steps=config.steps,
        report=lambda step: advance(),
    )
    return {
        "views": len(views),
        "height": _height(found.model).tolist(),
        "cost": {step.number: step.cost for step in found.steps},
        "converged": found.converged,
        "seconds": found.seconds,
    }


def _read(record: dict) -> Recovered:
    cost = {int(step): value for step, value in record["cost"].items()}
    return Recovered(**{**record, "height": np.asarray(record["height"]), "cost": cost})
