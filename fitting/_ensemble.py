"""One sea calibrated to many whitecap laws: how much the answer depends on whom one believes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, PRNGKeyArray, PyTree, UInt32

from jaxocean import Wind
from jaxocean.whitecaps.laws import AbstractLaw

from ._coverage import SCATTER, CoveragePoints
from ._density import prepare, shrink, stretch
from ._fit import Free, fit
from ._posterior_result import check_level
from ._priors import AbstractPrior
from ._problem import Problem, make_problem
from ._result import Fit
from ._solve import lift
from ._solvers import AbstractSolver
from ._target import Winds, as_winds

UNSEEN = 1e9
"""Scatter of a datum that is not to count. Leaving it out would make every law a program of its own."""

LEAST = 1e-5
"""Coverage below which a law is not a target: photographs hardly see so little, and cubic laws go to zero there."""


@dataclass(frozen=True)
class Calibrated:
    """A sea that obeys one law.

    - `seen`: (wind,) which winds counted: those in the law's range where it gives whitecaps.
    - `law_coverage`: (wind,) what the law says there, NaN elsewhere; `coverage`: what the fitted sea says everywhere.
    """

    law: AbstractLaw
    fit: Fit
    seen: Bool[np.ndarray, " wind"]
    law_coverage: Float[np.ndarray, " wind"]
    coverage: Float[np.ndarray, " wind"]

    @property
    def rms(self) -> float:
        """Root mean square of log10 W(sea) − log10 W(law) over the winds that counted."""
        rest = np.log10(self.coverage[self.seen]) - np.log10(self.law_coverage[self.seen])
        return float(np.sqrt(np.mean(rest**2)))


@dataclass(frozen=True)
class Band:
    """Coverage of all members together at each wind.

    - `lower`, `median`, `upper`: of the members' draws, all with equal weight, at a `level`.
    - `lowest`, `highest`: of the members' own coverage.
    - `between`, `within`: standard deviations of log10 W from law to law, and from a fit's own errors.
    """

    level: float
    lower: Float[np.ndarray, " wind"]
    median: Float[np.ndarray, " wind"]
    upper: Float[np.ndarray, " wind"]
    lowest: Float[np.ndarray, " wind"]
    highest: Float[np.ndarray, " wind"]
    between: Float[np.ndarray, " wind"]
    within: Float[np.ndarray, " wind"]


@dataclass(frozen=True)
class Ensemble:
    """The same sea calibrated to one law after the other.

    - `members`: in the order of the laws; `skipped`: laws with fewer than two usable winds, in words.
    - `problem`, `states`: how any free numbers answer at the ensemble's winds.
    """

    winds: Wind
    members: tuple[Calibrated, ...]
    skipped: tuple[str, ...]
    problem: Problem
    states: Any

    @property
    def speeds(self) -> Float[np.ndarray, " wind"]:
        """Wind speeds [m/s]."""
        return np.asarray(self.winds.speed, float)

    def values(self, name: str) -> Float[np.ndarray, " member"]:
        """A fitted number of each member."""
        return np.asarray([member.fit.values[name] for member in self.members])

    def errors(self, name: str) -> Float[np.ndarray, " member"]:
        """Its standard errors."""
        return np.asarray([member.fit.errors[name] for member in self.members])

    def only(self, keep: Sequence[bool] | Bool[np.ndarray, " member"]) -> "Ensemble":
        """Those members that are to be kept.

        **Raises:** `ValueError` if none is.
        """
        members = tuple(member for member, wanted in zip(self.members, keep, strict=True) if wanted)
        if not members:
            raise ValueError("Argument `keep` must keep at least one member, but keeps none.")
        return replace(self, members=members)

    def band(self, count: int, key: PRNGKeyArray | UInt32[Array, "2"], level: float = 0.9) -> Band:
        """What the members say together, each with its own error, all with equal weight.

        **Arguments:** `count` of draws for each member; `key`; `level` of the band.

        **Raises:** `ValueError` for a level outside (0, 1).
        """
        check_level(level)
        drawn = self.draw(count, key)
        best = np.stack([member.coverage for member in self.members])
        shares = [0.5 * (1 - level), 0.5, 0.5 * (1 + level)]
        lower, median, upper = np.quantile(drawn.reshape(-1, drawn.shape[-1]), shares, axis=0)
        logs = np.log10(np.maximum(drawn, np.finfo(float).tiny))
        between = np.std(np.log10(best), axis=0, ddof=1) if len(best) > 1 else np.zeros(best.shape[1])
        within = np.sqrt(np.mean(np.var(logs, axis=1), axis=0))
        return Band(level, lower, median, upper, best.min(axis=0), best.max(axis=0), between, within)

    def draw(
        self, count: int, key: PRNGKeyArray | UInt32[Array, "2"]
    ) -> Float[np.ndarray, "member draw wind"]:
        """Coverage of each member with its free numbers drawn from the fit's Gaussian approximation.

        Bounded numbers are Gaussian on the line of `AbstractBounds.stretch`: positive ones log-normal.

        **Arguments:** `count` of draws for each member; `key`.
        """
        with jax.enable_x64(True):
            means = np.stack([_flat(member.fit) for member in self.members])
            covariances = np.stack([member.fit.covariance for member in self.members])
            noise = jax.random.normal(key, (len(means), count, means.shape[1]), jnp.float64)
            return np.asarray(_scatter(self.problem, self.states, means, covariances, noise))


def ensemble(
    model: PyTree,
    free: Free,
    laws: Sequence[AbstractLaw],
    winds: Winds,
    *,
    scatter: float | Float[Array, ""] = SCATTER,
    least: float = LEAST,
    priors: Sequence[AbstractPrior] = (),
    solver: AbstractSolver | None = None,
) -> Ensemble:
    """Calibrate one sea to each of several laws, over the winds in that law's range.

    All fits share one compiled program: a wind outside a law's range stays among the data with a scatter so large
    that it does not count.

    **Arguments:** `model`, `free`, `priors`, `solver`: as for `fit`;

    - `laws`: of `jaxocean.whitecaps.laws`, such as its `ALL`.
    - `winds`: speeds [m/s], or winds; of each law those count that lie in its range and where it gives at
      least `least` of coverage.
    - `scatter`: σ of log10 W around a law.

    **Returns:** `Ensemble`.

    **Raises:** `ValueError` without a law, or if none has two usable winds; what `fit` raises.
    """
    if not laws:
        raise ValueError("Argument `laws` must hold at least one law, but is empty.")
    batched = as_winds(winds)
    found, skipped = [], []
    for law in laws:
        law_coverage = np.asarray(jax.vmap(law.coverage)(batched), float)
        seen = np.asarray(jax.vmap(law.in_range)(batched)) & (law_coverage > least) & (law_coverage <= 1)
        if np.sum(seen) < 2:
            skipped.append(f"{law.name} has fewer than two of these winds in its range: it is left out.")
            continue
        target = CoveragePoints(
            batched, np.where(seen, law_coverage, 0.01), np.where(seen, float(scatter), UNSEEN), law.name
        )
        result = fit(model, free, target, priors=priors, solver=solver)
        found.append((law, result, seen, np.where(seen, law_coverage, np.nan)))
    if not found:
        raise ValueError("Argument `winds` must hold two winds in the range of some law, but does not.")
    with jax.enable_x64(True):
        everywhere = CoveragePoints(lift(batched), jnp.full(batched.speed.shape, 0.01, jnp.float64))
        problem, _ = make_problem(model, free, (everywhere,), priors, ["coverage"])
        problem, states = prepare(problem)
        values = jnp.asarray(np.stack([_flat(result) for _, result, _, _ in found]))
        coverage = np.asarray(_answer(problem, states, values))
    members = tuple(
        Calibrated(law, result, seen, known, one)
        for (law, result, seen, known), one in zip(found, coverage, strict=True)
    )
    return Ensemble(batched, members, tuple(skipped), problem, states)


def _flat(fit: Fit) -> Float[np.ndarray, " p"]:
    return np.concatenate([np.ravel(p.value) for p in fit.parameters])


@eqx.filter_jit
def _answer(problem: Problem, states: Any, values: Float[Array, "*b p"]) -> Float[Array, "*b wind"]:
    """Coverage at the problem's winds for any free numbers."""

    def one(numbers):
        return 10 ** problem.predictions(numbers, states).predicted[0]

    flat = jax.lax.map(one, jnp.reshape(values, (-1, values.shape[-1])), batch_size=64)
    return flat.reshape(*values.shape[:-1], -1)


@eqx.filter_jit
def _scatter(
    problem: Problem, states: Any, means: Any, covariances: Any, noise: Any
) -> Float[Array, "m d wind"]:
    """Coverage for numbers drawn from Gaussians on the sampler's line, where none leaves its bounds."""

    def draw(mean, covariance, normal):
        line = stretch(problem, mean)
        slope = jnp.exp(shrink(problem, line)[1])
        shares, vectors = jnp.linalg.eigh(covariance / slope / slope[:, None])
        points = line + normal @ (vectors * jnp.sqrt(jnp.maximum(shares, 0.0))).T
        return jax.vmap(lambda point: shrink(problem, point)[0])(points)

    return _answer(problem, states, jax.vmap(draw)(means, covariances, noise))
