"""Foam on a world tile, carried through time."""

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar
from ..._types import PerPattern, Scalar, ScalarLike
from ...surface import WorldTile
from .._jacobian import jacobian
from ._foam import Foam, FoamModel

T = TypeVar("T")


class Coverage(NamedTuple):
    """Coverage of a tile at one time, or at many (leading axis)."""

    active_rest: Float[Array, "*t"]
    active_projected: Float[Array, "*t"]
    total_rest: Float[Array, "*t"]
    total_projected: Float[Array, "*t"]
    birth_rate: Float[Array, "*t"]
    """Part of the rest plane that starts to break [1/s]."""


class Moment(NamedTuple):
    """What `evolve` lets one observe after each step."""

    time: Scalar
    model: FoamModel
    foam: Foam
    jacobian: Float[Array, "y x"]
    previous: Float[Array, "y x"]
    """j one step earlier."""
    step: Scalar


def observe_coverage(moment: Moment) -> Coverage:
    """Active and total coverage in both measures, and the rate at which points start to break."""
    model, j = moment.model, moment.jacobian
    starts = (j < model.threshold.astype(j.dtype)) & (moment.previous >= model.threshold.astype(j.dtype))
    return Coverage(
        model.active_coverage(j, "rest"),
        model.active_coverage(j, "projected"),
        model.total_coverage(moment.foam, j, "rest"),
        model.total_coverage(moment.foam, j, "projected"),
        jnp.mean(starts.astype(j.dtype)) / moment.step,
    )


@eqx.filter_jit
def evolve(
    foam: Foam,
    tile: WorldTile,
    model: FoamModel,
    *,
    start: ScalarLike,
    step: ScalarLike,
    count: int,
    choppiness: PerPattern = 1.0,
    breaking_wavenumber: ScalarLike | None = None,
    observe: Callable[[Moment], T] = observe_coverage,
) -> tuple[Foam, T]:
    """Carry foam from the time `start` through `count` steps.

    The sea is evaluated at start + Δt, start + 2Δt, …, so that two calls, one after the other, are one long one.
    A step should be short against the time for which a point breaks: what begins and ends between two steps is
    missed. Reverse derivatives keep one state per step and compute the sea a second time.

    **Arguments:**

    - `foam`: at `start`, of the tile's shape; `Foam.bare(N, N)` to begin with.
    - `tile`, `model`: differentiable in the sea, ε and τ (with `SmoothBreaking`, but for `birth_rate`).
    - `start` [s], `step` Δt [s], `count`: static.
    - `choppiness` λ, `breaking_wavenumber` k_b: as in `WorldTile.strain`.
    - `observe`: what to keep of each `Moment`, a function that returns a pytree of arrays.

    **Returns:** the foam at the end, and the observations stacked along a leading axis `count`.

    **Raises:** `ValueError` for a foam of another shape, and for a step or a count that is not positive.
    """
    shape = (tile.resolution, tile.resolution)
    if foam.coverage.shape != shape or foam.age.shape != shape:
        raise ValueError(
            f"Argument `foam` must have the tile's shape {shape}, but has {foam.coverage.shape}."
        )
    if count < 1:
        raise ValueError(f"Argument `count` must be at least 1, but is {count}.")
    dtype = tile.sea.waves.rate.dtype
    dt, begin = (as_leaf(one).astype(dtype) for one in (step, start))
    check_scalar("step", dt, "s", positive=True)
    foam = jax.tree.map(lambda x: x.astype(dtype), foam)

    def strain_jacobian(time: Scalar) -> Float[Array, "y x"]:
        return jacobian(tile.strain(time, choppiness, breaking_wavenumber))

    @jax.checkpoint
    def advance(
        carry: tuple[Foam, Float[Array, "y x"]], index: Float[Array, ""]
    ) -> tuple[tuple[Foam, Float[Array, "y x"]], T]:
        before, previous = carry
        time = begin + index * dt
        j = strain_jacobian(time)
        after = model.step(before, j, dt)
        return (after, j), observe(Moment(time, model, after, j, previous, dt))

    steps = jnp.arange(1, count + 1).astype(dtype)
    (final, _), observations = jax.lax.scan(advance, (foam, strain_jacobian(begin)), steps)
    return final, observations
