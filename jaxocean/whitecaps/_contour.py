"""The two contour integrals of the fast closure, and their derivatives as sums over the same nodes."""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._elementary import exponential, inverse_root, reciprocal
from ..surface.fft._apart import compute_apart
from ..surface.fft._sincos import sincos_turns
from ._quadratic_form import Form

TILT = 0.5
"""Slope of the contour's asymptotes."""

TRIAL = float(np.sinh(2.5))
"""Where both sides are tried, in widths of the saddle."""

ROUND = 3.0
"""Least radius of the bend, in widths of the saddle, of a contour bent against its curvature at the saddle."""

STRAIGHT = 300.0
"""Radius of a bend that counts as none."""

GONE = -8.0
"""log of the integrand where the contour ends."""

STRIP_STEPS, SADDLE_STEPS = 2, 2


class _Path(NamedTuple):
    """The contour through t = `start` on the real axis, and D and t²Q/D around there (see `_taylor`)."""

    start: Float[Array, "*b"]
    d: Float[Array, "*b"]
    ds: tuple[Float[Array, "*b"], ...]
    ps: tuple[Float[Array, "*b"], ...]
    width: Float[Array, "*b"]
    bend: Float[Array, "*b"]
    tilt: Float[Array, "*b"]
    gap: Float[Array, "*b"]


class _Node(NamedTuple):
    """One node of it, complex numbers as pairs.

    **Arguments:** `t`; `weight`: e^{K − tx} dt/t; `ratio`: D over its value at the start; `inverse`: 1/|ratio|;
    `lift`: t²Q/D; `alive`: whether the integrand has not yet vanished on the way here.
    """

    t: tuple[Float[Array, "*b"], Float[Array, "*b"]]
    weight: tuple[Float[Array, "*b"], Float[Array, "*b"]]
    ratio: tuple[Float[Array, "*b"], Float[Array, "*b"]]
    inverse: Float[Array, "*b"]
    lift: tuple[Float[Array, "*b"], Float[Array, "*b"]]
    alive: Bool[Array, "*b"]


def integrate(
    form: Form, gap: Float[Array, "*b"], distance: Float[Array, "*b"], sign: Float[Array, "*b"], nodes: int
) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
    """(1/2πi)∫ e^{K − tx} dt/t and the same with 1/t², both positive.

    **Arguments:** `form` in t, of j with the deviation 1; `gap` n − x and `distance` E[j] − x in that deviation; `sign`
    of the t where the contour crosses the real axis; `nodes` on it.
    """
    size = _saddle(jax.lax.stop_gradient(form), *jax.lax.stop_gradient((gap, distance)), sign)
    return _integrals(nodes, form, gap, sign, size)


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def _integrals(nodes: int, form: Form, gap, sign, size) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
    path = _path(form, gap, sign, size)
    probability = excess = jnp.zeros_like(gap)
    alive = jnp.ones_like(gap, bool)
    for rise, share in zip(*_nodes(nodes), strict=True):
        node = _node(path, float(rise), float(share), alive)
        alive = node.alive
        probability = probability + node.weight[0]
        excess = excess + _over(node.weight, node.t)[0]
    scale = path.width * inverse_root(jnp.maximum(path.d, 1e-12))
    return sign * scale * probability, scale * excess


@_integrals.defjvp
def _integrals_jvp(nodes, primals, tangents):
    """Linear in the tangents with all coefficients computed: reverse mode then costs what forward mode costs."""
    form, gap, sign, size = primals
    dform, dgap = tangents[:2]
    probability, excess, density, by_d, by_q = compute_apart(
        lambda: _sums(nodes, form, gap, sign, size), jnp.any(size >= 0)
    )
    coefficients = dform.t1, -dform.t2, dform.t3, dform.q1, dform.q2, dform.q3

    def along(sums, start):
        return sum((s * c for s, c in zip(sums, coefficients, strict=True)), start=start * dgap)

    # D acts through −½ log D + t²Q/D, and what has 1/t² in the place of 1/t lags behind by one power.
    slope = sign * along((*by_d[1:], *by_q[1:]), density)
    return (probability, excess), (slope, along((*by_d[:3], *by_q[:3]), sign * probability))


