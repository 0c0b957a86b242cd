"""The Jacobian as a quadratic form in Gaussian variables: its cumulant generating function and partial moments.

j = xᵀMx with x = (1 + a, 1 + b, c) Gaussian of mean m and covariance C. Everything here depends on C and m only
through the coefficients of three polynomials, so nothing is inverted, decomposed or floored: a singular covariance
is no special case.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Inexact

NODES = 96
REACH = 12.0
"""Trapezoidal nodes on the contour and the end of their parameter, where the integrand has fallen by e^{−1.5·12}."""

TILT = 0.5
"""Slope of a bent contour's asymptotes: a wave e^{−sε} then decays along it, and no branch cut is crossed."""

UNFINISHED = 1e8
"""Weight of the integrand at the end of a contour when contours are compared."""

STRAIGHT = 3.0
"""Handicap of the straight contour in that comparison."""

BISECTIONS = 36


class Form(NamedTuple):
    """Coefficients of K(s) = −½ log D(s) + s N(s)/D(s), with D = 1 − t₁z + t₂z² − t₃z³, N = n₀ + n₁z + n₂z², z = 2s.

    t₁, t₂, t₃ are the invariants of CM (trace, second invariant, determinant).
    """

    t1: Inexact[Array, "*b"]
    t2: Inexact[Array, "*b"]
    t3: Inexact[Array, "*b"]
    n0: Inexact[Array, "*b"]
    n1: Inexact[Array, "*b"]
    n2: Inexact[Array, "*b"]


def jacobian_form(mean: Float[Array, "*b 3"], covariance: Float[Array, "*b 3 3"]) -> Form:
    """Coefficients for the Jacobian of a strain (a, b, c) of this mean and covariance."""
    p, q, r = 1 + mean[..., 0], 1 + mean[..., 1], mean[..., 2]
    caa, cbb, ccc = covariance[..., 0, 0], covariance[..., 1, 1], covariance[..., 2, 2]
    cab, cac, cbc = covariance[..., 0, 1], covariance[..., 0, 2], covariance[..., 1, 2]
    # det C and its minors; det M = 1/4, M⁻¹ = [[0, 2, 0], [2, 0, 0], [0, 0, −1]].
    minor_ab = caa * cbb - cab**2
    minor_ac = caa * ccc - cac**2
    minor_bc = cbb * ccc - cbc**2
    det = caa * minor_bc - cab * (cab * ccc - cac * cbc) + cac * (cab * cbc - cbb * cac)
    t1 = cab - ccc
    # Second invariant of CM = Σ over pairs of columns of (minors of C)·(minors of M).
    t2 = -0.25 * minor_ab - (cab * ccc - cac * cbc)
    t3 = 0.25 * det
    n0 = p * q - r**2
    # xᵀMCMx − t₁ xᵀMx, with Mx = (q/2, p/2, −r).
    quadratic = 0.25 * (q**2 * caa + p**2 * cbb + 2 * p * q * cab) - r * (q * cac + p * cbc) + r**2 * ccc
    n1 = quadratic - t1 * n0
    # xᵀM adj(CM) x = det M · xᵀ adj(C) x.
    adj_ab = cac * cbc - cab * ccc
    adj_ac = cab * cbc - cac * cbb
    adj_bc = cab * cac - cbc * caa
    n2 = 0.25 * (
        p**2 * minor_bc
        + q**2 * minor_ac
        + r**2 * minor_ab
        + 2 * (p * q * adj_ab + p * r * adj_ac + q * r * adj_bc)
    )
    return Form(t1, t2, t3, n0, n1, n2)


def cumulants(form: Form, s: Float[Array, "*c"]) -> tuple[Float[Array, "*c"], Float[Array, "*c"]]:
    """K(s) = log E[e^{sj}] and K′(s) for real s where they exist."""
    z = 2 * s
    d, dd = _denominator(form, z)
    n, dn = _numerator(form, z)
    ratio = n / d
    return -0.5 * jnp.log(d) + s * ratio, -dd / d + ratio + z * (dn - ratio * dd) / d


