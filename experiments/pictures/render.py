"""`render`: a picture of a sea, the layers that it is made of, and its numbers."""

import jax
import numpy as np

import jaxocean as jo
from jaxocean import imagery, optics, render
from jaxocean.io import layer, read_panorama, write_exr, write_png

from .. import schema
from ..common import _build
from ..common._markdown import page
from ..harness._errors import UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result, Table

TONES = {"exposure": imagery.Exposure, "filmic": imagery.Filmic, "bruneton": imagery.Bruneton}

MIDDLE = 0.18
"""Where the median of the picture's luminance lands if no exposure is given."""


def run(config: schema.RenderConfig, progress: Reporter, store: Files) -> Result:
    """Render the picture of a config; see `schema.RenderConfig`."""
    progress.step("Realising the sea")
    ocean, camera = _ocean(config), _camera(config.camera)
    progress.step("Rendering")
    layers = render.render_layers(
        ocean,
        camera,
        config.time,
        (config.image.height, config.image.width),
        method=render.Raster(config.image.vertex_spacing),
        curvature=render.EARTH_CURVATURE if config.planet else 0.0,
    )
    layers = jax.tree.map(np.asarray, layers)
    progress.step("Writing the picture")
    exposure = _exposure(config.image, layers)
    code = TONES[config.image.tone](exposure)(jax.numpy.asarray(layers.radiance))
    write_png(store.folder / "picture.png", np.asarray(code))
    _write_layers(store, layers)
    return _report(config, store, ocean, layers, exposure)


def _ocean(config: schema.RenderConfig) -> jo.Ocean:
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind))
    sea = jo.surface.realise(spectrum, _build.cascade(config.cascade), key=jax.random.key(config.seed))
    water = config.water
    return jo.Ocean(
        sea,
        choppiness=config.choppiness,
        threshold=config.threshold,
        breaking_wavenumber=config.breaking_wavenumber,
        sky=_sky(config.sky),
        water=optics.Water(water.chlorophyll) if water.colour is None else optics.ConstantWater(water.colour),
        foam=optics.Foam(config.foam.reflectance),
    )


def _sky(config: schema.SkyConfig) -> optics.sky.AbstractSky:
    sun = (config.sun_elevation, config.sun_azimuth)
    match config:
        case schema.ClearSkyConfig():
            return optics.sky.HosekWilkie(config.turbidity, config.albedo, *sun)
        case schema.EvenSkyConfig():
            return optics.sky.ConstantSky(config.radiance, config.sun, *sun)
        case schema.PanoramaSkyConfig():
            try:
                read = read_panorama(config.file)
            except (OSError, ValueError) as problem:
                raise UserError(f"Key `sky.file`: {problem}") from problem
            return optics.sky.ImageSky(read.image, config.rotation, config.scale, config.sun, *sun)


def _camera(config: schema.CameraConfig) -> render.Camera:
    return render.Camera(
        config.position,
        heading=config.heading,
        pitch=config.pitch,
        field_of_view=config.field_of_view,
        roll=config.roll,
    )


def _exposure(config: schema.ImageConfig, layers: render.Layers) -> float:
    """The given exposure, or the one that puts the median luminance where a picture wants it."""
    if config.exposure is not None:
        return config.exposure
    middle = float(np.median(np.asarray(optics.luminance(jax.numpy.asarray(layers.radiance)))))
    return MIDDLE / middle if middle > 1e-12 else 1.0


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
    seen = float(np.mean(layers.coverage[sea])) if np.any(sea) else float("nan")
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
    notes = _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)
    words = (
        f"U10 = {config.wind.speed:g} m/s, seen from {config.camera.position[2]:g} m: {100 * share:.3g} % of the "
        f"picture is sea, and {100 * seen:.3g} % of that is foam; on the whole plane it is {100 * plane:.3g} %."
    )
    setting = f"this one realisation (seed {config.seed}), threshold {config.threshold:g}, projected area"
    store.text(
        "report.md", page("A picture of the sea", [words], [table], picture="picture", setting=setting)
    )
    return Result(values=values, tables=(table,), notes=notes)
