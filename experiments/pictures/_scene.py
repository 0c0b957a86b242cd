"""From the sections of a picture's config to what is rendered, and from light to code values."""

import functools
import math
from collections.abc import Sequence
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean import imagery, optics, render
from jaxocean.io import layer, read_panorama, write_exr

from .. import schema
from ..common import _build
from ..harness._errors import UserError

TONES = {"exposure": imagery.Exposure, "filmic": imagery.Filmic, "bruneton": imagery.Bruneton}

SKY_REFLECTIONS = {
    "lobe": optics.LobeReflection,
    "facet": optics.FacetReflection,
    "bruneton": optics.BrunetonReflection,
}
MASKINGS = {
    "height_correlated": optics.HeightCorrelatedMasking,
    "azimuth_correlated": optics.AzimuthCorrelatedMasking,
    "independent": optics.IndependentMasking,
}
MIXINGS = {"share": optics.ShareMixing, "additive": optics.AdditiveMixing}

MIDDLE = 0.18
"""Where the median of the picture's luminance lands if no exposure is given."""

DAYLIGHT = 10.0
"""Median luminance [cd/m²] of the darkest picture that is shown as bright as by day.

Twice that at which vision by night begins to mix in (5 cd/m², CIE 191:2010): half of a picture is darker than its
median.
"""

CANDELA = 683.0 * 106.9
"""Luminance [cd/m²] of a radiance of Y = 1 [W m⁻² sr⁻¹ nm⁻¹]: 683 lm/W times ∫ȳ dλ [nm]."""


def ocean(config: schema.SceneConfig) -> jo.Ocean:
    """The sea of a config and the light on it."""
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind))
    sea = jo.surface.realise(spectrum, _build.cascade(config.cascade), key=jax.random.key(config.seed))
    return jo.Ocean(
        sea,
        choppiness=config.choppiness,
        unresolved=_unresolved(config),
        threshold=config.threshold,
        breaking_wavenumber=config.breaking_wavenumber,
        sky=sky(config.sky),
        water=_water(config.water),
        foam=_foam(config.foam),
        shading=_shading(config.shading, config.foam),
    )


def limits(config: schema.SceneConfig, ocean: jo.Ocean) -> list[str]:
    """Notes for pictures of a sea that the grid, or the spectrum, was not made for."""
    notes = _build.outside_validity(config.spectrum, config.wind)
    return notes + _build.unresolved_breaking(ocean.sea.cascade, config.breaking_wavenumber)


def _water(config: schema.WaterConfig) -> optics.AbstractWater:
    if config.colour is None:
        return optics.Water(config.chlorophyll)
    return optics.ConstantWater(config.colour, sunlit=config.sunlit)


def _unresolved(config: schema.SceneConfig) -> jo.spectra.AbstractSpectrum | None:
    """The spectrum of the waves that are too short for the patterns, if it is one of its own."""
    if config.unresolved_scale is None:
        return None
    own = config.spectrum.model_copy(update={"scale": config.unresolved_scale})
    return _build.spectrum(own, _build.wind(config.wind))


def _foam(config: schema.FoamLookConfig) -> optics.AbstractFoam:
    colour = optics.frouin_colour() if config.colour == "frouin" else 1.0
    if config.age is None:
        return optics.Foam(config.reflectance, colour)
    return optics.AgeingFoam(config.reflectance, colour=colour, age=config.age)


def _shading(config: schema.ShadingConfig, foam: schema.FoamLookConfig) -> optics.Shading:
    exact = config.fresnel == "exact"
    views = {"even": optics.EvenFoam, "flat": optics.FlatFoam}
    return optics.Shading(
        optics.ExactFresnel(config.refractive_index, config.extinction)
        if exact
        else optics.SchlickFresnel(config.normal_reflectance),
        SKY_REFLECTIONS[config.sky_reflection](),
        MASKINGS[config.masking](),
        optics.CrestFoam(foam.crest_preference) if foam.view == "crest" else views[foam.view](),
        MIXINGS[config.mixing](),
    )


def sky(config: schema.SkyConfig) -> optics.sky.AbstractSky:
    """The sky of a config."""
    up, around = config.sun_elevation, config.sun_azimuth
    match config:
        case schema.ClearSkyConfig():
            clear = optics.sky.HosekWilkie(
                config.turbidity, config.albedo, sun_elevation=up, sun_azimuth=around
            )
            return clear if config.cover == 0 else optics.sky.CloudySky(clear, config.cover)
        case schema.SpectralSkyConfig():
            return optics.sky.SpectralHosekWilkie(
                config.turbidity, config.albedo, sun_elevation=up, sun_azimuth=around
            )
        case schema.EvenSkyConfig():
            return optics.sky.ConstantSky(
                config.radiance, sun=config.sun, sun_elevation=up, sun_azimuth=around
            )
        case schema.PanoramaSkyConfig():
            try:
                read = read_panorama(config.file)
            except (OSError, ValueError) as problem:
                raise UserError(f"Key `sky.file`: {problem}") from problem
            return optics.sky.ImageSky(
                read.image,
                config.rotation,
                config.scale,
                sun=config.sun,
                sun_elevation=up,
                sun_azimuth=around,
            )


