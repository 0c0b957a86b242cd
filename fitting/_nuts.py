"""The no-U-turn sampler on the density of a fit: one chain after the other, each by the same two programs."""

import importlib
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from types import ModuleType
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from ._density import LogPosterior

DOUBLINGS = 8
"""A trajectory has at most 2⁸ steps; a longer one means that the posterior is a thread, and the chain says so."""

FIRST_STEP = 0.5
"""Step before adaptation, in units of the fit's own errors."""

SPREAD = 1.5
"""Chains start this many times the fit's own errors apart, so that R-hat can see whether they forget it."""

NEARER = 0.7
"""Each further try for a start is this much nearer to the fit."""

UNLIKELY = 10.0
"""No chain starts where the log density is this far below that at the fit: far off a bent ridge, in a narrow neck."""

BLOCK = 250
"""Draws of one call: chains of any length are made of such blocks, so that they share a compiled program."""

TRIES = 12
"""Starting points drawn for each chain; the first that is likely enough is taken."""


class Block(NamedTuple):
    """A stretch of a chain, or several chains one above the other."""

    values: Float[Array, "*chain draw p"]
    log_density: Float[Array, "*chain draw"]
    divergent: Bool[Array, "*chain draw"]
    saturated: Bool[Array, "*chain draw"]
    acceptance: Float[Array, "*chain draw"]
    steps: Int[Array, "*chain draw"]


def require_blackjax() -> ModuleType:
    """blackjax, or one sentence that names the extra to install.

    **Raises:** `ImportError`.
    """
    try:
        return importlib.import_module("blackjax")
    except ImportError as error:
        raise ImportError(
            "Sampling a posterior needs blackjax, which is not installed: pip install 'jaxocean[posterior]'."
        ) from error


def run_chains(
    densities: Sequence[LogPosterior],
    keys: Sequence[Any],
    warmup: int,
    draws: int,
    acceptance: float,
    advance: Callable[[], None] | None = None,
) -> list[Block]:
    """One chain for each density and key, on as many threads as there are cores.

    A single chain's arithmetic is too small for two cores, and chains in step would all wait for the longest
    trajectory among them. The first chain goes alone, because it compiles.
    """
    require_blackjax()

    def one(density: LogPosterior, key: Any) -> Block:
        # The precision belongs to a thread.
        with jax.enable_x64(True):
            block = _run(density, key, warmup, draws, jnp.asarray(acceptance, jnp.float64))
        if advance is not None:
            advance()
        return block

    first = one(densities[0], keys[0])
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        return [first, *pool.map(one, densities[1:], keys[1:])]


def _run(density: LogPosterior, key: Any, warmup: int, draws: int, acceptance: Float[Array, ""]) -> Block:
    begin, draw = jax.random.split(key)
    state, tuning = _adapt(density, begin, acceptance, warmup)
    blocks = []
    for one in jax.random.split(draw, -(-draws // BLOCK)):
        state, block = _draw(density, state, tuning, one)
        blocks.append(jax.device_get(block))
    return jax.tree.map(lambda *parts: np.concatenate(parts)[:draws], *blocks)


@eqx.filter_jit
def _adapt(
    density: LogPosterior, key: Any, acceptance: Float[Array, ""], warmup: int
) -> tuple[Any, dict[str, Any]]:
    """Where a chain is after its warm-up, with its step and mass matrix, adapted in windows as Stan does it.

    **Source:** Hoffman & Gelman 2014, J. Mach. Learn. Res. 15, 1593-1623.
    """
    blackjax = require_blackjax()
    begin, key = jax.random.split(key)
    # The sampler's own arithmetic mixes types that a strict session would refuse.
    with jax.numpy_dtype_promotion("standard"):
        adaptation = blackjax.window_adaptation(
            blackjax.nuts,
            lambda z: density(z),
            initial_step_size=FIRST_STEP,
            target_acceptance_rate=acceptance,
            adaptation_info_fn=lambda *_: None,
            max_num_doublings=DOUBLINGS,
        )
        (state, parameters), _ = adaptation.run(key, _start(density, begin), num_steps=warmup)
    return state, {name: parameters[name] for name in ("step_size", "inverse_mass_matrix")}


@eqx.filter_jit
def _draw(density: LogPosterior, state: Any, tuning: dict[str, Any], key: Any) -> tuple[Any, Block]:
    """The next block of a chain."""
    blackjax = require_blackjax()
    with jax.numpy_dtype_promotion("standard"):
        kernel = blackjax.nuts(lambda z: density(z), max_num_doublings=DOUBLINGS, **tuning)

        def step(state, key):
            state, info = kernel.step(key, state)
            saturated = (info.num_trajectory_expansions >= DOUBLINGS) & ~info.is_divergent
            kept = (info.is_divergent, saturated, info.acceptance_rate, info.num_integration_steps)
            return state, Block(density.values(state.position), state.logdensity, *kept)

        return jax.lax.scan(step, state, jax.random.split(key, BLOCK))


def _start(density: LogPosterior, key: Any) -> Float[Array, " p"]:
    """A likely point some way off the fit; the fit itself where none is found."""
    size = density.centre.size
    reach = SPREAD * NEARER ** jnp.arange(TRIES, dtype=density.centre.dtype)
    points = reach[:, None] * jax.random.normal(key, (TRIES, size), density.centre.dtype)
    points = jnp.concatenate([points, jnp.zeros((1, size), points.dtype)])
    logs = jax.lax.map(density, points)
    likely = jnp.isfinite(logs) & (logs > logs[-1] - UNLIKELY)
    return points[jnp.argmax(likely.at[-1].set(True))]
