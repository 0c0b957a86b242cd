"""Seas to be found again in pictures: drawn at random, and where the way to them begins."""

from collections.abc import Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Number:
    """One of the numbers that are to be found.

    **Arguments:** `name`, and `short`; `unit`; `bound`: how far it may be off to count as recovered, and whether as a
    share of it; None if nothing is asked of it.
    """

    name: str
    short: str
    unit: str
    bound: tuple[float, bool] | None


def numbers(config: schema.PictureRecoveryConfig) -> tuple[Number, ...]:
    """All of them, in the order of `free`."""

    def choppiness(of: str = "") -> Number:
        return Number("choppiness" + of, "λ" + of, "-", (0.05, True))

    sizes = config.cascade.sizes if config.truths.own_choppiness else ()
    return (
        Number("wind speed", "U10", "m/s", (0.05, True)),
        Number("wind direction", "azimuth", "rad", (np.radians(3.0), False)),
        *([choppiness(f" of {size:g} m") for size in sizes] or [choppiness()]),
        Number("threshold", "ε", "-", (0.03, False)),
        Number("sun elevation", "sun", "rad", None),
        Number("exposure", "light", "stops", (0.1, False)),
    )


def free(model: SceneModel):
    """The leaves that hold the numbers that are to be found."""
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
    patterns = cascade.count if config.truths.own_choppiness else None
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
        choppiness=random.uniform(0.8, 1.2, patterns),
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

    speed, direction, *choppiness, threshold, sun, exposure = values(truth)

    def off_threshold() -> float:
        share = off()
        return threshold * (1 + (share if threshold * (1 + share) <= FOAMIEST else -share))

    found = (
        speed * (1 + off()),
        direction + off(),  # as a share of a radian
        *(each * (1 + off()) for each in choppiness),
        off_threshold(),
        sun * (1 + off()),
        exposure + 2 * off(),  # stops; 0.4 of them are 30 % of the light
    )
    return with_numbers(truth, found)


def values(model: SceneModel) -> list[float]:
    """The numbers themselves, in the order of `numbers`."""
    return [float(each) for leaf in free(model) for each in np.ravel(leaf)]


def with_numbers(scene: SceneModel, values) -> SceneModel:
    """The scene with other numbers, in the order of `numbers`."""
    leaves = free(scene)
    ends = np.cumsum([leaf.size for leaf in leaves])[:-1]
    parts = (
        jnp.asarray(part.reshape(leaf.shape), jnp.float32)
        for part, leaf in zip(np.split(np.asarray(values, float), ends), leaves, strict=True)
    )
    return eqx.tree_at(free, scene, tuple(parts))


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


def recovered(sought: Sequence[Number], truth: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Whether each number lies within its bound; where it has none, True."""
    inside = []
    for number, true, value in zip(sought, truth, found, strict=True):
        if number.bound is None:
            inside.append(True)
            continue
        most, relative = number.bound
        inside.append(abs(value - true) <= most * (abs(true) if relative else 1.0))
    return np.asarray(inside)
