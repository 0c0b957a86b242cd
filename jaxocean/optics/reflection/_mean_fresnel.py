"""What a rough sea reflects, averaged over the facets that a viewer sees."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import safe_sqrt
from ._fresnel import AbstractFresnel, ExactFresnel
from ._visible_slopes import THREE_SLOPES, AbstractVisibleSlopes


def mean_fresnel(
    to_viewer: Float[Array, "*b 3"],
    slope: Float[Array, "*b 2"],
    covariance: Float[Array, "*b 2 2"],
    fresnel: AbstractFresnel | None = None,
    visible: AbstractVisibleSlopes = THREE_SLOPES,
) -> Float[Array, "*b"]:
    """Mean reflectance of the facets in a footprint, weighted by how much of each the viewer sees.

    $$ \\overline{F} = \\frac{\\int F(ω)\\, q_+\\, p(ζ)\\, dζ}{\\int q_+\\, p(ζ)\\, dζ}, \\quad
    q = V_z - ζ·V_{xy}, \\quad \\cos ω = \\frac{q}{\\sqrt{1 + |ζ|²}} $$

    At zero variance it is the reflectance of the mean facet.

    **Arguments:** `to_viewer` V, unit vectors (*b, 3); `slope` and `covariance`: mean (*b, 2) and covariance
    (*b, 2, 2) of the slopes in the footprint; `fresnel`: reflectance of one facet, `ExactFresnel()`
    by default; `visible`: the rule for the mean.

    **Returns:** the mean reflectance, (*b).

    **Source:** the weights of Ross, Dion & Potvin 2005 and Heitz 2014; docs/optics.md has the rules' errors.
    """
    fresnel = ExactFresnel() if fresnel is None else fresnel
    nodes = visible.nodes(to_viewer, slope, covariance)
    parts = [node.weight * fresnel(node.cosine) for node in nodes]
    return sum(parts[1:], start=parts[0])


def bruneton_mean_fresnel(cos_view: Float[Array, "*b"], variance: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """Bruneton's fit to the mean reflectance of a rough sea.

    $$ \\overline{F} = 0.02 + 0.98 \\frac{(1 - \\cos θ_V)^{5 \\exp(-2.69 σ)}}{1 + 22.7 σ^{1.5}} $$

    At small σ it is Schlick's polynomial and not Fresnel's equations.

    **Arguments:** `cos_view` cosθ_V of the angle to the mean facet's normal, (*b); `variance` σ² of the slope along
    the view's azimuth, (*b).

    **Returns:** the mean reflectance, (*b).

    **Source:** Bruneton, Neyret & Holzschuch 2010, Comput. Graph. Forum 29, §4.
    """
    away = 1.0 - jnp.clip(cos_view, 0.0, 1.0)
    deviation = safe_sqrt(variance)
    # Log and exponential by hand: 0 to a power that is not whole has no derivative.
    somewhere = away > 0.0
    logarithm = jnp.log(jnp.where(somewhere, away, 1.0))
    power = jnp.where(somewhere, jnp.exp(5.0 * jnp.exp(-2.69 * deviation) * logarithm), 0.0)
    return 0.02 + 0.98 * power / (1.0 + 22.7 * deviation * safe_sqrt(deviation))
