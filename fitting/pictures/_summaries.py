"""What the statistics of pictures say of the numbers that are sought, learned from scenes whose numbers are known."""

from dataclasses import fields

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

LENGTH = 1.5
"""Root mean square difference of statistics [deviations of theirs] over which what they tell is alike."""

LINEAR = 0.02
"""What a straight line counts beside what is alike, for each statistic."""

RIDGES = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
"""Of which that is taken that predicts best what it has not seen."""

FARTHEST = 4.0
"""Standard deviations of the scenes' own beyond which a statistic says no more."""


class Summaries(eqx.Module):
    """A regression from statistics to the numbers sought: a few numbers that hold most of what many say.

    $$ f(s) = c + b·z + \\sum_i α_i \\exp\\Big(-\\frac{|z - z_i|^2}{2 m ℓ^2}\\Big), \\quad
       z = 4 \\tanh\\frac{s - \\bar s}{4 σ} $$

    Used as data of a fit, not only as its result: what matters is that they are the same function of the photograph and
    of the pictures of a scene (semi-automatic summaries, Fearnhead & Prangle 2012).

    **Arguments:** `middle` s̄, `scale` σ of the statistics; `known` z_i of scenes; `width` mℓ²; `weights` α, `slopes` b,
    `constant` c.
    """

    middle: Float[Array | np.ndarray, " m"]
    scale: Float[Array | np.ndarray, " m"]
    known: Float[Array | np.ndarray, "scene m"]
    width: Float[Array | np.ndarray, ""]
    weights: Float[Array | np.ndarray, "scene q"]
    slopes: Float[Array | np.ndarray, "m q"]
    constant: Float[Array | np.ndarray, " q"]

    def __call__(self, statistics: Float[Array, "*b m"]) -> Float[Array, "*b q"]:
        dtype = statistics.dtype
        middle, scale, known, width, weights, slopes, constant = (
            getattr(self, each.name).astype(dtype) for each in fields(self)
        )
        own = FARTHEST * jnp.tanh((statistics - middle) / scale / FARTHEST)
        apart = jnp.sum((own[..., None, :] - known) ** 2, axis=-1)
        return constant + own @ slopes + jnp.exp(-0.5 * apart / width) @ weights


class Lesson(eqx.Module):
    """What scouts taught of one camera: for other photographs of it. All its numbers are doubles of NumPy.

    **Arguments:** `summaries`; `told`: the share of each goal's variance that they tell.
    """

    summaries: Summaries
    told: Float[np.ndarray, " q"]

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """All that it consists of by name, such as a file keeps."""
        parts = {each.name: np.asarray(getattr(self.summaries, each.name)) for each in fields(Summaries)}
        return {**parts, "told": self.told}

    @classmethod
    def of(cls, arrays: dict[str, np.ndarray]) -> "Lesson":
        """From its `arrays`."""
        parts = (np.asarray(arrays[each.name]) for each in fields(Summaries))
        return cls(Summaries(*parts), np.asarray(arrays["told"]))


def learn(
    statistics: Float[np.ndarray, "scene m"], goals: Float[np.ndarray, "scene q"], steady: tuple[bool, ...]
) -> Lesson:
    """Kernel ridge regressions, each with the ridge that predicts best what it has not seen.

    Far from a straight line: whitecaps say most of strong winds, waves most of weak ones. Each scene is predicted from
    all others, which the inverse of the kernel tells at once (Rasmussen & Williams 2006, 5.12).

    **Returns:** the summaries, and what they tell of scenes that they have not seen.
    """
    middle, scale = statistics.mean(axis=0), statistics.std(axis=0)
    # Without weight: a statistic that does not vary, or that is not to count.
    scale = np.where(np.asarray(steady) & (scale > 1e-9), scale, np.inf)
    known = FARTHEST * np.tanh((statistics - middle) / scale / FARTHEST)
    width = LENGTH**2 * max(int(np.sum(np.isfinite(scale))), 1)
    products = known @ known.T
    squares = np.diag(products)
    apart = np.maximum(squares[:, None] + squares - 2 * products, 0.0)
    kernel = np.exp(-0.5 * apart / width) + LINEAR * products
    constant = goals.mean(axis=0)
    weights, least = np.zeros(goals.shape), np.full(goals.shape[1], np.inf)
    for ridge in RIDGES:
        inverse = np.linalg.inv(kernel + ridge * np.eye(len(goals)))
        own = inverse @ (goals - constant)
        missed = np.mean((own / np.diag(inverse)[:, None]) ** 2, axis=0)
        weights = np.where(missed < least, own, weights)
        least = np.minimum(missed, least)
    told = np.maximum(1 - least / goals.var(axis=0), 0.0)
    parts = middle, scale, known, np.asarray(width, float), weights, LINEAR * known.T @ weights, constant
    return Lesson(Summaries(*parts), told)
