"""The Jacobian as a quadratic form in Gaussian variables: its cumulant generating function.

j = xᵀMx with x = (1 + a, 1 + b, c) Gaussian of mean m and covariance C. Everything here depends on C and m only
through the coefficients of two polynomials, so nothing is inverted, decomposed or floored: a singular covariance
is no special case.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Inexact

from .._elementary import inverse_root


class Form(NamedTuple):
    """Coefficients of K(s) = n s − ½ log D(s) + s z Q(s)/D(s), with z = 2s,
    D = 1 − t₁z + t₂z² − t₃z³ and Q = q₁ + q₂z + q₃z².

    t₁, t₂, t₃ are the invariants of CM (trace, second invariant, determinant); n is the Jacobian of the mean strain.
    Keeping n apart makes K(s) − sx accurate where the sea hardly moves j, in a small footprint.
    """

    n: Inexact[Array, "*b"]
    t1: Inexact[Array, "*b"]
    t2: Inexact[Array, "*b"]
    t3: Inexact[Array, "*b"]
    q1: Inexact[Array, "*b"]
    q2: Inexact[Array, "*b"]
    q3: Inexact[Array, "*b"]


def jacobian_form(mean: Float[Array, "*b 3"], covariance: Float[Array, "*b 3 3"]) -> Form:
    """Coefficients for the Jacobian of a strain (a, b, c) of this mean and covariance."""
    p, q, r = 1 + mean[..., 0], 1 + mean[..., 1], mean[..., 2]
    caa, cbb, ccc = covariance[..., 0, 0], covariance[..., 1, 1], covariance[..., 2, 2]
    cab, cac, cbc = covariance[..., 0, 1], covariance[..., 0, 2], covariance[..., 1, 2]
    minor_ac = cab * ccc - cac * cbc
    det = caa * (cbb * ccc - cbc**2) - cab * minor_ac + cac * (cab * cbc - cbb * cac)
    t1 = cab - ccc
    # Second invariant of CM = Σ over pairs of columns of (minors of C)·(minors of M).
    t2 = -0.25 * (caa * cbb - cab**2) - minor_ac
    t3 = 0.25 * det
    n = p * q - r**2
    # y = CMx with Mx = (q/2, p/2, −r); then q₁ = xᵀMy and q₂ = yᵀMy − t₁q₁.
    ya = 0.5 * (caa * q + cab * p) - cac * r
    yb = 0.5 * (cab * q + cbb * p) - cbc * r
    yc = 0.5 * (cac * q + cbc * p) - ccc * r
    q1 = 0.5 * (q * ya + p * yb) - r * yc
    q2 = ya * yb - yc**2 - t1 * q1
    return Form(n, t1, t2, t3, q1, q2, n * t3)


@jax.custom_jvp
def sound_form(mean: Float[Array, "*b 3"], covariance: Float[Array, "*b 3 3"]) -> Form:
    """`jacobian_form` of the nearest sound covariance: as accurate in float32, and never of a negative variance.

    A footprint's covariance is a difference, E[ab] − E[a]E[b], and may have lost its positive eigenvalues to
    rounding. Its variances are raised to a unit in the last place of their sum and its correlations cut to what they
    allow, one after the other (a Cholesky decomposition C = LLᵀ). The invariants of LᵀML are those of CM, but keep
    their sign whatever the rounding. Derivatives are those of `jacobian_form`.
    """
    dtype = covariance.dtype
    p, q, r = 1 + mean[..., 0], 1 + mean[..., 1], mean[..., 2]
    raw = [covariance[..., i, i] for i in range(3)]
    floor = jnp.finfo(dtype).eps * jnp.maximum(raw[0] + raw[1] + raw[2], 0.0) + jnp.finfo(dtype).tiny ** 0.5
    caa, cbb, ccc = (jnp.maximum(variance, 0.0) + floor for variance in raw)
    inverse_a, b, c = inverse_root(caa), cbb * inverse_root(cbb), ccc * inverse_root(ccc)
    laa = caa * inverse_a
    lba = jnp.clip(covariance[..., 0, 1] * inverse_a, -b, b)
    lca = jnp.clip(covariance[..., 0, 2] * inverse_a, -c, c)
    rest_b = jnp.maximum(cbb - lba**2, floor)
    rest_c = jnp.maximum(ccc - lca**2, floor)
    inverse_b, c = inverse_root(rest_b), rest_c * inverse_root(rest_c)
    lbb = rest_b * inverse_b
    lcb = jnp.clip((covariance[..., 1, 2] - lba * lca) * inverse_b, -c, c)
    rest = jnp.maximum(rest_c - lcb**2, 0.001 * floor)
    lcc = rest * inverse_root(rest)

    # R = LᵀML and g = LᵀMx.
    raa, rab, rac = laa * lba - lca**2, 0.5 * laa * lbb - lca * lcb, -lca * lcc
    rbb, rbc, rcc = -(lcb**2), -lcb * lcc, -rest
    ga = 0.5 * (laa * q + lba * p) - lca * r
    gb, gc = 0.5 * lbb * p - lcb * r, -lcc * r
    t1 = raa + rbb + rcc
    t2 = raa * (rbb + rcc) - rab**2 - rac**2  # the third minor, rbb·rcc − rbc², is zero
    t3 = 0.25 * (laa * lbb * lcc) ** 2
    n = p * q - r**2
    q1 = ga**2 + gb**2 + gc**2
    along = ga * (raa * ga + 2 * (rab * gb + rac * gc)) + gb * (rbb * gb + 2 * rbc * gc) + rcc * gc**2
    return Form(n, t1, t2, t3, q1, along - t1 * q1, n * t3)


@sound_form.defjvp
def _sound_form_jvp(primals, tangents):
    return sound_form(*primals), jax.jvp(jacobian_form, primals, tangents)[1]


def moments(form: Form) -> tuple[Inexact[Array, "*b"], Inexact[Array, "*b"]]:
    """Mean and variance of j: K′(0) and K″(0)."""
    return form.n + form.t1, 4 * form.q1 + 2 * (form.t1**2 - 2 * form.t2)


def denominator(form: Form, z: Inexact[Array, "*c"]) -> tuple[Inexact[Array, "*c"], Inexact[Array, "*c"]]:
    """D and dD/dz."""
    d = 1 - z * (form.t1 - z * (form.t2 - z * form.t3))
    return d, -form.t1 + z * (2 * form.t2 - 3 * z * form.t3)


def numerator(form: Form, z: Inexact[Array, "*c"]) -> tuple[Inexact[Array, "*c"], Inexact[Array, "*c"]]:
    """Q and dQ/dz."""
    return form.q1 + z * (form.q2 + z * form.q3), form.q2 + 2 * z * form.q3


def excess(form: Form, s: Float[Array, "*c"], level: Float[Array, "*b"]) -> Float[Array, "*c"]:
    """K(s) − sx for real s where it exists."""
    z = 2 * s
    d, q = denominator(form, z)[0], numerator(form, z)[0]
    return s * (form.n - level) - 0.5 * jnp.log(d) + s * z * q / d


def steepness(form: Form, s: Float[Array, "*c"], level: Float[Array, "*b"]) -> Float[Array, "*c"]:
    """K′(s) − x for real s where it exists."""
    z = 2 * s
    (d, dd), (q, dq) = denominator(form, z), numerator(form, z)
    return form.n - level + (z * (2 * q + z * dq) - dd - z**2 * q * dd / d) / d


def curvature(form: Form, s: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """K″(s) for real s where it exists."""
    z = 2 * s
    (d, dd), (q, dq) = denominator(form, z), numerator(form, z)
    ddd, ddq = 2 * form.t2 - 6 * z * form.t3, 2 * form.q3
    p, dp, ddp = 0.5 * z**2 * q, z * q + 0.5 * z**2 * dq, q + 2 * z * dq + 0.5 * z**2 * ddq
    fall = dd / d
    return 4 * (0.5 * fall**2 - 0.5 * ddd / d + (ddp - 2 * dp * fall - p * ddd / d + 2 * p * fall**2) / d)


def exists(form: Form, s: Float[Array, "*b"]) -> Array:
    """Whether E[e^{sj}] exists: all three (real) eigenvalues of 1 − 2sCM are positive, by Descartes' rule."""
    z = 2 * s
    first = 3 - z * form.t1
    second = 3 - 2 * z * form.t1 + z**2 * form.t2
    return (first > 0) & (second > 0) & (denominator(form, z)[0] > 0)


def extreme_eigenvalues(form: Form) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
    """The smallest (≤ 0) and the largest (≥ 0) eigenvalue of CM, by Viète's formula for three real roots."""
    centre = form.t1 / 3
    spread = jnp.maximum(centre**2 - form.t2 / 3, 0.0)
    skew = centre**3 - form.t1 * form.t2 / 6 + form.t3 / 2
    radius = jnp.sqrt(spread)
    tiny = jnp.finfo(spread.dtype).tiny ** 0.5
    angle = jnp.arccos(jnp.clip(skew / jnp.maximum(radius**3, tiny), -1.0, 1.0)) / 3
    return centre + 2 * radius * jnp.cos(angle + 2 * np.pi / 3), centre + 2 * radius * jnp.cos(angle)
