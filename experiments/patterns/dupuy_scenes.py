"""`dupuy_scenes`: the seas of Dupuy & Bruneton's own scenes, their coverage by every formula, and counted."""

import math
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

import jaxocean as jo
from jaxocean.whitecaps import (
    ExactClosure,
    GaussianClosure,
    ProgramTwoChannelClosure,
    PublishedClosure,
    PublishedSea,
    StrainStatistics,
    jacobian,
    realised_coverage,
)

from .. import schema
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from ..schema import SCENES, Scene
from . import _dupuy_report, _dupuy_views
from ._dupuy_views import CURVE, LEVELS, Closed, Field, Painted

PIXELS = 400
GROUP = 8


def run(config: schema.DupuyScenesConfig, progress: Reporter, store: Files) -> Result:
    """Coverage of the published scenes; see `schema.DupuyScenesConfig`."""
    fields: list[Field] = []
    painted: list[Painted] = []
    for number in config.scenes:
        scene = SCENES[number]
        with jax.enable_x64(True):
            progress.step(f"Scene {number}: statistics")
            stats = _statistics(scene, config)
            closed = {name: _close(each, scene.threshold) for name, each in stats.items()}
        counted = _count(number, scene, config, progress)
        fields += [Field(number, scene, name, closed[name], *counted[name]) for name in closed]
        painted.append(_paint(scene, config))
    progress.step("Drawing")
    definitions = _definitions(config) if 1 in config.scenes and config.resolution == 256 else {}
    _dupuy_views.plot(store, fields, painted, config)
    _dupuy_views.save(store, fields, config)
    result = _dupuy_report.result(fields, definitions, config)
    store.text("report.md", _dupuy_report.report(result, fields, definitions, config))
    return result


def _spectrum(scene: Scene, peak_enhancement: str) -> jo.spectra.AbstractSpectrum:
    omega = scene.inverse_wave_age
    gamma = 1.7 + 6 * math.log(omega) if peak_enhancement == "program" and omega > 1 else None
    elfouhaily = jo.spectra.Elfouhaily(jo.Wind(scene.wind), omega, peak_enhancement=gamma)
    return scene.amplitude * elfouhaily


def _published(scene: Scene, config: schema.DupuyScenesConfig) -> PublishedSea:
    spectrum = _spectrum(scene, config.peak_enhancement)
    return PublishedSea(spectrum, scene.sizes, scene.choppiness, config.resolution)


def _cascade(scene: Scene, config: schema.DupuyScenesConfig) -> jo.surface.Cascade:
    return jo.surface.Cascade(scene.sizes, config.resolution)


def _statistics(scene: Scene, config: schema.DupuyScenesConfig) -> dict[str, StrainStatistics]:
    sea = _published(scene, config)
    ours = jo.whitecaps.strain_statistics(
        _spectrum(scene, "published"), scene.choppiness, cascade=_cascade(scene, config)
    )
    return {"foam": sea.statistics(even=True), "jacobian": sea.statistics(), "spectrum": ours}


def _close(stats: StrainStatistics, threshold: float) -> Closed:
    """What every formula says, at the scene's threshold and along the curve."""
    return jax.tree.map(np.asarray, _close_all(stats, jnp.asarray([threshold, *CURVE])))


@eqx.filter_jit
def _close_all(stats: StrainStatistics, levels: Float[Array, " level"]) -> Closed:
    printed, program = PublishedClosure(), ProgramTwoChannelClosure()
    means = _channels(stats)
    closures = {"exact": ExactClosure, "gaussian": GaussianClosure}
    return Closed(
        printed_variance=printed.moments(stats)[1],
        program_variance=program.variance(means),
        variance=stats.jacobian_variance(),
        skewness=stats.jacobian_skewness(),
        coverage={
            "printed": printed(stats, levels[0]),
            "program": jax.vmap(lambda e: program(means, e))(levels),
            "gaussian": jax.vmap(lambda e: GaussianClosure("rest")(stats, e))(levels),
            "exact": jax.vmap(lambda e: ExactClosure("rest")(stats, e))(levels),
        },
        projected={name: closure("projected")(stats, levels[0]) for name, closure in closures.items()},
    )


def _channels(stats: StrainStatistics) -> Float[Array, "pattern 2"]:
    """E[k_i] and E[k_i²] over the whole plane."""
    patterns = stats.patterns
    assert patterns is not None
    mean = patterns.jacobian_mean() - (1 - 1 / patterns.mean.shape[0])
    return jnp.stack([mean, patterns.jacobian_variance() + mean**2], axis=-1)