def _denominator(form: Form, z: Inexact[Array, "*c"]) -> tuple[Inexact[Array, "*c"], Inexact[Array, "*c"]]:
    """D and dD/dz."""
    d = 1 - z * (form.t1 - z * (form.t2 - z * form.t3))
    return d, -form.t1 + z * (2 * form.t2 - 3 * z * form.t3)


def _numerator(form: Form, z: Inexact[Array, "*c"]) -> tuple[Inexact[Array, "*c"], Inexact[Array, "*c"]]:
    """N and dN/dz."""
    return form.n0 + z * (form.n1 + z * form.n2), form.n1 + 2 * z * form.n2


class PartialMoments(NamedTuple):
    """P(j < x) = e^{exponent}·probability and E[j; j < x] = e^{exponent}·moment, or their complements.

    Where `upper` is True the two numbers belong to j > x instead.
    """

    exponent: Float[Array, "*b"]
    probability: Float[Array, "*b"]
    moment: Float[Array, "*b"]
    upper: Array


@jax.custom_jvp
def partial_moments(form: Form, level: Float[Array, "*b"]) -> PartialMoments:
    """Distribution function and partial first moment of j at a level x, by inversion along a steepest-descent contour.

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
    form, level = primals
    contour = _contour(*jax.lax.stop_gradient((form, level)))
    value, (dk, weight, z, inverse) = _invert(form, level, contour)
    crossing, s = contour[:2]
    wide = _widen(form, s.dtype)
    (_, dd), (n, dn) = _denominator(wide, z), _numerator(wide, z)
    # ∂K/∂D and its derivative in z; ∂D/∂(t₁, t₂, t₃) = −z, z², −z³ and ∂N/∂(n₀, n₁, n₂) = 1, z, z².
    pull = -0.5 * inverse * (1 + z * n * inverse)
    slope = 0.5 * inverse**2 * (dd - n - z * dn + 2 * z * n * dd * inverse)
    push, its_slope = 0.5 * z * inverse, 0.5 * inverse * (1 - z * dd * inverse)
    dform, dlevel = tangents
    dwide = _widen(Form(*(t.astype(level.dtype) for t in dform)), s.dtype)
    change_d, rate_d = -z * (dwide.t1 - z * (dwide.t2 - z * dwide.t3)), _denominator(dwide, z)[1]
    change_n, rate_n = _numerator(dwide, z)
    change = pull * change_d + push * change_n
    change_slope = 2 * (slope * change_d + pull * rate_d + its_slope * change_n + push * rate_n)

    dlevel = dlevel.astype(level.dtype)
    dexponent = jax.jvp(lambda f: cumulants(f, crossing)[0], (form,), (dform,))[1] - crossing * dlevel
    shift = s * dlevel[..., None].astype(s.dtype) + dexponent[..., None].astype(s.dtype)
    dprobability = jnp.sum(jnp.imag(weight * (change - shift)), axis=-1)
    dmoment = jnp.sum(jnp.imag(weight * (dk * (change - shift) + change_slope)), axis=-1)
    none: Any = np.zeros(value.upper.shape, jax.dtypes.float0)
    return value, PartialMoments(dexponent, dprobability, dmoment, none)


def _widen(form: Form, dtype) -> Form:
    """Coefficients with an axis for the nodes."""
    return Form(*(coefficient[..., None].astype(dtype) for coefficient in form))


def _invert(form: Form, level: Float[Array, "*b"], contour):
    """The two integrals along a contour, and at its nodes K′, the weights, z and 1/D for their derivatives."""
    crossing, s, ds, upper = contour
    exponent = cumulants(form, crossing)[0] - crossing * level
    wide = _widen(form, s.dtype)
    z = 2 * s
    (d, dd), (n, dn) = _denominator(wide, z), _numerator(wide, z)
    # Complex division and logarithm written out: the library's own guard against overflow that cannot happen here,
    # and the guards have to be compiled.
    square = jnp.real(d) ** 2 + jnp.imag(d) ** 2
    inverse = jnp.conj(d) * (1 / square).astype(d.dtype)
    logarithm = jax.lax.complex(0.5 * jnp.log(square), jnp.arctan2(jnp.imag(d), jnp.real(d)))
    ratio = n * inverse
    k = s * ratio - 0.5 * logarithm
    dk = ratio + inverse * (z * (dn - ratio * dd) - dd)
    shifted = k - s * level[..., None].astype(s.dtype) - exponent[..., None].astype(s.dtype)
    size = jnp.exp(jnp.real(shifted)) / (jnp.real(s) ** 2 + jnp.imag(s) ** 2)
    scale = jnp.where(upper, 1.0, -1.0)[..., None] * (REACH / NODES / np.pi)
    wave = jax.lax.complex(jnp.cos(jnp.imag(shifted)), jnp.sin(jnp.imag(shifted)))
    weight = (scale * size).astype(s.dtype) * wave * ds * jnp.conj(s)
    probability = jnp.sum(jnp.imag(weight), axis=-1)
    moment = jnp.sum(jnp.imag(dk * weight), axis=-1)
    return PartialMoments(exponent, probability, moment, upper), (dk, weight, z, inverse)


def _log_size(
    form: Form, level, exponent, s: Inexact[Array, "*c"], ds: Inexact[Array, "*c"]
) -> Float[Array, "*c"]:
    """log |e^{K(s) − sx − exponent} ds/s| in real arithmetic."""
    wide = _widen(form, s.dtype)
    d, n = _denominator(wide, 2 * s)[0], _numerator(wide, 2 * s)[0]
    square = jnp.real(d) ** 2 + jnp.imag(d) ** 2
    steps = (jnp.real(ds) ** 2 + jnp.imag(ds) ** 2) / (jnp.real(s) ** 2 + jnp.imag(s) ** 2)
    k = jnp.real(s * n * jnp.conj(d)) / square - 0.25 * jnp.log(square)
    return k - jnp.real(s) * level[..., None] - exponent[..., None] + 0.5 * jnp.log(steps)


def _contour(form: Form, level: Float[Array, "*b"]):
    """Where the contour crosses the real axis, its nodes and steps, and whether it is on the upper side.

    Three hyperbolas are tried, one bent to either side and a straight line. All of them give the same integral; the
    one on which the integrand is smallest in absolute value gives it with the smallest error.
    """
    crossing, width, upper = _saddle(form, level)
    exponent = cumulants(form, crossing)[0] - crossing * level
    lowest, highest = (jnp.broadcast_to(end, level.shape) for end in _extreme_eigenvalues(form))
    tiny = jnp.finfo(level.dtype).tiny ** 0.5
    u = jnp.asarray((np.arange(NODES) + 0.5) * (REACH / NODES), level.dtype)
    rise = width[..., None] * jnp.sinh(u)
    slope = width[..., None] * jnp.cosh(u)

    # Leading axis: right, straight, left. A bent path turns no earlier than the circle between the crossing and the
    # singularity at 1/(2λ), inside of which e^K is large.
    ends = jnp.stack([jnp.maximum(highest, tiny), jnp.ones_like(highest), jnp.minimum(lowest, -tiny)])
    tilt = jnp.asarray([TILT, 0.0, -TILT], level.dtype).reshape(3, *(1,) * rise.ndim)
    bend = jnp.maximum(width, 0.5 * TILT * jnp.abs(0.5 / ends - crossing))[..., None]
    arm = jnp.sqrt(bend**2 + rise**2)
    s = jax.lax.complex(crossing[..., None] + tilt * (arm - bend), jnp.broadcast_to(rise, arm.shape))
    ds = jax.lax.complex(tilt * rise / arm * slope, jnp.broadcast_to(slope, arm.shape))
    size = jnp.exp(_log_size(form, level, exponent, s, ds))
    # On a path bent to the wrong side the integrand falls at first, but grows beyond |s| ≈ 1/x: the last node must
    # have died out. On the straight one it never grows, but oscillates: it is for where both others fail.
    size = jnp.sum(size, axis=-1) + UNFINISHED * size[..., -1]
    size = size * jnp.asarray([1.0, STRAIGHT, 1.0], level.dtype).reshape(3, *(1,) * level.ndim)
    best = jnp.argmin(jnp.where(jnp.isfinite(size), size, jnp.inf), axis=0)[None, ..., None]
    s, ds = (jnp.take_along_axis(nodes, best, axis=0)[0] for nodes in (s, ds))
    return crossing, s, ds, upper


def _saddle(form: Form, level: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"], Array]:
    """The saddle point of K(s) − sx on the real axis, its width 1/√K″, and whether it is positive."""
    mean = form.n0 + form.t1
    variance = 4 * form.n1 + 4 * form.t1 * form.n0 + 2 * (form.t1**2 - 2 * form.t2)
    variance = jnp.maximum(variance, jnp.finfo(level.dtype).tiny ** 0.5)
    deviation = jnp.broadcast_to(jnp.sqrt(variance), level.shape)
    upper = level > mean
    sign = jnp.where(upper, 1.0, -1.0)
    start = jnp.log(1e-3 / deviation)
    stop = start + jnp.log(1 + jnp.abs(level - mean) / deviation) + 20.0

    def narrow(_, brackets):
        def halve(bracket, below):
            low, high = bracket
            half = 0.5 * (low + high)
            keep = below(sign * jnp.exp(half))
            return jnp.where(keep, half, low), jnp.where(keep, high, half)

        saddle, end = brackets
        saddle = halve(saddle, lambda s: _is_inside(form, s) & (sign * (cumulants(form, s)[1] - level) < 0))
        return saddle, halve(end, lambda s: _is_inside(form, s))

    saddle, end = jax.lax.fori_loop(0, BISECTIONS, narrow, ((start, stop), (start, stop)))
    # The pole at s = 0 must stay about one width away, and the end of the strip of convergence too.
    nearest = jnp.minimum(1 / deviation, 0.5 * jnp.exp(end[0]))
    crossing = sign * jnp.maximum(jnp.exp(saddle[0]), nearest)
    return crossing, _width(form, crossing), upper


def _extreme_eigenvalues(form: Form) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
    """The smallest (≤ 0) and the largest (≥ 0) eigenvalue of CM, by Viète's formula for three real roots."""
    centre = form.t1 / 3
    spread = jnp.maximum(centre**2 - form.t2 / 3, 0.0)
    skew = centre**3 - form.t1 * form.t2 / 6 + form.t3 / 2
    radius = jnp.sqrt(spread)
    tiny = jnp.finfo(spread.dtype).tiny ** 0.5
    angle = jnp.arccos(jnp.clip(skew / jnp.maximum(radius**3, tiny), -1.0, 1.0)) / 3
    return centre + 2 * radius * jnp.cos(angle + 2 * np.pi / 3), centre + 2 * radius * jnp.cos(angle)


def _is_inside(form: Form, s: Float[Array, "*b"]) -> Array:
    """Whether E[e^{sj}] exists: all three (real) eigenvalues of 1 − 2sCM are positive, by Descartes' rule."""
    z = 2 * s
    first = 3 - z * form.t1
    second = 3 - 2 * z * form.t1 + z**2 * form.t2
    return (first > 0) & (second > 0) & (_denominator(form, z)[0] > 0)


def _width(form: Form, s: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """1/√K″(s)."""
    z = 2 * s
    d, dd = _denominator(form, z)
    ddd = 2 * form.t2 - 6 * z * form.t3
    n, dn, ddn = form.n0 + z * (form.n1 + z * form.n2), form.n1 + 2 * z * form.n2, 2 * form.n2
    p, dp, ddp = z * n / 2, (n + z * dn) / 2, (2 * dn + z * ddn) / 2
    log_part = -0.5 * (ddd / d - (dd / d) ** 2)
    ratio_part = ddp / d - 2 * dp * dd / d**2 - p * ddd / d**2 + 2 * p * dd**2 / d**3
    curvature = 4 * (log_part + ratio_part)
    return 1 / jnp.sqrt(jnp.maximum(curvature, jnp.finfo(s.dtype).tiny ** 0.5))
