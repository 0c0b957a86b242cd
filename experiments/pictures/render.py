"""`render`: a picture of a sea, the layers that it is made of, and its numbers."""

import jax
import numpy as np

import jaxocean as jo
from jaxocean import render
from jaxocean.io import write_png

from .. import schema
from ..common._markdown import page
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result, Table
from . import _scene


def run(config: schema.RenderConfig, progress: Reporter, store: Files) -> Result:
    """Render the picture of a config; see `schema.RenderConfig`."""
    progress.step("Realising the sea")
    ocean = _scene.ocean(config)
    progress.step("Rendering; the first picture of its kind compiles, for half a minute or so")
    layers = render.render_layers(
        ocean,
        _scene.camera(config.camera),
        config.time,
        _scene.size(config.image),
        method=_scene.method(config.image),
        curvature=_scene.curvature(config),
    )
    layers = jax.tree.map(np.asarray, layers)
    progress.step("Writing the picture")
    exposure = _scene.exposure(config, layers.radiance)
    write_png(store.folder / "picture.png", _scene.code(config, exposure, layers.radiance))
    _scene.write_layers(store.folder / "layers.exr", layers)
    return _report(config, store, ocean, layers, exposure)


def _report(
    config: schema.RenderConfig, store: Files, ocean: jo.Ocean, layers: render.Layers, exposure: float
) -> Result:
    sea = layers.sea > 0.5
    share = float(np.mean(layers.sea))
    seen = _scene.seen_whitecaps(layers)
    plane = float(ocean.coverage())
    values = {
        "sea_share": share,
        "coverage_seen": seen,
        "coverage_plane": plane,
        "exposure": exposure,
        "nearest": float(np.min(layers.depth[sea])) if np.any(sea) else float("nan"),
    }
    table = Table(
        "Picture",
        ("", "value", "unit"),
        (
            ("share of the picture that is sea", share, "-"),
            ("whitecap coverage of the visible sea, mean over its pixels", seen, "-"),
            ("whitecap coverage of the whole plane", plane, "-"),
            ("distance of the nearest water", values["nearest"], "m"),
            ("exposure", exposure, "-"),
        ),
    )
    notes = _scene.limits(config, ocean)
    words = (
        f"U10 = {config.wind.speed:g} m/s, seen from {config.camera.position[2]:g} m: {100 * share:.3g} % of the "
        f"picture is sea, and {100 * seen:.3g} % of that is foam; on the whole plane it is {100 * plane:.3g} %."
    )
    setting = f"this one realisation (seed {config.seed}), threshold {config.threshold:g}, projected area"
    store.text(
        "report.md", page("A picture of the sea", [words], [table], picture="picture", setting=setting)
    )
    return Result(values=values, tables=(table,), notes=notes)
