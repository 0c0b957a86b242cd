"""`joint_targets`: how a coverage law, slopes and a picture together tell ε from λ."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import fitting
import jaxocean as jo
from fitting.pictures import PictureTarget, SceneModel, fit_picture
from jaxocean._numerics import with_dtype
from jaxocean.render import Rays

from .. import schema
from ..common import _build
from ..harness import _records
from ..harness._errors import Interrupted
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _joint_report, _joint_views, _scene
from ._recovery_scenes import DOUBTS, FINER, FINISHES, target

ROUNDS = 6
"""Of the steps with derivatives by differences, at most."""

STEPS = 120
"""At most, on coarse squares and on all: along a valley they are short."""

HELD = 1e-5
"""Deviation of a prior that holds λ where it is: the same program as with one that does not."""

REACH = 4.0
"""How far profiles go to either side [standard errors]; with a picture errors count what renderers differ in."""

WIDEST = (0.2, 2.5)
"""Between which λ the profiles without a picture go."""


@dataclass(frozen=True)
class Objective:
    """What some targets say of (ε, λ).

    **Arguments:** `name`; `values`, `covariance` of both; `profile` of λ, where there is one; `doubted`: the part of
    the covariance that is from other renderers in doubt.
    """

    name: str
    values: np.ndarray
    covariance: np.ndarray
    profile: fitting.Profile | None = None
    doubted: np.ndarray | None = None

    @property
    def told(self) -> np.ndarray:
        """The covariance by what targets tell, if the renderer is right."""
        return self.covariance if self.doubted is None else self.covariance - self.doubted

    @property
    def correlation(self) -> float:
        """Of the errors of ε and λ, if the renderer is right."""
        return _correlation(self.told)

    @property
    def correlation_in_doubt(self) -> float:
        """The same with what renderers differ in."""
        return _correlation(self.covariance)


def _correlation(covariance: np.ndarray) -> float:
    return float(covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1]))


@dataclass(frozen=True)
class Found:
    """What is needed of a fit with a picture, as a line of a file can keep it: see `PictureFit`."""

    values: dict[str, float]
    errors: dict[str, float]
    covariance: list[list[float]]
    doubted: list[list[float]]
    scatter: float
    cost: float


def run(config: schema.JointTargetsConfig, progress: Reporter, store: Files) -> Result:
    """Fit all objectives; see `schema.JointTargetsConfig`."""
    try:
        return _run(config, progress, store)
    except KeyboardInterrupt:
        raise Interrupted(
            "Interrupted: each finished fit with a picture is kept, and the same command goes on with the others."
        ) from None


def _run(config: schema.JointTargetsConfig, progress: Reporter, store: Files) -> Result:
    progress.step("Drawing the target")
    truth = _truth(config)
    image = target(truth, (config.height, config.width), config.detail, Rays())
    law, slopes = _targets(config, truth)
    start = _away(config, truth)
    advance = progress.count("Fits; the first with a picture compiles, for minutes", 4 + config.points)
    objectives = []
    for name, targets in (("coverage law", [law]), ("law and slopes", [law, slopes])):
        objectives.append(_without_picture(config, start, name, targets))
        advance()
    # A process may hold only so many compiled programs, and those of pictures are large.
    jax.clear_caches()
    kept = store.unfinished() / "fits.jsonl"
    alone = _fit(kept, "picture", start, PictureTarget(image), _muted(law) + _muted(slopes), _prior(config))
    advance()
    weighed = PictureTarget(image, scatter=alone.scatter)
    objectives.append(_with_picture(config, kept, start, weighed, law + slopes, advance))
    progress.step("Drawing the figure")
    picture = _objective("picture", alone)
    _joint_views.plot(store, config, objectives, picture)
    _joint_views.save(store, objectives, picture)
    result = _joint_report.result(config, objectives, picture, alone.scatter)
    store.text("report.md", _joint_report.report(config, objectives, picture, result))
    return result


def _truth(config: schema.JointTargetsConfig) -> SceneModel:
    cascade = _build.cascade(config.cascade)
    return SceneModel(
        _build.wind(config.wind),
        _scene.camera(config.camera),
        cascade=cascade,
        noise=jo.surface.draw_noise(cascade, key=jax.random.key(config.seed)),
        choppiness=config.choppiness,
        threshold=config.threshold,
        breaking_wavenumber=config.breaking_wavenumber,
        spectrum=fitting.ElfouhailySea(config.inverse_wave_age),
        sky=jo.optics.sky.HosekWilkie(2.5, sun_elevation=0.7, sun_azimuth=2.0),
    )


def _targets(
    config: schema.JointTargetsConfig, truth: SceneModel
) -> tuple[fitting.CoveragePoints, fitting.SlopeVariance]:
    """What a law and slopes say that the truth obeys."""
    with jax.enable_x64(True):
        speeds = np.asarray(config.winds.speed)
        sea = with_dtype(truth, jnp.dtype(jnp.float64)).statistics()
        coverage = eqx.filter_vmap(lambda u: sea.coverage(jo.Wind(u)))(jnp.asarray(speeds))
        law = fitting.CoveragePoints(speeds, np.asarray(coverage), config.law_scatter, "coverage law")
        return law, fitting.SlopeVariance(
            speeds, sea.slope_variance, scatter=config.slope_scatter, label="slopes"
        )


def _muted(target: fitting.CoveragePoints | fitting.SlopeVariance):
    """The same with so wide a scatter that it says nothing: the program is that of a fit in which it does."""
    # A double, as it was: in another type it would be another program.
    with jax.enable_x64(True):
        return eqx.tree_at(lambda t: t.scatter.value, target, 1e6 * target.scatter.value)


NAMES = "threshold", "choppiness", "inverse_wave_age"


def _free(model):
    return model.threshold, model.choppiness, model.spectrum.inverse_wave_age


def _away(config: schema.JointTargetsConfig, truth: SceneModel) -> SceneModel:
    """Where fits begin: a choppier sea with a lower threshold has nearly the same coverage."""
    factors = 1 - config.away, 1 + config.away, 1 + config.away
    values = (factor * value for factor, value in zip(factors, _free(truth), strict=True))
    return eqx.tree_at(_free, truth, tuple(values))


def _prior(config: schema.JointTargetsConfig, mean: float | None = None) -> fitting.Normal:
    """The wide one, or one that holds λ."""
    wide = config.choppiness, config.prior_deviation
    return fitting.Normal(*(wide if mean is None else (mean, HELD)), where=lambda m: m.choppiness)


def _without_picture(
    config: schema.JointTargetsConfig, start: SceneModel, name: str, targets: Sequence
) -> Objective:
    with jax.enable_x64(True):
        model, priors = with_dtype(start, jnp.dtype(jnp.float64)).statistics(), [_prior(config)]
        found = fitting.fit(model, _free, targets, priors=priors)
        spread = float(np.sqrt(found.covariance[1, 1]))
        middle = float(found.model.choppiness)
        low, high = (float(np.clip(middle + side * REACH * spread, *WIDEST)) for side in (-1, 1))
        profile = fitting.profile(
            model, _free, targets, parameter="choppiness", grid=np.linspace(low, high, 24), priors=priors
        )
        values = np.asarray([float(found.model.threshold), middle])
    return Objective(name, values, found.covariance[:2, :2], profile)


def _fit(
    kept: Path,
    name: str,
    start: SceneModel,
    image: PictureTarget,
    beside: fitting.TargetSum,
    prior: fitting.Normal,
) -> Found:
    """The fit of that name, from the file if an interrupted run has kept it there."""
    for record in _records.read(kept):
        if record["name"] == name:
            return Found(**record["found"])
    fit = fit_picture(
        start,
        _free,
        image,
        beside=beside,
        priors=[prior],
        # ε, λ and the age of the sea together leave a valley: along it a mesh leads away, and a long way back.
        method=Rays(),
        finish=FINISHES,
        detail=FINER,
        refine=ROUNDS,
        doubts=DOUBTS,
        most_steps=STEPS,
    )
    values, errors = ({key: float(value) for key, value in each.items()} for each in (fit.values, fit.errors))
    found = Found(
        values, errors, fit.covariance.tolist(), fit.doubted.tolist(), float(fit.scatter), float(fit.cost)
    )
    _records.append(kept, {"name": name, "found": asdict(found)})
    return found


def _with_picture(
    config: schema.JointTargetsConfig,
    kept: Path,
    start: SceneModel,
    image: PictureTarget,
    beside: fitting.TargetSum,
    advance: Callable[[], None],
) -> Objective:
    """All three at once, and again with λ held at values around what was found; the lowest of these fits counts."""
    best = _fit(kept, "all", start, image, beside, _prior(config))
    advance()
    # Closer by, the cost is as rough as pictures are where crests move across pixels.
    reach = REACH * best.errors["choppiness"]
    grid = best.values["choppiness"] + reach * np.linspace(-1, 1, config.points)
    costs, values = [], []
    for value in grid:
        begin = {**best.values, "choppiness": value}
        found = eqx.tree_at(_free, start, tuple(jnp.asarray(begin[name], jnp.float32) for name in NAMES))
        held = _fit(kept, f"held at {value}", found, image, beside, _prior(config, float(value)))
        # What the wide prior would say there.
        off = (value - config.choppiness) / config.prior_deviation
        costs.append(2 * held.cost + off**2)
        values.append([held.values[name] for name in NAMES])
        advance()
    lowest = int(np.argmin(costs))
    excess = np.asarray(costs) - min(2 * best.cost, costs[lowest])
    profile = fitting.Profile(
        "choppiness",
        "-",
        NAMES,
        grid,
        excess,
        np.asarray(values),
        best=float(grid[lowest]),
        fit=None,
        warnings=(),
    )
    if costs[lowest] < 2 * best.cost:
        # The free fit comes to rest where it gains little, which can still be much for a profile.
        best = replace(best, values=dict(zip(NAMES, values[lowest], strict=True)))
    return _objective("law, slopes and picture", best, profile)


def _objective(name: str, found: Found, profile: fitting.Profile | None = None) -> Objective:
    values = np.asarray([found.values[name] for name in NAMES[:2]])
    covariance, doubted = (np.asarray(each)[:2, :2] for each in (found.covariance, found.doubted))
    return Objective(name, values, covariance, profile, doubted)
