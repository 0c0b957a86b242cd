"""The whole posterior distribution of a fit, by sampling."""

import importlib
import time
from collections.abc import Sequence
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray, PyTree, UInt32

from ._density import LogPosterior, whiten
from ._fit import Free, Targets
from ._nuts import Block, require_blackjax, run_chains
from ._posed import pose
from ._posterior_result import Posterior, posterior_warnings
from ._priors import AbstractPrior
from ._problem import Problem
from ._solvers import AbstractSolver


def posterior(
    model: PyTree,
    free: Free,
    targets: Targets,
    *,
    priors: Sequence[AbstractPrior] = (),
    chains: int = 4,
    draws: int = 1000,
    warmup: int = 500,
    acceptance: float = 0.8,
    key: PRNGKeyArray | UInt32[Array, "2"] | None = None,
    solver: AbstractSolver | None = None,
) -> Posterior:
    """Draw from the posterior distribution of the numbers that `fit` estimates.

    $$ p(v) ∝ \\exp\\left(−½ Σ_i r_i(v)²\\right) \\prod_t σ_t^{−n_t−1} $$

    with the residuals r of the fit, priors among them. What has no prior is flat inside its bounds, a fitted
    scatter σ is flat in log σ; a log-normal prior is a density of the value. The no-U-turn sampler moves along
    an unbounded line for each number (bounds are bijections, their log-Jacobians part of the density), in units
    of the fit's own errors; step and mass matrix are adapted in windows. The costly part of the model is
    computed once, where its leaves are not free. Needs the extra `posterior` (blackjax).

    **Arguments:** `model`, `free`, `targets`, `priors`, `solver`: as for `fit`, which runs first;

    - `chains`, `draws` of each after `warmup` steps that are thrown away.
    - `acceptance`: what the step size aims at, 0.5 to 0.99; nearer to 1 takes smaller steps, for posteriors
      with narrow places.
    - `key`: `jax.random.key(0)` by default; the same key gives the same draws.

    **Returns:** `Posterior`.

    **Raises:** `ImportError` without blackjax; what `fit` raises; `ValueError` for fewer than 2 chains,
    20 warm-up steps or 4 draws, and an acceptance outside its range.

    **Source:** Hoffman & Gelman 2014, J. Mach. Learn. Res. 15, 1593-1623.
    """
    require_blackjax()
    for name, value, least in (("chains", chains, 2), ("draws", draws, 4), ("warmup", warmup, 20)):
        if value < least:
            raise ValueError(f"Argument `{name}` must be at least {least}, but is {value}.")
    if not 0.5 <= acceptance <= 0.99:
        raise ValueError(f"Argument `acceptance` must lie between 0.5 and 0.99, but is {acceptance:g}.")
    posed = pose(model, free, targets, priors, solver)
    began = time.perf_counter()
    with jax.enable_x64(True):
        known = jnp.asarray(np.linalg.inv(posed.fit.covariance))
        density = around(posed.problem, posed.states, posed.values, known)
        keys = jax.random.split(jax.random.key(0) if key is None else key, chains)
        blocks = run_chains([density] * chains, list(keys), warmup, draws, acceptance)
    block: Block = jax.tree.map(lambda *parts: np.stack(parts), *blocks)
    seconds = time.perf_counter() - began
    return _report(posed.problem, posed.fit, block, seconds)


@eqx.filter_jit
def around(
    problem: Problem, states: Any, values: Float[Array, " p"], known: Float[Array, "p p"]
) -> LogPosterior:
    """The density in units of the errors at a solution whose inverse covariance is known."""
    return whiten(problem, states, values, known)


def _report(problem: Problem, fit, block: Block, seconds: float) -> Posterior:
    names = [slot.name for slot in problem.slots]
    r_hat, size = _diagnose(np.asarray(block.values))
    bounds = [slot.bounds for slot in problem.slots for _ in range(slot.size)]
    return Posterior(
        names=tuple(names),
        shapes=tuple(slot.shape for slot in problem.slots),
        units=tuple(slot.unit for slot in problem.slots for _ in range(slot.size)),
        labels=fit.labels,
        draws=np.asarray(block.values),
        log_density=np.asarray(block.log_density),
        r_hat=r_hat,
        effective_size=size,
        divergences=int(block.divergent.sum()),
        acceptance=float(block.acceptance.mean()),
        gradients=int(block.steps.sum()),
        seconds=seconds,
        fit=fit,
        warnings=posterior_warnings(fit.labels, bounds, block, r_hat, size),
    )


def _diagnose(
    draws: Float[np.ndarray, "chain draw p"],
) -> tuple[Float[np.ndarray, " p"], Float[np.ndarray, " p"]]:
    """R-hat of half chains, which also sees a chain that drifts, and the effective number of draws.

    **Source:** Gelman & Rubin 1992, Stat. Sci. 7; Geyer 1992, Stat. Sci. 7, as blackjax has them.
    """
    diagnostics = importlib.import_module("blackjax.diagnostics")
    half = draws.shape[1] // 2
    halves = np.concatenate([draws[:, :half], draws[:, -half:]])
    with jax.enable_x64(True), jax.numpy_dtype_promotion("standard"):
        r_hat = diagnostics.potential_scale_reduction(jnp.asarray(halves))
        size = diagnostics.effective_sample_size(jnp.asarray(halves))
    return np.atleast_1d(np.asarray(r_hat)), np.atleast_1d(np.asarray(size))