def camera(config: schema.CameraConfig) -> render.Camera:
    """The camera of a config."""
    heading, pitch = direction(config)
    return render.Camera(
        config.position,
        heading=heading,
        pitch=pitch,
        field_of_view=config.field_of_view,
        roll=config.roll,
    )


def direction(config: schema.CameraConfig) -> tuple[float, float]:
    """Heading and pitch [rad] of a config's camera."""
    if config.target is not None:
        return towards(config.position, config.target)
    return (
        schema.HEADING if config.heading is None else config.heading,
        schema.PITCH if config.pitch is None else config.pitch,
    )


def towards(position: Sequence[float], target: Sequence[float]) -> tuple[float, float]:
    """Heading and pitch [rad] from one point to another, as `Camera.look_at` has them."""
    x, y, z = (end - start for start, end in zip(position, target, strict=True))
    return math.atan2(y, x), math.atan2(-z, math.hypot(x, y))


def size(config: schema.ImageConfig) -> tuple[int, int]:
    """Rows and columns."""
    return config.height, config.width


def method(image: schema.RayImageConfig) -> render.Raster | render.Rays:
    """How the pixels of a config find the sea."""
    return render.Rays(image.samples) if image.method == "rays" else mesh(image)


def mesh(image: schema.ImageConfig) -> render.Raster:
    """The mesh of a config."""
    return render.Raster(image.vertex_spacing, shading_rate=image.shading_rate)


def curvature(config: schema.SceneConfig) -> float:
    """Of the planet [1/m], or 0."""
    return render.EARTH_CURVATURE if config.planet else 0.0


def exposure(config: schema.SceneConfig, radiance: np.ndarray) -> float:
    """The given exposure, or the one that puts the median luminance where a picture wants it.

    What is darker than `DAYLIGHT` stays as dark as it is: dusk is dim and night is black. A panorama has a unit of its
    own, and so no such limit.
    """
    if config.image.exposure is not None:
        return config.image.exposure
    least = 1e-12 if isinstance(config.sky, schema.PanoramaSkyConfig) else DAYLIGHT / CANDELA
    return MIDDLE / max(_median(radiance), least)


def shown(radiance: np.ndarray, beside: np.ndarray) -> np.ndarray:
    """Filmic code values, exposed as suits a picture that it is shown beside."""
    return np.asarray(imagery.Filmic(MIDDLE / _median(beside))(jnp.asarray(radiance)))


def _median(radiance: np.ndarray) -> float:
    """Of the luminance."""
    return float(np.median(np.asarray(optics.luminance(jnp.asarray(radiance)))))


def code(config: schema.SceneConfig, exposure: float, radiance: np.ndarray) -> np.ndarray:
    """sRGB code values, 0 to 1."""
    balanced = imagery.white_balance(jnp.asarray(radiance), jnp.asarray(white(config), radiance.dtype))
    return np.asarray(TONES[config.image.tone](exposure)(balanced))


def white(config: schema.SceneConfig) -> tuple[float, ...]:
    """The light that shall look white, in any unit: sRGB's own, or what falls on a level plate."""
    chosen = config.image.white_balance
    clear = isinstance(config.sky, schema.ClearSkyConfig | schema.SpectralSkyConfig)
    if chosen == "none" or (chosen is None and not clear):
        return (1.0, 1.0, 1.0)
    # Sections are frozen, and so hashable.
    return _on_a_plate(config.sky)  # pyright: ignore[reportArgumentType]


@functools.lru_cache(maxsize=8)
def _on_a_plate(config: schema.SkyConfig) -> tuple[float, ...]:
    """Irradiance of sun and sky on a level plate."""
    above = sky(config)
    light = above.sun_irradiance * jnp.maximum(above.sun_direction[2], 0.0) + above.irradiance()
    return tuple(np.asarray(light, np.float64).tolist())


def write_layers(path: Path, layers: render.Layers) -> None:
    """A picture's light and all that it is made of, as OpenEXR with named channels."""
    channels = layer("", "RGB", np.asarray(layers.radiance))
    for name in ("sun", "sky", "water", "foam", "background"):
        channels |= layer(name, "RGB", np.asarray(getattr(layers, name)))
    for name, axes in (("normal", "XYZ"), ("rest_point", "XY")):
        channels |= layer(name, axes, np.asarray(getattr(layers, name)))
    for name in ("sea", "coverage", "depth", "slope_variance", "jacobian_mean", "jacobian_variance"):
        plane = np.asarray(getattr(layers, name))[..., None]
        channels |= layer(name, "Z" if name == "depth" else "Y", plane)
    write_exr(path, channels)


def seen_whitecaps(layers: render.Layers) -> float:
    """Mean coverage over the pixels that show sea; NaN if none does."""
    sea = np.asarray(layers.sea) > 0.5
    return float(np.mean(np.asarray(layers.coverage)[sea])) if np.any(sea) else float("nan")
