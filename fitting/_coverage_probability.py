"""How often the intervals of a fit contain the truth: the same fit of many data sets whose truth is known."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, PRNGKeyArray, PyTree, UInt32

from ._coverage_shares import CoverageProbability
from ._density import LogPosterior, information, whiten
from ._fit import Free, Targets
from ._minimise import SOLVER, minimise
from ._nuts import require_blackjax, run_chains
from ._parameters import split
from ._posed import lay_out, slot_labels
from ._priors import AbstractPrior
from ._problem import Problem
from ._solvers import AbstractSolver

SETS_AT_ONCE = 25
"""Data sets of one call of the compiled program; two calls run at once where there are two cores."""


def coverage_probability(
    model: PyTree,
    free: Free,
    targets: Targets,
    *,
    priors: Sequence[AbstractPrior] = (),
    sets: int = 100,
    sampled: int = 0,
    warmup: int = 500,
    draws: int = 250,
    key: PRNGKeyArray | UInt32[Array, "2"] | None = None,
    solver: AbstractSolver | None = None,
    advance: Callable[[], None] | None = None,
) -> CoverageProbability:
    """Fit synthetic data sets and count how often the intervals contain the truth.

    A number with a prior has a truth of its own in each data set, drawn from that prior: an interval that leans on
    a prior can only keep its promise over the worlds that the prior describes (a truth that always sat at the
    prior's centre would be hit too often, one far out too rarely). All other truths are the model's own numbers.
    Data scatter around the truth as the targets say. All fits and profiles are one compiled program.

    **Arguments:** `model`, `free`, `targets`, `priors`, `solver`: as for `fit`; of the targets only winds and
    scatter count;

    - `sets`: how many data sets; `sampled`: for how many of them the posterior is drawn too, one chain of
      `warmup` + `draws` steps each (needs the extra `posterior`).
    - `key`: `jax.random.key(0)` by default; the same key gives the same data sets.
    - `advance`: called after each chunk of fits and of chains.

    **Returns:** `CoverageProbability`.

    **Raises:** `ValueError` for counts that make no sense; `ImportError` without blackjax where it is needed.
    """
    if sets < 2:
        raise ValueError(f"Argument `sets` must be at least 2, but is {sets}.")
    if not 0 <= sampled <= sets:
        raise ValueError(f"Argument `sampled` must lie between 0 and `sets` ({sets}), but is {sampled}.")
    if sampled:
        require_blackjax()
    advance = (lambda: None) if advance is None else advance
    solver = SOLVER if solver is None else solver
    problem, states = lay_out(model, free, targets, priors)
    with jax.enable_x64(True):
        root, chain_key = jax.random.split(jax.random.key(0) if key is None else key)
        # Every set has a key of its own, so that more sets begin with the same ones.
        keys = jax.vmap(lambda i: jax.random.fold_in(root, i))(
            jnp.arange(-(-sets // SETS_AT_ONCE) * SETS_AT_ONCE)
        )

        def repeat(begin: int) -> Tried:
            # The precision belongs to a thread.
            with jax.enable_x64(True):
                chunk = _repeat(problem, states, keys[begin : begin + SETS_AT_ONCE], solver)
                tried = jax.device_get(chunk)
            advance()
            return tried

        # The first chunk goes alone, because it compiles.
        parts = [repeat(0)]
        with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
            parts += pool.map(repeat, range(SETS_AT_ONCE, sets, SETS_AT_ONCE))
        tried = jax.tree.map(lambda *each: np.concatenate(each)[:sets], *parts)
        ranks = _sample(problem, states, tried, sampled, chain_key, warmup, draws, advance)
    labels = slot_labels(problem)
    lost = int(np.sum(~tried.converged))
    words = f"{lost} of {sets} fits or profiles of synthetic data did not converge: they are left out."
    return CoverageProbability(
        labels=labels,
        truths=tried.truths,
        values=tried.values,
        errors=tried.errors,
        roots=tried.roots,
        ranks=ranks,
        numbers=tried.numbers,
        converged=tried.converged,
        warnings=(words,) if lost else (),
    )


class Tried(NamedTuple):
    """What became of one data set, or of many."""

    truths: Float[Array, "*set p"]
    numbers: tuple[Float[Array, "*set n"], ...]
    values: Float[Array, "*set p"]
    errors: Float[Array, "*set p"]
    information: Float[Array, "*set p p"]
    roots: Float[Array, "*set p"]
    converged: Bool[Array, "*set"]


@eqx.filter_jit
def _repeat(problem: Problem, states: Any, keys: Any, solver: AbstractSolver) -> Tried:
    """Draw a data set for each key, fit it, and fit it again with each number held at its truth."""

    size = problem.start().size
    # The first row is the fit itself, the others hold one number each.
    held = jnp.concatenate([jnp.zeros((1, size), bool), jnp.eye(size, dtype=bool)])

    def one(key):
        truth_key, data_key = jax.random.split(key)
        truth = _truth(problem, truth_key)
        predicted, _, scatter = problem.predictions(truth, states)
        ends = np.cumsum([len(each) for each in predicted])[:-1]
        noise = jnp.split(jax.random.normal(data_key, (problem.data_size,), truth.dtype), ends)
        numbers = tuple(p + s * n for p, s, n in zip(predicted, scatter, noise, strict=True))
        posed = replaced(problem, numbers)

        def fit(hold):
            return minimise(posed, states, jnp.where(hold, truth, problem.start()), hold, solver)

        found = jax.lax.map(fit, held)
        values = found.values[0]
        known = information(problem, values, found.jacobian[0])
        excess = 2 * (found.cost[1:] - found.cost[0])
        return Tried(
            truths=truth,
            numbers=numbers,
            values=values,
            errors=jnp.sqrt(jnp.diagonal(jnp.linalg.inv(known))),
            information=known,
            roots=jnp.sign(truth - values) * jnp.sqrt(jnp.maximum(excess, 0.0)),
            converged=jnp.all(found.converged),
        )

    # One fit after the other takes less time than side by side, where all wait for the slowest.
    return jax.lax.map(one, keys)


def replaced(problem: Problem, numbers: Sequence[Float[Array, " n"]]) -> Problem:
    """The problem with other observed numbers."""
    return eqx.tree_at(lambda p: [target.numbers for target in p.tree[1]], problem, list(numbers))


def _truth(problem: Problem, key: Any) -> Float[Array, " p"]:
    """The model's own numbers, those with a prior drawn from it."""
    start = problem.start()
    parts = zip(
        problem.slots,
        problem.priors,
        split(problem.slots, start),
        split(problem.slots, jax.random.normal(key, start.shape, start.dtype)),
        strict=True,
    )
    drawn = [
        part if prior is None else slot.bounds.constrain(slot.bounds.unconstrain(prior.draw(normal)))
        for slot, prior, part, normal in parts
    ]
    return jnp.concatenate([part.ravel() for part in drawn])


@eqx.filter_jit
def _density(problem: Problem, states: Any, numbers: Any, values: Any, known: Any) -> LogPosterior:
    return whiten(replaced(problem, numbers), states, values, known)


def _sample(
    problem: Problem,
    states: Any,
    tried: Tried,
    sampled: int,
    key: Any,
    warmup: int,
    draws: int,
    advance: Callable,
) -> Float[np.ndarray, "sampled p"]:
    """Where the truth lies among the draws of each posterior."""
    chosen = np.flatnonzero(tried.converged)[:sampled]
    densities = [
        _density(problem, states, tuple(n[i] for n in tried.numbers), tried.values[i], tried.information[i])
        for i in chosen
    ]
    if not densities:
        return np.zeros((0, tried.truths.shape[1]))
    blocks = run_chains(densities, list(jax.random.split(key, len(densities))), warmup, draws, 0.8, advance)
    below = [(block.values < tried.truths[i]).mean(axis=0) for i, block in zip(chosen, blocks, strict=True)]
    return np.stack(below)
