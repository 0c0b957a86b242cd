"""Seas of another spectrum family, drawn by the other renderer: pictures whose wind is to be found."""

import math
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from fitting.pictures import Photograph, SceneModel
from jaxocean._constants import GRAVITY
from jaxocean._numerics import as_leaf
from jaxocean._types import Scalar
from jaxocean.optics.sky import CloudySky, HosekWilkie
from jaxocean.render import Camera, Raster, Rays
from jaxocean.spectra import JONSWAP

from .. import schema
from ..common import _build
from ._photographs import BREAKING, DEVELOPED
from ._taken import Taken, made_ready

PATTERNS = schema.CascadeConfig(sizes=(1117.0, 127.0, 14.3), resolution=256)
"""Other patterns than those of the fit, and finer ones."""

PHILLIPS = 0.0081
"""α of a fully developed sea."""

LARGER = 4
"""Times as many rows and columns as are compared have the pictures in which the horizon is sought, as photographs have;
in those of single rows it is found 0.3° off, and winds come out wrong by two thirds as much again."""

METHODS: dict[str, Raster | Rays] = {"raster": Raster(0.5), "rays": Rays()}
"""What draws the pictures."""


class JonswapSea(eqx.Module):
    """Makes a JONSWAP spectrum whose peak is at the inverse wave age Ω.

    $$ k_p = g Ω²/U_{10}^2, \\quad α = 0.0081\\, Ω/0.84, \\quad γ = 1 + 2.3\\, \\min((Ω - 0.84)/0.6, 1) $$

    so that it goes over into Pierson & Moskowitz's for a developed sea.
    """

    inverse_wave_age: Scalar = eqx.field(converter=as_leaf)

    def __call__(self, wind: jo.Wind) -> JONSWAP:
        """The spectrum."""
        age = self.inverse_wave_age.astype(wind.speed.dtype)
        # Deep water: ω = g Ω/U.
        period = 2 * math.pi * wind.speed / (GRAVITY * age)
        younger = jnp.clip((age - DEVELOPED) / 0.6, 0.0, 1.0)
        return JONSWAP.from_alpha(
            alpha=PHILLIPS * age / DEVELOPED,
            peak_period=period,
            peak_enhancement=1 + 2.3 * younger,
            direction=wind.direction,
        )


def draw(config: schema.UnknownSeasConfig, number: int) -> Photograph:
    """A sea and its light."""
    random = np.random.default_rng([config.seed, number])
    cascade = _build.cascade(PATTERNS)
    speed = random.uniform(config.lowest_wind, config.highest_wind)
    sky = HosekWilkie(
        random.uniform(2.0, 6.0),
        sun_elevation=random.uniform(0.15, 1.3),
        sun_azimuth=random.uniform(-np.pi, np.pi),
    )
    scene = SceneModel(
        jo.Wind(speed, random.uniform(-np.pi, np.pi)),
        camera(config),
        cascade=cascade,
        noise=jo.surface.draw_noise(cascade, key=jax.random.key(int(random.integers(2**31)))),
        choppiness=random.uniform(0.8, 1.2),
        breaking_wavenumber=BREAKING,
        spectrum=JonswapSea(float(np.clip(np.exp(random.normal(0.0, 0.2)), DEVELOPED, 2.0))),
        # Half of the skies are clear.
        sky=CloudySky(sky, float(random.choice([0.0, random.uniform(0.0, 1.0)]))),
        water=jo.optics.Water(float(0.15 * np.exp(random.normal(0.0, 0.8)))),
        afloat=config.camera.afloat,
    )
    return Photograph(scene, excess=float(random.normal(0.0, 0.2)))


def camera(config: schema.UnknownSeasConfig) -> Camera:
    """That takes all pictures."""
    rows, pitch, roll = config.inference.rows, config.camera.pitch, config.camera.roll
    assert pitch is not None
    assert roll is not None
    view = config.camera.vertical(rows, columns(rows))
    return Camera((0.0, 0.0, config.camera.height), pitch=pitch, roll=roll, field_of_view=view)


def taken(config: schema.UnknownSeasConfig, state: Photograph) -> Taken:
    """Its picture, made ready as a photograph is: larger than what is compared, with its tilt from the horizon.

    **Raises:** `UserError` if none is seen.
    """
    rows = config.inference.rows
    larger = math.gcd(config.detail, LARGER)
    size = larger * rows, larger * columns(rows)
    light = np.asarray(picture(state, size, config.targets, config.detail // larger))
    unknown = config.camera.model_copy(update={"pitch": None, "roll": None})
    return made_ready(light, None, unknown, rows, "the picture that is made here", "camera")


def columns(rows: int) -> int:
    """Of a picture of 16 by 9."""
    return 2 * round(8 * rows / 9)


@eqx.filter_jit
def picture(
    state: Photograph, size: tuple[int, int], targets: Literal["raster", "rays"], detail: int
) -> jax.Array:
    """Its picture."""
    return state.picture(size, METHODS[targets], detail)
