"""Distribution function and partial mean of the Jacobian by inversion of its cumulant generating function."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Inexact

from ._quadratic_form import (
    Form,
    curvature,
    denominator,
    excess,
    exists,
    extreme_eigenvalues,
    moments,
    numerator,
    steepness,
)

NODES = 64
"""Trapezoidal nodes on the chosen contour."""

TRIAL_NODES, REACH = 32, 12.0
"""Nodes on the contours that are compared, and the end of their parameter."""

TILT = 0.5
"""Slope of a bent contour's asymptotes: a wave e^{−sε} then decays along it."""

GONE = 0.9
"""A contour ends where the integrand has fallen to this power of the machine's epsilon."""

UNFINISHED = 1e8
"""Weight of the integrand at the end of a contour when contours are compared."""

TURNING = 4.0
"""A turning of the phase from node to node by 1/4 rad doubles the weight of the integrand in that comparison."""

STRAIGHT = 1.1
"""Handicap of the straight contour there."""

BISECTIONS = 36

CERTAIN, IMPOSSIBLE = -80.0, -1e6
"""Exponents beyond which a complement, or a probability, is not told from zero."""


class PartialMoments(NamedTuple):
    """P(j < x) = e^{exponent}·probability and E[j; j < x] = e^{exponent}·moment, or their complements.

    Where `upper` is True the two numbers belong to j > x instead.
    """

    exponent: Float[Array, "*b"]
    probability: Float[Array, "*b"]
    moment: Float[Array, "*b"]
    upper: Array


class Contour(NamedTuple):
    """A hyperbola s = crossing + tilt·(√(bend² + rise²) − bend) + i·rise, rise = width·sinh u, 0 < u < reach."""

    crossing: Float[Array, "*b"]
    width: Float[Array, "*b"]
    upper: Array
    tilt: Float[Array, "*b"]
    bend: Float[Array, "*b"]
    reach: Float[Array, "*b"]


@jax.custom_jvp
def partial_moments(form: Form, level: Float[Array, "*b"]) -> PartialMoments:
    """Distribution function and partial first moment of j at a level x, by inversion along a steep-descent contour.

    $$ P(j < x) = -\\frac{1}{2πi}∫ e^{K(s) − sx} \\frac{ds}{s}, \\quad
       E[j; j < x] = -\\frac{1}{2πi}∫ K'(s) e^{K(s) − sx} \\frac{ds}{s} $$

    The contour crosses the real axis at the saddle point s₀ < 0 of K(s) − sx; for x above the mean it crosses at
    s₀ > 0 and gives the complement. The factor e^{K(s₀) − s₀x} is kept apart, so that far in the tail the *relative*
    error stays the same. Where the contour runs does not change the integral, so it carries no derivative.

    **Source:** Lugannani & Rice 1980 for the saddle point; the quadrature is a plain trapezoidal rule.
    """
    return _invert(form, level, _contour(form, level))[0]


@partial_moments.defjvp
def _partial_moments_jvp(primals, tangents):
    """Derivatives under the integral sign, from the same nodes: far less to compile than a derivative of the code."""
    (form, level), (dform, dlevel) = primals, tangents
    contour = _contour(*jax.lax.stop_gradient((form, level)))
    value, nodes = _invert(form, level, contour)
    dform = Form(*(t.astype(level.dtype) for t in dform))
    dexponent, dprobability, dmoment = _change(
        form, contour.crossing, nodes, dform, dlevel.astype(level.dtype)
    )
    none: Any = np.zeros(value.upper.shape, jax.dtypes.float0)
    return value, PartialMoments(dexponent, dprobability, dmoment, none)


@jax.jit
def _change(form: Form, crossing: Float[Array, "*b"], nodes, dform: Form, dlevel: Float[Array, "*b"]):
    """Derivatives of the exponent and of both integrals."""
    dk, weight, s, inverse = nodes
    wide, dwide = _widen(form, s.dtype), _widen(dform, s.dtype)
    z = 2 * s
    dd, (q, dq) = denominator(wide, z)[1], numerator(wide, z)
    # ∂K/∂D, ∂K/∂Q and their derivatives in z; ∂D/∂(t₁, t₂, t₃) = −z, z², −z³ and ∂Q/∂(q₁, q₂, q₃) = 1, z, z².
    half = 0.5 * z * inverse
    pull, push = -0.5 * inverse - half * z * q * inverse, half * z
    its_slope = inverse * (z - half * z * dd)
    slope = inverse * (inverse * (0.5 * dd - z * q - 0.5 * z**2 * dq) + 2 * half * z * q * dd * inverse)
    change_d, rate_d = -z * (dwide.t1 - z * (dwide.t2 - z * dwide.t3)), denominator(dwide, z)[1]
    change_q, rate_q = numerator(dwide, z)
    change = pull * change_d + push * change_q + s * dwide.n
    change_slope = 2 * (slope * change_d + pull * rate_d + its_slope * change_q + push * rate_q) + dwide.n

    fixed = jax.lax.stop_gradient(crossing)
    dexponent = (
        jax.jvp(lambda f: excess(f, fixed, jnp.zeros_like(fixed)), (form,), (dform,))[1] - fixed * dlevel
    )
    shift = s * dlevel[..., None].astype(s.dtype) + dexponent[..., None].astype(s.dtype)
    dprobability = jnp.sum(jnp.imag(weight * (change - shift)), axis=-1)
    dmoment = jnp.sum(jnp.imag(weight * (dk * (change - shift) + change_slope)), axis=-1)
    return dexponent, dprobability, dmoment


