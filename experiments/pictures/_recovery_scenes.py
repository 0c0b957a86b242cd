"""Seas to be found again in pictures: drawn at random, and where the way to them begins."""

from statistics import NormalDist

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from fitting.pictures import SceneModel
from jaxocean.render import Camera, Raster, Rays

from .. import schema
from ..common import _build

FOAMIEST = 0.95
"""Largest ε [-] of a start: above it nearly all is foam, and the start is too low instead."""

DRAWS = 1000
"""After so many seas that have too few or too many whitecaps the limits are to blame."""

FINISHES, FINER = (Raster(2.0), Rays()), 2
"""Draw the last pictures of a fit, with so many times the rows and columns, of which the better ones count. One of them
draws as the target was drawn, but for the target's pixels, of which there are more."""

DOUBTS = Raster(1.0), Rays()
"""What is drawn without more rows and columns tells how much these matter."""

FREE = ("wind speed", "wind direction", "choppiness", "threshold", "sun elevation", "exposure")
UNITS = ("m/s", "rad", "-", "-", "rad", "stops")

BOUNDS = ((0.05, True), (np.radians(3.0), False), (0.05, True), (0.03, False), None, (0.1, False))
"""How far a number may be off to count as recovered, and whether as a share of it."""


def free(model: SceneModel):
    """The numbers that are to be found, in the order of `FREE`."""
    sky = model.sky
    assert isinstance(sky, jo.optics.sky.HosekWilkie)
    return (
        model.wind.speed,
        model.wind.direction,
        model.choppiness,
        model.threshold,
        sky.sun_elevation,
        model.exposure,
    )


def draw(config: schema.PictureRecoveryConfig, number: int) -> tuple[SceneModel, SceneModel, float] | None:
    """A sea, the same from where its fit begins, and its coverage; None if the limits leave none."""
    random = np.random.default_rng([config.seed, number])
    limits, cascade = config.truths, _build.cascade(config.cascade)
    for _ in range(DRAWS):
        truth = _scene(config, cascade, random)
        coverage = float(_coverage(truth))
        if limits.least_coverage < coverage < limits.most_coverage:
            return truth, _start(config, truth, random), coverage
    return None


_coverage = eqx.filter_jit(lambda scene: scene.ocean().coverage())


def _scene(config: schema.PictureRecoveryConfig, cascade: jo.surface.Cascade, random) -> SceneModel:
    speed = random.uniform(config.truths.lowest_wind, config.truths.highest_wind)
    heights = 0.5 * speed, 1.6 * speed
    return SceneModel(
        jo.Wind(speed, random.uniform(-np.pi, np.pi)),
        Camera(
            (*random.uniform(-200.0, 200.0, 2), random.uniform(*heights)),
            heading=random.uniform(-np.pi, np.pi),
            pitch=random.uniform(0.15, 0.6),
            field_of_view=0.8,
        ),
        cascade=cascade,
        noise=jo.surface.draw_noise(cascade, key=jax.random.key(int(random.integers(2**31)))),
        choppiness=random.uniform(0.8, 1.2),
        threshold=random.uniform(0.5, 0.8),
        breaking_wavenumber=config.breaking_wavenumber,
        sky=jo.optics.sky.HosekWilkie(
            2.5, sun_elevation=random.uniform(0.4, 1.05), sun_azimuth=random.uniform(-np.pi, np.pi)
        ),
        exposure=random.uniform(-1.0, 1.0),
    )


def _start(config: schema.PictureRecoveryConfig, truth: SceneModel, random) -> SceneModel:
    def off() -> float:
        return random.choice([-1, 1]) * random.uniform(
            config.truths.nearest_start, config.truths.furthest_start
        )

    speed, direction, choppiness, threshold, sun, exposure = (float(each) for each in free(truth))

    def off_threshold() -> float:
        share = off()
        return threshold * (1 + (share if threshold * (1 + share) <= FOAMIEST else -share))

    found = (
        speed * (1 + off()),
        direction + off(),  # as a share of a radian
        choppiness * (1 + off()),
        off_threshold(),
        sun * (1 + off()),
        exposure + 2 * off(),  # stops; 0.4 of them are 30 % of the light
    )
    return with_numbers(truth, found)


def with_numbers(scene: SceneModel, values) -> SceneModel:
    """The scene with other numbers in the order of `FREE`."""
    return eqx.tree_at(free, scene, tuple(jnp.asarray(float(each), jnp.float32) for each in values))


def method(config: schema.PictureRecoveryConfig, number: int) -> Raster | Rays:
    """What draws the picture of a sea: of the mesh as many vertices as pixels in the fit's picture."""
    rays = config.targets == "rays" or (config.targets == "alternate" and number % 2 == 0)
    return Rays() if rays else Raster(float(config.detail))


@eqx.filter_jit
def target(scene: SceneModel, size: tuple[int, int], detail: int, method: Raster | Rays) -> jax.Array:
    """Its picture, drawn with `detail`² times as many pixels and averaged."""
    return scene.picture(size, method, detail)


def half_width(level: float) -> float:
    """Of an interval with that probability, in standard errors."""
    return NormalDist().inv_cdf(0.5 + 0.5 * level)


def recovered(truth: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Whether each number lies within its bound; where it has none, True."""
    inside = []
    for bound, true, value in zip(BOUNDS, truth, found, strict=True):
        if bound is None:
            inside.append(True)
            continue
        most, relative = bound
        inside.append(abs(value - true) <= most * (abs(true) if relative else 1.0))
    return np.asarray(inside)
