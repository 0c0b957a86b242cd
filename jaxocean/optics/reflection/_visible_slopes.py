"""The slopes that a viewer sees in a footprint, as a few slopes with weights."""

import abc
from typing import ClassVar, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._elementary import inverse_root, reciprocal
from ._facing import SMOOTH, Facing, facing, normal_density

# Nodes t of ThreeSlopes as polynomials of r = Φ/(zΦ + φ), z = μ/s: a fit to the nodes of the three-point Gauss rule
# for the weight max(z + t, 0) φ(t), within 0.02 for all z ≥ 0. The weights below are exact for whatever nodes.
STEEPEST = (-1.72632, 0.5632, 4.77161, -5.18718, 1.73464)
MIDDLE = (0.00317, 0.78296, 1.83015, -2.04654, 0.6927)
FLATTEST = (1.73532, 0.80623, 0.70014, -0.8918, 0.31525)

ZENITH = 1e-4
"""Sine of the angle from the zenith within which a view has no azimuth."""

TAIL = 5.5
"""How many standard deviations of the facing area a quadrature over slopes spans."""


class SlopeNode(NamedTuple):
    """A slope (x, y), its weight w (all nodes' add up to 1) and the cosine c of the view's incidence, each (*b).

    `step` says how many standard deviations the facing area is above its mean; `loose` is the mean squared slope
    about the node that no node resolves.
    """

    step: Float[Array, "*b"]
    x: Float[Array, "*b"]
    y: Float[Array, "*b"]
    weight: Float[Array, "*b"]
    cosine: Float[Array, "*b"]
    loose: Float[Array, "*b"]


class AbstractVisibleSlopes(eqx.Module):
    """A rule for means over the slopes ζ that a viewer sees: weighted by their density and their projected area.

    $$ \\overline{f} = \\frac{\\int f(ζ)\\, q_+\\, p(ζ)\\, dζ}{\\int q_+\\, p(ζ)\\, dζ}, \\quad
    q = V_z - ζ·V_{xy} $$

    Smith's masking hides all facets that face the viewer alike, and so drops out.
    """

    @abc.abstractmethod
    def nodes(
        self, to_viewer: Float[Array, "*b 3"], slope: Float[Array, "*b 2"], covariance: Float[Array, "*b 2 2"]
    ) -> tuple[SlopeNode, ...]:
        """Nodes for the view `to_viewer` of slopes with mean `slope` and `covariance`."""


class ThreeSlopes(AbstractVisibleSlopes):
    """Three slopes along the view's azimuth; across it the slopes' variance only lengthens the normal.

    The rule is exact for polynomials in q of degree 2 and nearly so up to degree 5.
    """

    def nodes(
        self, to_viewer: Float[Array, "*b 3"], slope: Float[Array, "*b 2"], covariance: Float[Array, "*b 2 2"]
    ) -> tuple[SlopeNode, ...]:
        seen = facing(to_viewer, slope, covariance)
        # A quotient of the library, which XLA writes to memory: all nodes are polynomials of it.
        shift = seen.below * seen.deviation / seen.area
        a, b, c = (_polynomial(shift, row) for row in (STEEPEST, MIDDLE, FLATTEST))
        # Weights that give the three moments of t: 1, r and 2 − z r.
        square = 2.0 - seen.ratio * shift
        common = reciprocal((b - a) * (c - a) * (c - b))
        weights = (
            (square - (b + c) * shift + b * c) * (c - b) * common,
            ((a + c) * shift - square - a * c) * (c - a) * common,
            (square - (a + b) * shift + a * b) * (b - a) * common,
        )
        xx, yy, _ = _remaining(covariance, seen)
        loose = jnp.maximum(xx + yy, 0.0)
        return tuple(
            _node(seen, t, weight, slope, loose) for t, weight in zip((a, b, c), weights, strict=True)
        )


THREE_SLOPES = ThreeSlopes()


