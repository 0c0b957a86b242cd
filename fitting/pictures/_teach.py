"""What pictures of a camera teach: states from the priors, with one picture each."""

import warnings
from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
import numpy as np

from jaxocean._numerics import check_kind
from jaxocean.render import Raster, Rays

from .._errors import FitError
from .._parameters import Parameter, attach_priors, resolve
from .._priors import AbstractPrior
from . import _sought
from ._image_statistics import ImageStatistics
from ._photograph import Photograph
from ._picture_target import Mask
from ._problem import PictureProblem
from ._statistics_target import StatisticsTarget, Vary
from ._summaries import Lesson, Summaries, learn
from ._synthetic_likelihood import DRAWN, drawn_at, seas_of

MOST_FREE = 12
"""Numbers that are sought at once: the chance of what tells them must be known from few seas."""

METHOD = Rays((4, 2))
"""Draws pictures: of a pixel's long footprint on distant water many parts, each of its own light, and two beside each
other, since of single points along the horizon too much would seem to change from one to the next."""

Free = Callable | Parameter | Sequence[Callable | Parameter]

LEAST_SCOUTS = 20

APART = 100_000
"""Between the seeds of scouts and of what is compared."""


def teach(
    photograph: Photograph,
    free: Free,
    size: tuple[int, int],
    *,
    mask: Mask | None = None,
    priors: Sequence[AbstractPrior] = (),
    vary: Vary | None = None,
    method: Raster | Rays | None = None,
    detail: int = 1,
    scouts: int = 640,
    seed: int = 0,
    scouts_before: Sequence[np.ndarray] = (),
    scouted: Callable[[np.ndarray], None] | None = None,
) -> Lesson:
    """Learn what pictures of a camera say of the free numbers, for any number of its photographs.

    Scouts, states from the priors with one picture each, teach a regression from `ImageStatistics` to the free numbers.

    **Arguments:**

    - `photograph`: the middle of what is expected; its camera is that of the images.
    - `size`: rows and columns of the images; `mask`: 0 where they show something else.
    - `free`, `priors`, `vary`, `method`, `detail`, `seed`: as for `fit_photograph`.
    - `scouts`: how many.
    - `scouts_before`: what `scouted` was given by an interrupted call with the same arguments: these are not drawn
      again.
    - `scouted`: called with the statistics [scout m] of each `DRAWN` scouts.

    **Returns:** `Lesson`. Scouts whose picture is not finite teach nothing; a warning says how many.

    **Raises:** `ValueError` for arguments that make no sense; `FitError` if most pictures are not finite.
    """
    if scouts < LEAST_SCOUTS:
        raise ValueError(f"Argument `scouts` must be at least {LEAST_SCOUTS}, but is {scouts}.")
    with jax.enable_x64(True):
        problem = pose(photograph, free, size, mask, priors, vary, method, detail, 1, seed)
        statistics = problem.target.statistics
        batches = [(min(DRAWN, scouts - part), len(statistics.names)) for part in range(0, scouts, DRAWN)]
        if [np.shape(each) for each in scouts_before] != batches[: len(scouts_before)]:
            raise ValueError(
                f"Argument `scouts_before` must hold the {len(statistics.names)} statistics of {DRAWN} scouts each, as "
                f"`scouted` was given them, and no more than `scouts` = {scouts}."
            )
        random = np.random.default_rng(seed)
        points = np.stack([_sought.from_priors(problem, random) for _ in range(scouts)])
        # Other seas than those that later make means and chances: these must not be what was learned from.
        drawn = drawn_at(problem, points, seed + APART, scouts_before, scouted)
        sound = np.all(np.isfinite(drawn), axis=1)
        if np.mean(sound) < 0.5:
            raise FitError(
                "Most pictures of states from the priors are not finite",
                "numbers that no scene has",
                "give priors or bounds that hold only seas",
            )
        if not np.all(sound):
            warnings.warn(
                f"{np.sum(~sound)} of {scouts} random states teach nothing: their pictures are not finite.",
                stacklevel=2,
            )
        return learn(drawn[sound], _sought.goals(problem, points[sound]), statistics.steady)


def pose(
    photograph: Photograph,
    free: Free,
    size: tuple[int, int],
    mask: Mask | None,
    priors: Sequence[AbstractPrior],
    vary: Vary | None,
    method: Raster | Rays | None,
    detail: int,
    seas: int,
    seed: int,
) -> PictureProblem:
    """The statistics of so many seas as a function of the free numbers, in doubles; nothing is learned yet."""
    check_kind("photograph", photograph, Photograph, "a `Photograph`")
    if detail < 1:
        raise ValueError(f"Argument `detail` must be at least 1, but is {detail}.")
    statistics = ImageStatistics(photograph.scene.camera, size, mask)
    slots = attach_priors(photograph, resolve(photograph, free, 1), list(priors))
    for slot, _ in slots:
        if slot.shape:
            raise ValueError(
                f"Argument `free` must pick single numbers, but `{slot.name}` has shape {slot.shape}."
            )
    if len(slots) > MOST_FREE:
        raise ValueError(
            f"Argument `free` must pick at most {MOST_FREE} numbers, but picks {len(slots)}: one picture tells no more."
        )
    return PictureProblem(
        seas_of(photograph, DRAWN, seed, vary).some(seas),
        StatisticsTarget(statistics, _nothing(statistics), jnp.zeros(1), jnp.eye(1)),
        (),
        tuple(prior for _, prior in slots),
        tuple(slot for slot, _ in slots),
        METHOD if method is None else method,
        detail,
    )


def _nothing(statistics: ImageStatistics) -> Summaries:
    """In the place of what is not yet learned."""
    count = len(statistics.names)
    none = jnp.zeros((count, 1))
    return Summaries(
        jnp.zeros(count), jnp.ones(count), jnp.zeros((1, count)), jnp.ones(()), none[:1], none, none[0]
    )