def _sums(nodes: int, form: Form, gap, sign, size):
    """Both integrals, and those with further factors: t; t^m (½ + t²Q/D)/D, m = 0 to 3; t^m/D, m = 1 to 4."""
    path = _path(form, gap, sign, size)
    inverse_start = reciprocal(jnp.maximum(path.d, 1e-12))
    rises, shares = (jnp.asarray(table, gap.dtype) for table in _nodes(nodes))

    def step(number, state):
        alive, sums = state

        def factors():
            node = _node(path, rises[number], shares[number], alive)
            square = node.inverse * node.inverse * inverse_start
            inverse = node.ratio[0] * square, -node.ratio[1] * square
            one = _times(node.weight, inverse)
            lift = 0.5 + node.lift[0], node.lift[1]
            return node.t, node.weight, node.alive, _times(one, lift), _times(one, node.t)

        t, weight, alive, by_d, by_q = compute_apart(factors, number >= 0)
        new = [weight[0], _over(weight, t)[0], _times(weight, t)[0]]
        for factor in (by_d, by_q):
            for _ in range(4):
                new.append(factor[0])
                factor = _times(factor, t)
        return alive, tuple(old + n for old, n in zip(sums, new, strict=True))

    start = jnp.ones_like(gap, bool), (jnp.zeros_like(gap),) * 11
    sums = jax.lax.fori_loop(0, nodes, step, start)[1]
    scale = path.width * inverse_root(jnp.maximum(path.d, 1e-12))
    probability, excess, density, *others = (scale * each for each in sums)
    return sign * probability, excess, density, tuple(others[:4]), tuple(others[4:])


def _nodes(count: int) -> tuple[Float[np.ndarray, " count"], Float[np.ndarray, " count"]]:
    """Im t in widths of the saddle at the nodes of the trapezoidal rule, and their weights."""
    spacing = (2.2 + 0.2 * count) / count
    u = (np.arange(count) + 0.5) * spacing
    return np.sinh(u), np.cosh(u) * spacing / np.pi


def _times(a, b):
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _over(a, t):
    inverse = reciprocal(t[0] * t[0] + t[1] * t[1])
    return (a[0] * t[0] + a[1] * t[1]) * inverse, (a[1] * t[0] - a[0] * t[1]) * inverse


def _taylor(form: Form, t: Float[Array, "*b"]):
    """D(t), and around t the coefficients of D/D(t) from its first, of t²Q/D(t) from its zeroth power."""
    _, t1, t2, t3, q1, q2, q3 = form
    d = 1 - t * (t1 - t * (t2 - t * t3))
    i = reciprocal(jnp.maximum(d, 1e-12))
    ds = ((t * (2 * t2 - 3 * t * t3) - t1) * i, (t2 - 3 * t * t3) * i, -t3 * i)
    ps = (
        t * t * (q1 + t * (q2 + t * q3)) * i,
        t * (2 * q1 + t * (3 * q2 + 4 * t * q3)) * i,
        (q1 + t * (3 * q2 + 6 * t * q3)) * i,
        (q2 + 4 * t * q3) * i,
        q3 * i,
    )
    return d, ds, ps


def _derivatives(gap, sign, size, ds, ps):
    """The first three derivatives of K − tx − log|t| at t = sign·size."""
    (d1, d2, d3), (p0, p1, p2, p3, _) = ds, ps
    r1 = p1 - p0 * d1
    r2 = p2 - p0 * d2 - r1 * d1
    r3 = p3 - p0 * d3 - r1 * d2 - r2 * d1
    inverse = sign * reciprocal(size)
    square = inverse * inverse
    first = gap - 0.5 * d1 + r1 - inverse
    second = jnp.maximum(2 * r2 - d2 + 0.5 * d1 * d1, 0.0) + square
    third = 6 * r3 - 3 * d3 + d1 * (3 * d2 - d1 * d1) - 2 * square * inverse
    return first, second, third


def _saddle(form: Form, gap, distance, sign) -> Float[Array, "*b"]:
    """|t| at the saddle point of K − tx − log|t|, nearly."""
    # The widest eigenvalue on this side bounds |t|: Newton's rule from above, which never passes a root.
    t1, t2, t3 = sign * form.t1, form.t2, sign * form.t3
    square = jnp.maximum(t1 * t1 - 2 * t2, 1e-12)
    widest = square * inverse_root(square)
    for _ in range(STRIP_STEPS):
        rest = jnp.maximum(((widest - t1) * widest + t2) * widest - t3, 0.0)
        slope = jnp.maximum((3 * widest - 2 * t1) * widest + t2, 1e-6)
        widest = jnp.maximum(widest - rest * reciprocal(slope), 1e-6)
    end = reciprocal(widest)

    # Where the saddle would be if j were Gaussian.
    distance = jnp.abs(distance)
    square = distance * distance + 4
    size = jnp.minimum(0.5 * (distance + square * inverse_root(square)), 0.8 * end)
    for _ in range(SADDLE_STEPS):
        _, ds, ps = _taylor(form, sign * size)
        first, second, third = _derivatives(gap, sign, size, ds, ps)
        bent = jnp.maximum(second * second - 0.5 * first * third, 0.5 * second * second)
        moved = size - sign * first * second * reciprocal(bent)
        size = jnp.clip(moved, 0.3 * size, jnp.minimum(3 * size, size + 0.7 * (0.95 * end - size)))
    return jax.lax.stop_gradient(size)