def _widen(form: Form, dtype) -> Form:
    """Coefficients with an axis for the nodes."""
    return Form(*(coefficient[..., None].astype(dtype) for coefficient in form))


@jax.jit
def _invert(form: Form, level: Float[Array, "*b"], contour: Contour):
    """The two integrals along a contour, and at its nodes K′, the weights, s and 1/D for their derivatives."""
    exponent = excess(form, contour.crossing, level)
    step = contour.reach / NODES
    s, ds = _nodes(contour, jnp.asarray(np.arange(NODES) + 0.5, step.dtype) * step[..., None])
    wide = _widen(form, s.dtype)
    z = 2 * s
    (d, dd), (q, dq) = denominator(wide, z), numerator(wide, z)
    square, inverse = _inverse(d)
    # On a path to the left two eigenvalues may turn D by more than a half circle.
    angle = jnp.arctan2(jnp.imag(d), jnp.real(d))
    angle = jnp.where((contour.tilt[..., None] < 0) & (angle < -0.5 * np.pi), angle + 2 * np.pi, angle)
    logarithm = jax.lax.complex(0.5 * jnp.log(square), angle)
    ratio = z * q * inverse
    gap = (form.n - level)[..., None].astype(s.dtype)
    k = s * (gap + ratio) - 0.5 * logarithm - exponent[..., None].astype(s.dtype)
    dk = wide.n + 2 * ratio + inverse * (z**2 * dq - dd - z * ratio * dd)
    # Where nothing at all breaks no contour is good; e^{exponent} = 0 then must not meet an infinity.
    size = jnp.exp(jnp.minimum(jnp.real(k), 50.0)) / (jnp.real(s) ** 2 + jnp.imag(s) ** 2)
    scale = (jnp.where(contour.upper, 1.0, -1.0) * step / np.pi)[..., None]
    wave = jax.lax.complex(jnp.cos(jnp.imag(k)), jnp.sin(jnp.imag(k)))
    weight = (scale * size).astype(s.dtype) * wave * ds * jnp.conj(s)
    probability = jnp.sum(jnp.imag(weight), axis=-1)
    moment = jnp.sum(jnp.imag(dk * weight), axis=-1)
    return PartialMoments(exponent, probability, moment, contour.upper), (dk, weight, s, inverse)


def _inverse(d: Inexact[Array, "*c"]) -> tuple[Float[Array, "*c"], Inexact[Array, "*c"]]:
    """|D|² and 1/D, written out: the library's own guard against overflow, which cannot happen here, has to be
    compiled."""
    square = jnp.real(d) ** 2 + jnp.imag(d) ** 2
    return square, jnp.conj(d) * (1 / square).astype(d.dtype)


def _nodes(contour: Contour, u: Float[Array, "*u"]) -> tuple[Inexact[Array, "*c"], Inexact[Array, "*c"]]:
    """s and ds/du."""
    crossing, width, _, tilt, bend, _ = (value[..., None] for value in contour)
    growth = jnp.exp(u)
    rise, slope = 0.5 * width * (growth - 1 / growth), 0.5 * width * (growth + 1 / growth)
    arm = jnp.sqrt(bend**2 + rise**2)
    s = jax.lax.complex(*jnp.broadcast_arrays(crossing + tilt * rise * (rise / (arm + bend)), rise))
    return s, jax.lax.complex(*jnp.broadcast_arrays(tilt * (rise / arm) * slope, slope))


