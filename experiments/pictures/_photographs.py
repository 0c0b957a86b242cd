"""What experiments on photographs share: what is sought, and what is not known besides."""

from collections.abc import Callable, Mapping
from functools import lru_cache

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from fitting import ElfouhailySea, Interval, LogNormal, Parameter
from fitting.pictures import (
    Lesson,
    Photograph,
    PhotographFit,
    SceneModel,
    UncertainSea,
    fit_photograph,
)
from jaxocean.optics.sky import CloudySky, HosekWilkie
from jaxocean.render import Camera, Raster

from .. import schema
from ..common import _build
from ._taken import Taken

FREE = ("wind speed", "sun elevation", "sun azimuth", "cloud cover")
UNITS = ("m/s", "rad", "rad", "-")
WIND = "speed"

PLACES: dict[str, Callable] = {
    WIND: lambda m: m.scene.wind.speed,
    "sun_elevation": lambda m: m.scene.sky.clear.sun_elevation,
    "sun_azimuth": lambda m: m.scene.sky.clear.sun_azimuth,
    "cover": lambda m: m.scene.sky.cover,
}
"""Where the numbers of `FREE` stand in the model, by the names that a fit gives them."""

HIGHEST_SUN = 1.45
TURBIDITY, CHLOROPHYLL, OPEN, BLUR = 3.5, 0.15, 0.3, 0.07
SUN = 0.7
"""Elevation [rad] that is expected."""

WAVE_AGE, DEVELOPED = 1.0, 0.84
"""Ω [-]: most seas are still growing a little; that of a fully developed one."""

BREAKING = 6.0
"""Breaking wavenumber [rad/m]: whitecaps that a photograph shows are of waves of a metre and more."""

PhotographsConfig = schema.FitImageConfig | schema.UnknownSeasConfig | schema.BuoyPhotographsConfig


def free(config: schema.InferenceConfig) -> list[Parameter]:
    """What is sought, in the order of `FREE`, with what is known of it before."""
    known = {
        WIND: {"prior": LogNormal(config.median_wind, config.wind_spread)},
        "sun_elevation": {"bounds": Interval(0.05, HIGHEST_SUN)},
    }
    return [Parameter(where, **known.get(name, {})) for name, where in PLACES.items()]


def vary(photograph: Photograph, key) -> Photograph:
    """The same with what is neither known nor sought drawn at random.

    | number | distribution |
    |---|---|
    | direction of wind and waves, from the camera | any |
    | Ω | 1.0 within a factor e^±0.2, but never below 0.84: a sea that is older has other waves than the wind's |
    | waves of all lengths, and short ones by a power of k | e^±0.2, ± 0.3, see `UncertainSea` |
    | ripples, which films damp and no two spectra agree on | e^(−0.25 ± 0.6): of a slick a quarter is left |
    | swell | \\|N(0, 0.8)\\| m of 11 ± 1.5 s from anywhere |
    | coverage over the law's | 10^±0.2 |
    | λ | 1 ± 0.12 |
    | turbidity, chlorophyll | 3.5 within e^±0.4, 0.15 mg/m³ within e^±0.8 |
    | blur and contrast of the camera | 0.07 ± 0.07, e^±0.15 |
    """
    normal = jax.random.normal(jax.random.fold_in(key, 0), (12,), jnp.float32)
    turns = jax.random.uniform(jax.random.fold_in(key, 1), (2,), jnp.float32, -np.pi, np.pi)
    drawn = {
        lambda m: m.scene.wind.direction: turns[0],
        lambda m: m.scene.spectrum.wind_sea.inverse_wave_age: jnp.maximum(
            WAVE_AGE * jnp.exp(0.2 * normal[0]), DEVELOPED
        ),
        lambda m: m.scene.spectrum.level: 0.2 * normal[1],
        lambda m: m.scene.spectrum.tilt: 0.3 * normal[2],
        lambda m: m.scene.spectrum.ripples: 0.6 * normal[11] - 0.25,
        lambda m: m.scene.spectrum.swell_height: jnp.abs(0.8 * normal[3]),
        lambda m: m.scene.spectrum.swell_period: 11 + 1.5 * jnp.clip(normal[4], -3.0, 3.0),
        lambda m: m.scene.spectrum.swell_turn: turns[1],
        lambda m: m.excess: 0.2 * normal[5],
        lambda m: m.scene.choppiness: 1 + 0.12 * normal[6],
        lambda m: m.scene.sky.clear.turbidity: jnp.clip(TURBIDITY * jnp.exp(0.4 * normal[7]), 1.5, 9.0),
        lambda m: m.scene.water.chlorophyll: CHLOROPHYLL * jnp.exp(0.8 * normal[8]),
        lambda m: m.blur: BLUR * (1 + normal[9]),
        lambda m: m.contrast: jnp.exp(0.15 * normal[10]),
    }
    return eqx.tree_at(lambda m: [where(m) for where in drawn], photograph, list(drawn.values()))