class SlopeQuadrature(AbstractVisibleSlopes):
    """Gauss–Legendre along the view's azimuth times Gauss–Hermite across it: the reference, and slow.

    **Arguments:** `along`, `across`: numbers of nodes, at least 1.

    **Raises:** `ValueError` for fewer than one node.
    """

    along: int = eqx.field(static=True, default=12)
    across: int = eqx.field(static=True, default=3)

    least: ClassVar[int] = 1

    def __check_init__(self) -> None:
        for name, count in (("along", self.along), ("across", self.across)):
            if count < self.least:
                raise ValueError(f"Argument `{name}` must be at least {self.least}, but is {count}.")

    def nodes(
        self, to_viewer: Float[Array, "*b 3"], slope: Float[Array, "*b 2"], covariance: Float[Array, "*b 2 2"]
    ) -> tuple[SlopeNode, ...]:
        # From the zenith no azimuth is along the view: any will do.
        flat = jnp.sum(to_viewer[..., :2] ** 2, axis=-1, keepdims=True) < ZENITH**2
        sideways = jnp.asarray([ZENITH, 0.0, 0.0], to_viewer.dtype)
        to_viewer = jnp.where(flat, to_viewer + sideways, to_viewer)
        seen = facing(to_viewer, slope, covariance)
        across, loose = self._across(to_viewer, covariance, seen)
        lowest = jnp.maximum(-seen.ratio, -TAIL)
        steps = [
            (float(x), float(w)) for x, w in zip(*np.polynomial.legendre.leggauss(self.along), strict=True)
        ]
        along = [lowest + 0.5 * (x + 1.0) * (TAIL - lowest) for x, _ in steps]
        weights = [w * (seen.ratio + t) * normal_density(t) for t, (_, w) in zip(along, steps, strict=True)]
        whole = sum(weights[1:], start=weights[0])
        heights, shares = np.polynomial.hermite_e.hermegauss(self.across)
        return tuple(
            _node(seen, t, weight / whole * float(share), slope, loose, float(h), across)
            for t, weight in zip(along, weights, strict=True)
            for h, share in zip(heights, shares / np.sum(shares), strict=True)
        )

    def _across(self, to_viewer: Array, covariance: Array, seen: Facing) -> tuple[tuple[Array, Array], Array]:
        """One standard deviation of the slope across the view, and the squared slope that it leaves out."""
        xx, yy, xy = _remaining(covariance, seen)
        x, y = to_viewer[..., 0], to_viewer[..., 1]
        inverse = jax.lax.rsqrt(x * x + y * y)
        x, y = -y * inverse, x * inverse
        variance = jnp.maximum(xx * x * x + 2.0 * xy * x * y + yy * y * y, 0.0)
        whole = jnp.maximum(xx + yy, 0.0)
        if self.across == 1:
            return (jnp.zeros_like(x), jnp.zeros_like(x)), whole
        deviation = jnp.sqrt(variance + SMOOTH)
        return (deviation * x, deviation * y), jnp.maximum(whole - variance, 0.0)


def _node(
    seen: Facing,
    t: Array,
    weight: Array,
    slope: Array,
    loose: Array,
    h: float = 0.0,
    across: tuple[Array, Array] | None = None,
) -> SlopeNode:
    """The node at t standard deviations of the facing area and h of the slope across the view."""
    x, y = slope[..., 0] - t * seen.turn[0], slope[..., 1] - t * seen.turn[1]
    if across is not None:
        x, y = x + h * across[0], y + h * across[1]
    cosine = (seen.mean + t * seen.deviation) * inverse_root(1.0 + x * x + y * y + loose)
    return SlopeNode(t, x, y, weight, cosine, loose)


def _remaining(covariance: Array, seen: Facing) -> tuple[Array, Array, Array]:
    """Covariance (xx, yy, xy) of the slopes that share one facing area."""
    x, y = seen.turn
    xy = 0.5 * (covariance[..., 0, 1] + covariance[..., 1, 0])
    return covariance[..., 0, 0] - x * x, covariance[..., 1, 1] - y * y, xy - x * y


def _polynomial(x: Float[Array, "*b"], coefficients: tuple[float, ...]) -> Float[Array, "*b"]:
    value = jnp.full_like(x, coefficients[-1])
    for each in coefficients[-2::-1]:
        value = value * x + each
    return value