@jax.jit
def _contour(form: Form, level: Float[Array, "*b"]) -> Contour:
    """The contour with the smallest expected error: a hyperbola bent to either side or a straight line.

    All of them give the same integral, but not with the same error. It is small where the integrand is small in
    absolute value (nothing has to cancel), turns slowly from node to node, and has died out at the end.

    The integrand may rise again farther out, on a path bent to the wrong side: where eigenvalues differ by orders of
    magnitude, the direction in which e^{K(s) − sx} decays depends on |s|. The true path changes sides in between,
    where nothing is left of the integrand; this one ends there.
    """
    crossing, width, upper = _saddle(form, level)
    lowest, highest = extreme_eigenvalues(form)
    tiny = jnp.finfo(level.dtype).tiny ** 0.5
    # A bent path turns no earlier than the circle between the crossing and the singularity at 1/(2λ), inside of
    # which e^K is large.
    ends = [jnp.minimum(lowest, -tiny), jnp.full_like(lowest, jnp.inf), jnp.maximum(highest, tiny)]
    bend = jnp.stack([jnp.maximum(width, jnp.abs(0.5 / end - crossing)) for end in ends])
    tilt = jnp.asarray([-TILT, 0.0, TILT], level.dtype).reshape(3, *(1,) * level.ndim)
    trial = Contour(crossing, width, upper, tilt, bend, jnp.full_like(level, REACH))
    spacing = REACH / TRIAL_NODES
    size, turning, reach = _trial(form, level, trial, spacing)
    turning = jnp.minimum(turning * (TURNING / NODES) * reach[..., None], 1e6)
    last = size[..., -1]
    cost = spacing * jnp.sum(size * (1 + turning**4), axis=-1) + UNFINISHED * last
    cost = cost * jnp.asarray([1.0, STRAIGHT, 1.0], level.dtype).reshape(tilt.shape)
    cost = jnp.where(jnp.isfinite(cost), cost, jnp.inf)
    best = jnp.argmin(cost, axis=0)
    tilt, bend, reach = (
        jnp.take_along_axis(jnp.broadcast_to(x, cost.shape), best[None], axis=0)[0]
        for x in (tilt, bend, reach)
    )
    return Contour(crossing, width, upper, tilt, bend, reach)


def _trial(form: Form, level, contour: Contour, spacing: float):
    """On a coarse contour: |e^{K(s) − sx − exponent} ds/s|, the turning of its phase, and where it has died out."""
    s, ds = _nodes(contour, jnp.asarray((np.arange(TRIAL_NODES) + 0.5) * spacing, level.dtype))
    wide = _widen(form, s.dtype)
    z = 2 * s
    (d, dd), (q, dq) = denominator(wide, z), numerator(wide, z)
    square, inverse = _inverse(d)
    ratio = z * q * inverse
    gap = (form.n - level)[..., None].astype(s.dtype)
    k = (
        jnp.real(s * (gap + ratio))
        - 0.25 * jnp.log(square)
        - excess(form, contour.crossing, level)[..., None]
    )
    dk = gap + 2 * ratio + inverse * (z**2 * dq - dd - z * ratio * dd)
    inverse_s = _inverse(s)[1]
    turning = jnp.abs(jnp.imag((dk - inverse_s) * ds))
    steps = (jnp.real(ds) ** 2 + jnp.imag(ds) ** 2) / (jnp.real(s) ** 2 + jnp.imag(s) ** 2)
    size = k + 0.5 * jnp.log(steps)
    gone = GONE * np.log(jnp.finfo(level.dtype).eps)
    dead = (
        jax.lax.cummax((~((size >= gone) & jnp.isfinite(turning))).astype(jnp.int32), axis=size.ndim - 1) > 0
    )
    alive = jnp.sum(~dead, axis=-1)
    reach = spacing * jnp.minimum(alive + 1, TRIAL_NODES).astype(level.dtype)
    return jnp.where(dead, 0.0, jnp.exp(size)), jnp.where(dead, 0.0, turning), reach


@jax.jit
def _saddle(form: Form, level: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"], Array]:
    """The saddle point of K(s) − sx on the real axis, its width 1/√K″, and whether it is positive."""
    tiny = jnp.finfo(level.dtype).tiny ** 0.5
    mean, variance = moments(form)
    deviation = jnp.broadcast_to(jnp.sqrt(jnp.maximum(variance, tiny)), level.shape)
    upper = level > mean
    sign = jnp.where(upper, 1.0, -1.0)
    start = jnp.log(1e-3 / deviation)
    farthest = min(20.0, -float(np.log(jnp.finfo(level.dtype).eps)))
    stop = start + jnp.log(1 + jnp.abs(level - mean) / deviation) + farthest

    def narrow(_, brackets):
        def halve(bracket, below):
            low, high = bracket
            half = 0.5 * (low + high)
            keep = below(sign * jnp.exp(half))
            return jnp.where(keep, half, low), jnp.where(keep, high, half)

        saddle, end = brackets
        saddle = halve(saddle, lambda s: exists(form, s) & _is_downhill(form, s, level, sign))
        return saddle, halve(end, lambda s: exists(form, s))

    saddle, end = jax.lax.fori_loop(0, BISECTIONS, narrow, ((start, stop), (start, stop)))
    # The pole at s = 0 must stay about one width away, and the end of the strip of convergence too.
    nearest = jnp.minimum(1 / deviation, 0.5 * jnp.exp(end[0]))
    crossing = sign * jnp.maximum(jnp.exp(saddle[0]), nearest)
    # 1/√K″, but never much wider than the way to the pole.
    bound = 0.25 / crossing**2
    return crossing, 1 / jnp.sqrt(jnp.maximum(curvature(form, crossing), bound)), upper


def _is_downhill(
    form: Form, s: Float[Array, "*b"], level: Float[Array, "*b"], sign: Float[Array, "*b"]
) -> Array:
    """Whether K(s) − sx still falls with |s|, and has not yet fallen so far that it does not matter."""
    matters = excess(form, s, level) > jnp.where(sign > 0, CERTAIN, IMPOSSIBLE)
    return (sign * steepness(form, s, level) < 0) & matters
