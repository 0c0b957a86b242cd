"""The exact closure for millions of footprints: the same contour integral with a handful of nodes."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._elementary import inverse_root
from .._numerics import as_leaf
from .._types import FloatLike
from ._closures import FOLD, AbstractClosure, Measure, check_measure
from ._contour import integrate
from ._quadratic_form import Form, moments, sound_form
from ._statistics import StrainStatistics

FARTHEST = 7.0
"""Standard deviations of j below its mean beyond which nothing is left of its distribution."""

SMALLEST = 1e-12
"""Least variance of j: below it W is a step all the same."""


class FastClosure(AbstractClosure):
    """`ExactClosure` for millions of footprints, with a handful of nodes.

    Footprints of realised seas (U10 4 to 20 m/s, 0.05 to 150 m, ε 0.1 to 0.7, float32) are within max(2 %, 2e-5) of
    it. Of wholly random covariances around random means (±0.3) up to 0.4 % are farther off at ε ≥ 0.1 and 1 % at
    ε = −0.1, a few of them by far.

    Both invert the same cumulant generating function. This one takes two steps of Halley's rule towards the saddle
    point of K(s) − sε − log|s|, which minds the pole at s = 0 by itself; bends a hyperbola through it by its third
    derivative, to the side on which the integrand is smaller; and sums `nodes` trapezoidal nodes. The partial mean
    comes from E[j; j < x] = x P(j < x) − E[(x − j)⁺], whose integrand has 1/s² in the place of 1/s. There are no loops
    over pixels, and in float32 XLA makes one program of all of it.

    Derivatives are sums over the same nodes with the contour held, all of them in one pass: as accurate as W, and as
    cheap in reverse as in forward mode. `log` is that of W, and worth no more
    than W: use `ExactClosure` for the far tail and for fits.

    **Arguments:**

    - `measure`: "projected" (default) or "rest", as in `ExactClosure`.
    - `nodes`: of the contour; more are more accurate and slower in proportion.

    **Raises:** `ValueError` for another measure or fewer than four nodes.
    """

    measure: Measure = eqx.field(static=True, default="projected")
    nodes: int = eqx.field(static=True, default=6)

    def __check_init__(self) -> None:
        check_measure(self.measure)
        if self.nodes < 4:
            raise ValueError(f"Argument `nodes` must be at least 4, but is {self.nodes}.")

    def __call__(self, stats: StrainStatistics, threshold: FloatLike) -> Float[Array, "*b"]:
        dtype = stats.covariance.dtype
        level = as_leaf(threshold).astype(dtype)
        shape = jnp.broadcast_shapes(stats.mean.shape[:-1], level.shape)
        mean = jnp.broadcast_to(stats.mean, (*shape, 3))
        covariance = jnp.broadcast_to(stats.covariance, (*shape, 3, 3))
        return _coverage(mean, covariance, jnp.broadcast_to(level, shape), self.measure, self.nodes)

    def log(self, stats: StrainStatistics, threshold: FloatLike) -> Float[Array, "*b"]:
        coverage = self(stats, threshold)
        some = coverage > 0
        return jnp.where(some, jnp.log(jnp.where(some, coverage, 1.0)), -jnp.inf)


@partial(jax.jit, static_argnames=("measure", "nodes"))
def _coverage(
    mean: Float[Array, "*b 3"],
    covariance: Float[Array, "*b 3 3"],
    level: Float[Array, "*b"],
    measure: Measure,
    nodes: int,
) -> Float[Array, "*b"]:
    if measure == "rest":
        return jnp.clip(_below(_scaled(sound_form(mean, covariance)), level, nodes, moment=False), 0.0, 1.0)

    # Element by element, for a loop over footprints is slow where each has its elements side by side.
    means = [mean[..., i] for i in range(3)]
    rows = [[covariance[..., max(i, j), min(i, j)] for j in range(3)] for i in range(3)]
    levels = (level, -FOLD * jnp.abs(level))
    # Most bands of a picture hold no fold, and many no foam: what no footprint has is not computed.
    _, expected, deviation, _ = jax.lax.stop_gradient(_form(means, rows, 0.0))
    needed = jnp.stack([jnp.any(expected - x < FARTHEST * deviation) for x in levels])

    # A loop, for both levels in one program take XLA minutes. What does not change in it would be computed before it,
    # in pieces; so everything changes, by nothing.
    def add(which, total):
        first = which == 0
        weight = jnp.where(level > 0, jnp.where(first, 1.0, -2.0), jnp.where(first, -1.0, 0.0))

        def some() -> Float[Array, "*b"]:
            form = _form(means, rows, 0.0 * which.astype(level.dtype))
            x = jnp.where(first, *levels)
            return total + weight * _below(form, x, nodes, moment=True)

        return jax.lax.cond(needed[which], some, lambda: total)

    return jnp.maximum(jax.lax.fori_loop(0, 2, add, jnp.zeros_like(level)), 0.0)


def _form(means: list[Array], rows: list[list[Array]], nothing: Array | float) -> tuple:
    """The scaled form of the strain's means and covariances, to each of which `nothing` is added."""
    moved = jnp.stack([each + nothing for each in means], axis=-1)
    spread = jnp.stack([jnp.stack([each + nothing for each in row], axis=-1) for row in rows], axis=-2)
    return _scaled(sound_form(moved, spread))


def _scaled(form: Form) -> tuple[Form, Float[Array, "*b"], Float[Array, "*b"], Float[Array, "*b"]]:
    """Form in t = s·deviation, with z = t instead of 2s; mean, deviation and 1/deviation of j."""
    mean, variance = moments(form)
    variance = jnp.maximum(variance, SMALLEST)
    i = inverse_root(variance)
    ii = i * i
    q1, q2, q3 = 2 * form.q1 * ii, 4 * form.q2 * ii * i, 8 * form.q3 * ii * ii
    return (
        Form(form.n, 2 * form.t1 * i, 4 * form.t2 * ii, 8 * form.t3 * ii * i, q1, q2, q3),
        mean,
        variance * i,
        i,
    )


def _below(scaled, x: Float[Array, "*b"], nodes: int, *, moment: bool) -> Float[Array, "*b"]:
    """P(j < x), or E[j; j < x]."""
    form, mean, deviation, inverse = scaled
    gap = (form.n - x) * inverse
    distance = (mean - x) * inverse
    upper = distance < 0
    sign = jnp.where(upper, 1.0, -1.0).astype(x.dtype)
    probability, excess = integrate(form, gap, distance, sign, nodes)
    if not moment:
        return jnp.where(upper, 1 - probability, probability)
    # E[|j − x|] on the far side of x, as seen from the mean.
    excess = deviation * excess
    return jnp.where(upper, mean - x * probability - excess, x * probability - excess)
