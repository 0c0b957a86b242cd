"""`render`: a picture of a sea, the layers that it is made of, and its numbers."""

import jax
import numpy as np

import jaxocean as jo
from jaxocean import render
from jaxocean.io import layer, write_exr, write_png

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
    progress.step("Rendering")
    layers = render.render_layers(
        ocean,
        _scene.camera(config.camera),
        config.time,
        _scene.size(config.image),
        method=_method(config.image),
        curvature=_scene.curvature(config),
    )
    layers = jax.tree.map(np.asarray, layers)
    progress.step("Writing the picture")
    exposure = _scene.exposure(config.image, layers.radiance)
    write_png(store.folder / "picture.png", _scene.code(config.image, exposure, layers.radiance))
    _write_layers(store, layers)
    return _report(config, store, ocean, layers, exposure)


def _method(image: schema.StillImageConfig) -> render.Raster | render.Rays:
    return render.Rays(image.samples) if image.method == "rays" else render.Raster(image.vertex_spacing)


def _write_layers(store: Files, layers: render.Layers) -> None:
    channels = layer("", "RGB", layers.radiance)
    for name in ("sun", "sky", "water", "foam", "background"):
        channels |= layer(name, "RGB", getattr(layers, name))
    channels |= layer("normal", "XYZ", layers.normal) | layer("rest_point", "XY", layers.rest_point)
    for name in ("sea", "coverage", "depth", "slope_variance", "jacobian_mean", "jacobian_variance"):
        channels |= layer(name, "Z" if name == "depth" else "Y", getattr(layers, name)[..., None])
    write_exr(store.folder / "layers.exr", channels)


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