def _count(
    number: int, scene: Scene, config: schema.DupuyScenesConfig, progress: Reporter
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Coverage [sea, threshold] and projected coverage [sea] of every field."""
    count = math.ceil(config.realisations / GROUP)
    advance = progress.count(f"Scene {number}: counting on {count * GROUP} seas", 2 * count)
    sea, spectrum = _published(scene, config), _spectrum(scene, "published")
    levels = jnp.asarray([scene.threshold, *LEVELS])
    keys = jax.random.split(jax.random.fold_in(jax.random.key(config.seed), number), (2, count, GROUP))
    found: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {"foam": [], "jacobian": [], "spectrum": []}
    for group in keys[0]:
        for name, coverage in _count_published(sea, group, levels, config.shifts).items():
            found[name].append(coverage)
        advance()
    for group in keys[1]:
        counted = _count_ours(
            spectrum, jnp.asarray(scene.choppiness), _cascade(scene, config), group, levels, config.shifts
        )
        found["spectrum"].append(counted)
        advance()
    return {
        name: (
            np.concatenate([np.asarray(rest, np.float64) for rest, _ in groups]),
            np.concatenate([np.asarray(projected, np.float64) for _, projected in groups]),
        )
        for name, groups in found.items()
    }


@eqx.filter_jit
def _count_published(sea: PublishedSea, keys: PRNGKeyArray, levels, shifts: int):
    def one(key):
        foam, whole = (_coverage(sea.strain(key, even=even), levels, shifts) for even in (True, False))
        return {"foam": foam, "jacobian": whole}

    return jax.lax.map(one, keys)


@eqx.filter_jit
def _count_ours(spectrum, choppiness, cascade, keys: PRNGKeyArray, levels, shifts: int):
    def one(key):
        sea = jo.surface.realise(spectrum, cascade, key=key)
        return _coverage(sea.strains(0.0, choppiness), levels, shifts)

    return jax.lax.map(one, keys)


def _coverage(strain, levels, shifts: int):
    """Coverage of the plane at rest at every level, and projected coverage at the first."""
    rest = jax.vmap(lambda level: realised_coverage(strain, level, measure="rest", shifts=shifts))(levels)
    return rest, realised_coverage(strain, levels[0], measure="projected", shifts=shifts)


def _paint(scene: Scene, config: schema.DupuyScenesConfig) -> Painted:
    """Where one sea breaks, by the true Jacobian and in the foam field of the program."""
    sea = _published(scene, config)
    key = jax.random.fold_in(jax.random.key(config.seed), 1000)
    along = (np.arange(PIXELS) + 0.5) * config.crop / PIXELS
    breaks = []
    for even in (False, True):
        strain = np.asarray(sea.strain(key, even=even))
        total = sum(_between(pattern, along, size) for pattern, size in zip(strain, scene.sizes, strict=True))
        breaks.append(np.asarray(jacobian(jnp.asarray(total))) < scene.threshold)
    return Painted(*breaks)


def _between(pattern: np.ndarray, along: np.ndarray, size: float) -> np.ndarray:
    """Between the samples by their own waves: anything smoother would break less than the sea does.

    It starts at a place where the even part is nothing special.
    """
    n = len(pattern)
    waves = np.fft.fft2(pattern, axes=(0, 1), norm="forward")
    turns = np.exp(2j * np.pi * np.outer(along / size + 0.27, np.fft.fftfreq(n, 1 / n)))
    return np.einsum("yk,klf,xl->yxf", turns, waves, turns, optimize=True).real


class Definition(NamedTuple):
    """The known figures of scene 1 as one reading of its sea gives them."""

    printed_variance: float
    gaussian_foam: float
    exact_foam: float
    gaussian: float
    exact: float


def _definitions(config: schema.DupuyScenesConfig) -> dict[str, Definition]:
    """Scene 1 with the four readings of its sea: whose γ, and squares or annuli of wave numbers."""
    scene = SCENES[1]
    found = {}
    with jax.enable_x64(True):
        for gamma in ("program", "published"):
            spectrum = _spectrum(scene, gamma)
            squares = PublishedSea(spectrum, scene.sizes, scene.choppiness, config.resolution)
            kinds = {"squares": [squares.statistics(even=even) for even in (True, False)]}
            kinds["annuli"] = [
                jo.whitecaps.strain_statistics(
                    factor * spectrum, scene.choppiness, cascade=_cascade(scene, config)
                )
                for factor in (1.0, 2.0)
            ]
            for bands, (even, whole) in kinds.items():
                foam, true = _close(even, scene.threshold), _close(whole, scene.threshold)
                found[f"{'ln' if gamma == 'program' else 'log10'} Ω, {bands}"] = Definition(
                    float(foam.printed_variance),
                    *(
                        float(each.coverage[name][0])
                        for each in (foam, true)
                        for name in ("program", "exact")
                    ),
                )
    return found
