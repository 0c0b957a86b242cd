"""What the statistics of pictures say of the numbers that are sought, learned from scenes whose numbers are known."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

FOLDS = 5
"""Parts of the scenes, of which each is predicted from the others to choose the ridge."""

RIDGES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)

FARTHEST = 4.0
"""Standard deviations of the scenes' own beyond which a statistic says no more."""


class Summaries(eqx.Module):
    """A linear regression from statistics to the numbers sought: a few numbers that hold most of what many say.

    Used as data of a fit, not as its result: what matters is that they are the same function of the photograph and of
    the pictures of a scene (semi-automatic summaries, Fearnhead & Prangle 2012).

    **Arguments:** `middle`, `scale` of the statistics; `weights` of 1 and of each.
    """

    middle: Float[Array, " m"]
    scale: Float[Array, " m"]
    weights: Float[Array, "feature q"]

    def __call__(self, statistics: Float[Array, "*b m"]) -> Float[Array, "*b q"]:
        dtype = statistics.dtype
        scaled = (statistics - self.middle.astype(dtype)) / self.scale.astype(dtype)
        return _features(scaled) @ self.weights.astype(dtype)


class Lesson(eqx.Module):
    """What scouts taught of one camera: for other photographs of it.

    **Arguments:** `summaries`; `told`: the share of each goal's variance that they tell.
    """

    summaries: Summaries
    told: Float[np.ndarray, " q"]

    @classmethod
    def of(cls, middle, scale, weights, told) -> "Lesson":
        """From the arrays that it consists of, such as a file keeps."""
        return cls(Summaries(*(jnp.asarray(each) for each in (middle, scale, weights))), np.asarray(told))


def learn(
    statistics: Float[np.ndarray, "scene m"], goals: Float[np.ndarray, "scene q"], steady: tuple[bool, ...]
) -> Lesson:
    """Ridge regressions, each with the largest ridge that predicts what it has not seen as well as the best does.

    As well means within one standard error of it (Hastie, Tibshirani & Friedman 2009, 7.10): a photograph is not drawn
    by the model, and smaller weights mind that less.

    **Returns:** the summaries, and what they tell of scenes that they have not seen.
    """
    used = np.asarray(steady)
    middle, scale = statistics.mean(axis=0), statistics.std(axis=0)
    # Without weight: a statistic that does not vary, or that is not to count.
    scaled = np.where(used & (scale > 1e-9), (statistics - middle) / np.where(scale > 1e-9, scale, 1.0), 0.0)
    features = np.asarray(_features(jnp.asarray(scaled)))
    part = np.arange(len(goals)) % FOLDS
    errors = np.empty((len(RIDGES), goals.shape[1]))
    for number, ridge in enumerate(RIDGES):
        missed = np.empty_like(goals)
        for fold in range(FOLDS):
            own = part == fold
            missed[own] = features[own] @ _ridge(features[~own], goals[~own], ridge) - goals[own]
        errors[number] = np.sqrt(np.mean(missed**2, axis=0))
    least = errors.min(axis=0)
    enough = errors <= least * (1 + 1 / np.sqrt(2 * len(goals)))
    best = len(RIDGES) - 1 - enough[::-1].argmax(axis=0)
    columns = [_ridge(features, goals[:, [q]], RIDGES[best[q]])[:, 0] for q in range(goals.shape[1])]
    scale = np.where(used & (scale > 1e-9), scale, np.inf)
    summaries = Summaries(*(jnp.asarray(each) for each in (middle, scale, np.stack(columns, axis=1))))
    told = 1 - (errors[best, np.arange(goals.shape[1])] / goals.std(axis=0)) ** 2
    return Lesson(summaries, np.maximum(told, 0.0))


def _features(scaled: Float[Array, "*b m"]) -> Float[Array, "*b feature"]:
    near = FARTHEST * jnp.tanh(scaled / FARTHEST)
    return jnp.concatenate([jnp.ones_like(near[..., :1]), near], axis=-1)


def _ridge(features: np.ndarray, goals: np.ndarray, ridge: float) -> np.ndarray:
    penalty = ridge * np.eye(features.shape[1])
    penalty[0, 0] = 0.0
    return np.linalg.solve(features.T @ features + penalty, features.T @ goals)