def _path(form: Form, gap, sign, size) -> _Path:
    start = sign * size
    d, ds, ps = _taylor(form, start)
    return _Path(start, d, ds, ps, *_bend(ds, ps, gap, sign, size), gap)


def _node(path: _Path, height, share, alive) -> _Node:
    """The node at Im t = height·width, whose weight in the trapezoidal rule is `share`."""
    rise = height * path.width
    square = path.bend * path.bend + rise * rise
    inverse = inverse_root(square)
    x, lean = path.tilt * (square * inverse - path.bend), path.tilt * rise * inverse
    dr, di, er, ei, inverse_d = _change(path.ds, path.ps)(x, rise, path.gap)
    alive = alive & (er > GONE)
    exponent = er + path.start * path.gap + path.ps[0]
    strength = jnp.where(alive, exponential(jnp.minimum(exponent, 20.0)), 0.0) * inverse_d
    # √D without a cut: on a path to the left two eigenvalues may turn D by more than a half circle.
    half = 0.5 * ((dr * dr + di * di) * inverse_d + jnp.abs(dr))
    inverse_half = inverse_root(half)
    large, small = half * inverse_half, 0.5 * di * inverse_half
    left = path.tilt < 0
    root_r = jnp.where(dr >= 0, large, jnp.where(left, small, jnp.abs(small)))
    root_i = jnp.where(dr >= 0, small, jnp.where(left | (di >= 0), large, -large))
    turns = ei * (0.5 / np.pi)
    sine, cosine = sincos_turns(turns - jnp.floor(turns + 0.5))
    wave_r, wave_i = cosine * root_r + sine * root_i, sine * root_r - cosine * root_i
    # times ds/du = i(1 − i·lean)·|ds/du|
    strength = strength * share
    wave = strength * (wave_r + lean * wave_i), strength * (wave_i - lean * wave_r)
    t = path.start + x, rise
    # Without what is linear in t of the exponent: t²Q/D itself.
    lift = path.ps[0] + er - x * path.gap, ei - rise * path.gap
    return _Node(t, _over(wave, t), (dr, di), inverse_d, lift, alive)


def _bend(ds, ps, gap, sign, size):
    """Width of the saddle, radius of the contour's bend and slope of its asymptotes."""
    _, second, third = _derivatives(gap, sign, size, ds, ps)
    width = inverse_root(second)
    bend = jnp.minimum(3 * TILT * second * reciprocal(jnp.abs(third) + 1e-12), STRAIGHT * width)
    rise = TRIAL * width
    square = bend * bend + rise * rise
    aside = TILT * (square * inverse_root(square) - bend)
    change = _change(ds, ps)
    right_r, right_i, right, _, _ = change(aside, rise, gap)
    left_r, left_i, left, _, _ = change(-aside, rise, gap)
    gain = exponential(4 * jnp.clip(right - left, -15.0, 15.0))
    to_right = gain * (left_r**2 + left_i**2) < right_r**2 + right_i**2
    bend = jnp.where(to_right == (third > 0), bend, jnp.maximum(bend, ROUND * width))
    tilt = jnp.where(to_right, TILT, -TILT).astype(gap.dtype)
    return jax.lax.stop_gradient((width, bend, tilt))


def _change(ds, ps):
    """At a distance x + iy from the saddle: D relative to its value there, the change of t·gap + t²Q/D, and 1/|D|."""
    (d1, d2, d3), (p0, p1, p2, p3, p4) = ds, ps
    n1, n2, n3 = p1 - p0 * d1, p2 - p0 * d2, p3 - p0 * d3

    def at(x, y, gap):
        x2, y2 = x * x - y * y, 2 * x * y
        x3, y3 = x2 * x - y2 * y, x2 * y + y2 * x
        dr, di = 1 + d1 * x + d2 * x2 + d3 * x3, d1 * y + d2 * y2 + d3 * y3
        ar, ai = n1 + n2 * x + n3 * x2 + p4 * x3, n2 * y + n3 * y2 + p4 * y3
        nr, ni = ar * x - ai * y, ar * y + ai * x
        inverse = inverse_root(dr * dr + di * di)
        square = inverse * inverse
        return dr, di, (nr * dr + ni * di) * square + x * gap, (ni * dr - nr * di) * square + y * gap, inverse

    return at
