"""The inverse of a closure: where a sea breaks if so much of it is white."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_kind, is_concrete
from .._types import FloatLike
from ._closures import AbstractClosure, ExactClosure
from ._statistics import StrainStatistics

HIGHEST = 3.0
"""Largest ε [-] that is looked for."""

HALVINGS = {4: 22, 8: 45}
"""How often the interval is halved, by the width [bytes] of the type: then Newton's step ends it."""


def breaking_threshold(
    stats: StrainStatistics, coverage: FloatLike, closure: AbstractClosure | None = None
) -> Float[Array, "*b"]:
    """The threshold at which a sea has a given whitecap coverage.

    $$ ε: W(ε) = W_0, \\quad
       \\mathrm{d}ε = \\frac{\\mathrm{d}\\log W_0 - ∂_s \\log W\\,\\mathrm{d}s}{∂_ε \\log W} $$

    By halving, and a step of Newton's rule that also carries the derivative in the coverage and in the statistics s.
    Where even ε = 3 covers less, or ε = 0 more, the result is that end, with the derivative of Newton's step there.

    **Arguments:** `stats` of the strain; `coverage`: W₀ [-], from 0 to 1 without the ends; `closure`: the exact one in
    projected area if None.

    **Returns:** ε [-].

    **Raises:** `ValueError` for a coverage that is not between 0 and 1.
    """
    closure = ExactClosure() if closure is None else closure
    check_kind("closure", closure, AbstractClosure, "a closure such as `ExactClosure()`")
    wanted = as_leaf(jnp.asarray(coverage))
    if is_concrete(wanted) and not bool(jnp.all((wanted > 0) & (wanted < 1))):
        raise ValueError(f"Argument `coverage` must lie between 0 and 1, but is {wanted}.")
    dtype = stats.covariance.dtype
    goal = jnp.log(wanted.astype(dtype))
    fixed, aim = jax.lax.stop_gradient((stats, goal))
    shape = jnp.broadcast_shapes(stats.mean.shape[:-1], goal.shape)

    def halve(_, ends):
        lower, upper = ends
        middle = 0.5 * (lower + upper)
        enough = closure.log(fixed, middle) >= aim
        return jnp.where(enough, lower, middle), jnp.where(enough, middle, upper)

    ends = jnp.zeros(shape, dtype), jnp.full(shape, HIGHEST, dtype)
    lower, upper = jax.lax.fori_loop(0, HALVINGS[dtype.itemsize], halve, ends)
    near = jax.lax.stop_gradient(0.5 * (lower + upper))
    steepness = jax.jvp(lambda level: closure.log(fixed, level), (near,), (jnp.ones_like(near),))[1]
    usable = jnp.isfinite(steepness) & (steepness > 0)
    miss = goal - closure.log(stats, near)
    step = jnp.where(usable & jnp.isfinite(miss), miss, 0.0) / jax.lax.stop_gradient(
        jnp.where(usable, steepness, 1.0)
    )
    # At an end of the range the miss is no rounding, and only its derivative is wanted.
    return near + jnp.where(jnp.abs(step) < 1e-3, step, step - jax.lax.stop_gradient(step))
