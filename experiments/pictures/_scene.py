"""From the sections of a picture's config to what is rendered, and from light to code values."""

import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean import imagery, optics, render
from jaxocean.io import read_panorama

from .. import schema
from ..common import _build
from ..harness._errors import UserError

TONES = {"exposure": imagery.Exposure, "filmic": imagery.Filmic, "bruneton": imagery.Bruneton}

MIDDLE = 0.18
"""Where the median of the picture's luminance lands if no exposure is given."""


def ocean(config: schema.SceneConfig) -> jo.Ocean:
    """The sea of a config and the light on it."""
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind))
    sea = jo.surface.realise(spectrum, _build.cascade(config.cascade), key=jax.random.key(config.seed))
    return jo.Ocean(
        sea,
        choppiness=config.choppiness,
        threshold=config.threshold,
        breaking_wavenumber=config.breaking_wavenumber,
        sky=sky(config.sky),
        water=_water(config.water),
        foam=optics.Foam(config.foam.reflectance),
    )


def limits(config: schema.SceneConfig, ocean: jo.Ocean) -> list[str]:
    """Notes for pictures of a sea that the grid, or the spectrum, was not made for."""
    notes = _build.outside_validity(config.spectrum, config.wind)
    return notes + _build.unresolved_breaking(ocean.sea.cascade, config.breaking_wavenumber)


def _water(config: schema.WaterConfig) -> optics.AbstractWater:
    if config.colour is None:
        return optics.Water(config.chlorophyll)
    return optics.ConstantWater(config.colour, sunlit=config.sunlit)


def sky(config: schema.SkyConfig) -> optics.sky.AbstractSky:
    """The sky of a config."""
    up, around = config.sun_elevation, config.sun_azimuth
    match config:
        case schema.ClearSkyConfig():
            return optics.sky.HosekWilkie(
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
    return render.Camera(
        config.position,
        heading=config.heading,
        pitch=config.pitch,
        field_of_view=config.field_of_view,
        roll=config.roll,
    )


def size(config: schema.ImageConfig) -> tuple[int, int]:
    """Rows and columns."""
    return config.height, config.width


def curvature(config: schema.SceneConfig) -> float:
    """Of the planet [1/m], or 0."""
    return render.EARTH_CURVATURE if config.planet else 0.0


def exposure(config: schema.ImageConfig, radiance: np.ndarray) -> float:
    """The given exposure, or the one that puts the median luminance where a picture wants it."""
    if config.exposure is not None:
        return config.exposure
    middle = float(np.median(np.asarray(optics.luminance(jnp.asarray(radiance)))))
    return MIDDLE / middle if middle > 1e-12 else 1.0


def code(config: schema.ImageConfig, exposure: float, radiance: np.ndarray) -> np.ndarray:
    """sRGB code values, 0 to 1."""
    return np.asarray(TONES[config.tone](exposure)(jnp.asarray(radiance)))


def seen_whitecaps(layers: render.Layers) -> float:
    """Mean coverage over the pixels that show sea; NaN if none does."""
    sea = np.asarray(layers.sea) > 0.5
    return float(np.mean(np.asarray(layers.coverage)[sea])) if np.any(sea) else float("nan")