@lru_cache
def varied(height_spread: float, view_spread: float) -> Callable:
    """`vary`, also for a camera that is not known: the same function each time, so that it compiles once.

    Statistics are taken with the camera as it is assumed. The horizon is where the image shows it, so that with another
    field of view it looked down by another angle too.
    """
    if not height_spread and not view_spread:
        return vary

    def with_camera(photograph: Photograph, key) -> Photograph:
        camera = photograph.scene.camera
        normal = jax.random.normal(jax.random.fold_in(key, 2), (2,), jnp.float32)
        higher, wider = jnp.exp(height_spread * normal[0]), jnp.exp(view_spread * normal[1])
        position, view, pitch = camera.position, camera.field_of_view, camera.pitch
        drawn = {
            lambda c: c.position: position.at[2].multiply(higher.astype(position.dtype)),
            lambda c: c.field_of_view: 2 * jnp.arctan(wider.astype(view.dtype) * jnp.tan(0.5 * view)),
            lambda c: c.pitch: jnp.arctan(wider.astype(pitch.dtype) * jnp.tan(pitch)),
        }
        camera = eqx.tree_at(lambda c: [where(c) for where in drawn], camera, list(drawn.values()))
        return vary(eqx.tree_at(lambda m: m.scene.camera, photograph, camera), key)

    return with_camera


def unsure(config: schema.PhotographCameraConfig) -> str:
    """How far the camera is not known, in words."""
    spreads = (("height", config.height_spread), ("tangent of half the field of view", config.view_spread))
    parts = [f"{name} known within a factor e^±{spread:g}" for name, spread in spreads if spread]
    return " and ".join(parts) or "height and field of view taken as given"


def start(
    camera: Camera, config: schema.PhotographCameraConfig, patterns: schema.CascadeConfig, seed: int
) -> Photograph:
    """The middle of what is expected."""
    cascade = _build.cascade(patterns)
    scene = SceneModel(
        jo.Wind(8.0, 0.0),
        camera,
        cascade=cascade,
        noise=jo.surface.draw_noise(cascade, key=jax.random.key(seed)),
        breaking_wavenumber=min(BREAKING, float(cascade.wavenumber_limit)),
        spectrum=UncertainSea(ElfouhailySea(WAVE_AGE)),
        sky=CloudySky(HosekWilkie(TURBIDITY, sun_elevation=SUN), OPEN),
        water=jo.optics.Water(CHLOROPHYLL),
        afloat=config.afloat,
    )
    return Photograph(scene, blur=BLUR)


def before(config: schema.FitImageConfig) -> dict[str, float]:
    """What is expected of the free numbers before an image is seen."""
    return dict(zip(PLACES, (config.inference.median_wind, SUN, 0.0, OPEN), strict=True))


def fit(image: Taken, config: PhotographsConfig, lesson: Lesson, **options) -> PhotographFit:
    """Wind and light of an image; `options` as for `fit_photograph`."""
    inference = config.inference
    return fit_photograph(
        start(image.camera, config.camera, config.cascade, config.seed),
        free(inference),
        image.light,
        mask=image.mask,
        vary=varied(config.camera.height_spread, config.camera.view_spread),
        seas=inference.seas,
        most_steps=inference.steps,
        seed=config.seed,
        lesson=lesson,
        **options,
    )


def with_values(photograph: Photograph, values: Mapping[str, float]) -> Photograph:
    """The state with numbers that were found in it."""
    found = [jnp.asarray(values[name], jnp.float32) for name in PLACES]
    return eqx.tree_at(lambda m: [where(m) for where in PLACES.values()], photograph, found)


def found_picture(
    image: Taken, config: schema.UnknownSeasConfig | schema.BuoyPhotographsConfig, values: Mapping[str, float]
) -> np.ndarray:
    """A sea of the state found in an image, of twice as many rows and columns as were compared."""
    state = with_values(start(image.camera, config.camera, config.cascade, config.seed), values)
    rows, columns, _ = image.light.shape
    return np.asarray(jax.block_until_ready(drawn(state, (2 * rows, 2 * columns))))


@eqx.filter_jit
def drawn(photograph: Photograph, size: tuple[int, int]) -> jax.Array:
    """A picture of a state, to be looked at."""
    return photograph.picture(size, Raster(1.0))
