"""How much of the facets in one footprint a direction sees."""

import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._elementary import exponential, inverse_root, once, reciprocal

GRAZING = 1e-3
"""Least projected area [-] of the mean facet. A pixel's mean facet may be turned away although some of it is seen."""

SMOOTH = 1e-12
"""Variance [-] that is added to what turns facets, so that roots have derivatives at a flat sea and at the zenith."""


class Facing(NamedTuple):
    """The projected area q = d_z − ζ·d_xy [-] of a facet with slope ζ, per horizontal area, towards a direction d.

    Over the slopes of a footprint q is Gaussian. `mean` μ is that of the mean facet, at least `GRAZING`; `deviation` s
    its standard deviation; `ratio` μ/s; `turn` the covariance of slope and q divided by −s: facets whose q is t s
    above its mean have slopes that lie `turn`·t below theirs; `below` Φ(μ/s), the share of facets that face d;
    `area` E[max(q, 0)], what d would see of all facets if none hid another.
    """

    mean: Float[Array, "*b"]
    deviation: Float[Array, "*b"]
    ratio: Float[Array, "*b"]
    turn: tuple[Float[Array, "*b"], Float[Array, "*b"]]
    below: Float[Array, "*b"]
    area: Float[Array, "*b"]

    @property
    def hidden(self) -> Float[Array, "*b"]:
        """Λ, see `smith_lambda`."""
        return self.area * reciprocal(self.mean) - 1.0


def facing(
    direction: Float[Array, "*b 3"], slope: Float[Array, "*b 2"], covariance: Float[Array, "*b 2 2"]
) -> Facing:
    """See `Facing`."""
    x, y, z = direction[..., 0], direction[..., 1], direction[..., 2]
    xy = 0.5 * (covariance[..., 0, 1] + covariance[..., 1, 0])
    across_x = covariance[..., 0, 0] * x + xy * y
    across_y = xy * x + covariance[..., 1, 1] * y
    variance = jnp.maximum(x * across_x + y * across_y, 0.0) + SMOOTH
    mean = jnp.maximum(z - slope[..., 0] * x - slope[..., 1] * y, GRAZING)
    # Many programs read what follows.
    inverse = once(inverse_root(variance))
    deviation = variance * inverse
    ratio = mean * inverse
    density = normal_density(ratio)
    below = once(_below(ratio, density))
    area = once(mean * below + deviation * density)
    return Facing(mean, deviation, ratio, (across_x * inverse, across_y * inverse), below, area)


def normal_density(x: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """φ(x) of the standard normal."""
    return exponential(-0.5 * x * x) * (1.0 / math.sqrt(2.0 * math.pi))


def _below(x: Float[Array, "*b"], density: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """Φ(x) for x ≥ 0 from φ(x); in float32 to 2e-7, by Abramowitz & Stegun 1964, formula 7.1.26."""
    if x.dtype != jnp.float32:
        return 0.5 + 0.5 * jax.lax.erf(x * math.sqrt(0.5))
    t = reciprocal(1.0 + 0.3275911 * math.sqrt(0.5) * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))))
    return 1.0 - math.sqrt(0.5 * math.pi) * density * tail


def smith_lambda(cos_zenith: Float[Array, "*b"], variance: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """Smith's Λ: the facets that turn away from a direction and those that are hidden by others, per visible area.

    $$ Λ = \\frac{e^{-v²} - v \\sqrt{π}\\, \\mathrm{erfc}\\, v}{2 v \\sqrt{π}}, \\quad
    v = \\frac{\\cos θ}{\\sin θ \\sqrt{2σ²}} $$

    On a plane without mean slope a direction sees the fraction 1/(1 + Λ) of the facets that face it. Λ is 0 for
    v → ∞ and grows like 1/v towards the horizon, where cosθ is held at 0.001.

    **Arguments:** `cos_zenith` cosθ, (*b); `variance` σ² of the slope along the direction's azimuth, (*b).

    **Returns:** Λ [-], at least 0.

    **Source:** Smith 1967, IEEE Trans. Antennas Propag. 15; Ross, Dion & Potvin 2005, eq. 14.
    """
    cos_zenith = jnp.clip(cos_zenith, GRAZING, 1.0)
    spread = jnp.maximum(variance * (1.0 - cos_zenith * cos_zenith), 0.0) + SMOOTH
    ratio = cos_zenith * jax.lax.rsqrt(spread)
    tail = 0.5 * jax.lax.erfc(ratio * math.sqrt(0.5))
    return jnp.maximum(normal_density(ratio) / ratio - tail, 0.0)
