"""The posterior density of a fit's free numbers, on a line without bounds and in units of the fit's own errors."""

import math
from typing import Any

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ._bounds import Interval
from ._parameters import split
from ._problem import Problem
from ._solve import lift

EDGE = 4.0
"""Chains start no further out than this on the logistic line of an interval, 2 % of its width from a bound."""

LOGISTIC = 3.0 / math.pi**2
"""Information of the logistic distribution, which is what a flat density inside an interval is on that line."""

WEAKEST = 1e-6
"""Directions with less than this share of a parameter's own information are not stretched any further."""


class LogPosterior(eqx.Module):
    """log p(z) of the whitened free numbers z: y = c + Lz on the sampler's line, values v inside their bounds.

    $$ \\log p(z) = −½ Σ_i r_i(v)² − Σ_t (n_t + 1) \\log σ_t + \\log |∂v/∂y| + const $$

    with the residuals r of the fit, priors among them. What has no prior is flat inside its bounds, a fitted
    scatter is flat in log σ, and a log-normal prior is a density of the value itself.
    """

    problem: Problem
    states: Any
    centre: Float[Array, " p"]
    scale: Float[Array, "p p"]

    def __call__(self, z: Float[Array, " p"]) -> Float[Array, ""]:
        values, log_slope = self.shrink(z)
        predictions = self.problem.predictions(values, self.states)
        return (
            -0.5 * jnp.sum(self.problem.residuals(values, predictions) ** 2)
            + self._measure(values)
            + log_slope
        )

    def values(self, z: Float[Array, " p"]) -> Float[Array, " p"]:
        """The free numbers themselves."""
        return self.shrink(z)[0]

    def shrink(self, z: Float[Array, " p"]) -> tuple[Float[Array, " p"], Float[Array, ""]]:
        """The free numbers, and log |∂v/∂y|."""
        values, slopes = shrink(self.problem, self.centre + self.scale @ z)
        return values, jnp.sum(slopes)

    def _measure(self, values: Float[Array, " p"]) -> Float[Array, ""]:
        total = jnp.zeros((), values.dtype)
        parts = split(self.problem.slots, values)
        for slot, prior, part in zip(self.problem.slots, self.problem.priors, parts, strict=True):
            if prior is not None:
                total += jnp.sum(prior.log_measure(part))
            elif slot.is_scatter:
                total -= jnp.sum(jnp.log(part))
        return total


def whiten(
    problem: Problem, states: Any, values: Float[Array, " p"], information: Float[Array, "p p"]
) -> LogPosterior:
    """The density in coordinates in which the Gaussian approximation at `values` is a standard normal one.

    This only makes sampling faster: any centre and scale give the same distribution of the values.

    **Arguments:** `problem` in float64 with its prepared `states`; `values`, `information`: solution of a fit
    and JᵀJ there.
    """
    line = stretch(problem, values)
    bounded = jnp.concatenate(
        [jnp.full(slot.size, isinstance(slot.bounds, Interval)) for slot in problem.slots]
    )
    line = jnp.where(bounded, jnp.clip(line, -EDGE, EDGE), line)
    slope = jnp.exp(shrink(problem, line)[1])
    known = information * slope * slope[:, None] + jnp.diag(jnp.where(bounded, LOGISTIC, 0.0))
    own = jnp.sqrt(jnp.diag(known))
    own = jnp.where(own > 0, own, 1.0)
    shares, vectors = jnp.linalg.eigh(known / own / own[:, None])
    scale = vectors / jnp.sqrt(jnp.maximum(shares, WEAKEST)) / own[:, None]
    return LogPosterior(problem, states, line, scale)


def stretch(problem: Problem, values: Float[Array, " p"]) -> Float[Array, " p"]:
    """Points on the sampler's line of numbers inside their bounds."""
    parts = zip(problem.slots, split(problem.slots, values), strict=True)
    return jnp.concatenate([slot.bounds.stretch(part).ravel() for slot, part in parts])


def shrink(problem: Problem, line: Float[Array, " p"]) -> tuple[Float[Array, " p"], Float[Array, " p"]]:
    """Numbers inside their bounds from points on the sampler's line, and the log derivative of each."""
    parts = zip(problem.slots, split(problem.slots, line), strict=True)
    pairs = [slot.bounds.shrink(part) for slot, part in parts]
    values, slopes = zip(*pairs, strict=True)
    return jnp.concatenate([v.ravel() for v in values]), jnp.concatenate([s.ravel() for s in slopes])


def information(
    problem: Problem, values: Float[Array, " p"], jacobian: Float[Array, "r p"]
) -> Float[Array, "p p"]:
    """What data and priors tell about the free numbers: JᵀJ, and 2n/σ² of a fitted scatter.

    **Arguments:** `jacobian` of the problem's residuals in the free numbers at `values`.
    """
    rows = jacobian[: problem.data_size + problem.prior_size]
    scatter = jnp.concatenate(
        [
            2 * problem.scatter_size(slot) / part.ravel() ** 2 if slot.is_scatter else jnp.zeros(slot.size)
            for slot, part in zip(problem.slots, split(problem.slots, values), strict=True)
        ]
    )
    rows = jnp.where(scatter > 0, 0.0, rows)
    return rows.T @ rows + jnp.diag(scatter)


@eqx.filter_jit
def prepare(problem: Problem) -> tuple[Problem, Any]:
    """The problem in float64, and the costly part of its model, once for all that follows."""
    problem = lift(problem)
    return problem, problem.prepare()
