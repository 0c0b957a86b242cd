"""Sun glitter: the facets in a footprint that mirror the sun's disc."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._elementary import inverse_root, reciprocal
from ._facing import facing
from ._fresnel import AbstractFresnel, ExactFresnel
from ._masking import HEIGHT_CORRELATED, AbstractMasking
from ._slopes import bivariate_normal

SUN_VARIANCE = 5.47e-6
"""Variance [rad²] of directions within the sun's disc along each axis: a quarter of its squared radius, 4.676 mrad."""

RISE = 1e-3
"""Cosine [-] of the sun on the mean facet below which its light fades out: there the facets' shadow is unbounded."""

BRIGHTEST = 1.05 / (2.0 * math.pi * SUN_VARIANCE)
"""Radiance of the disc per irradiance [1/sr] at its middle, and a little more: no mirror shows more than that."""

UPRIGHT = 1e-3
"""Least height [-] of V + L: facets that would be steeper than its inverse mirror nothing."""


def sun_glitter(
    to_viewer: Float[Array, "*b 3"],
    to_sun: Float[Array, "*#b 3"],
    slope: Float[Array, "*b 2"],
    covariance: Float[Array, "*b 2 2"],
    fresnel: AbstractFresnel | None = None,
    masking: AbstractMasking = HEIGHT_CORRELATED,
) -> Float[Array, "*b"]:
    """Radiance of the reflected sun per irradiance of its beam.

    $$ \\frac{L}{E} = \\frac{F(V·H)\\, p(ζ_H)}{4 H_z^4\\, (V_z - m·V_{xy})}\\, G $$

    with the half vector H = (V + L)/|V + L|, its slope ζ_H = −H_xy/H_z, the density p of slopes with the mean m of
    the footprint and the masking G. V_z − m·V_xy is the projected area of the mean facet; without mean slope it is
    cosθ_V. The slopes are widened by those that mirror the rest of the sun's disc (1.4e-6 along the view, more across
    it at grazing angles), a Gaussian of the same variance: a flat sea shows the sun twice as bright as it is, and as
    much smaller. Light that is reflected twice is left out.

    **Arguments:** `to_viewer` V, unit vectors (*b, 3); `to_sun` L, a unit vector (3,) or (*b, 3); `slope` m and
    `covariance`: mean (*b, 2) and covariance (*b, 2, 2) of the slopes in the footprint;
    `fresnel`: reflectance of a facet, `ExactFresnel()` by default; `masking`: how masking and shadowing go together.

    **Returns:** L/E [1/sr], (*b); 0 where the sun is below the mean facet.

    **Source:** Ross, Dion & Potvin 2005, eq. 36; Bruneton, Neyret & Holzschuch 2010, §4.
    """
    fresnel = ExactFresnel() if fresnel is None else fresnel
    sun = to_sun.astype(to_viewer.dtype)
    seen = facing(to_viewer, slope, covariance)
    lit = facing(jnp.broadcast_to(sun, to_viewer.shape), slope, covariance)
    hx, hy, hz = (to_viewer[..., i] + sun[..., i] for i in range(3))
    up = hz > UPRIGHT
    inverse = reciprocal(jnp.where(up, hz, 1.0))
    square = hx * hx + hy * hy + hz * hz
    # The slope that mirrors L moves with L by −(dL_xy + ζ_H dL_z)/(V + L)_z; dL has the covariance I − L Lᵀ.
    zx, zy = -hx * inverse, -hy * inverse
    wx, wy = sun[..., 0] + zx * sun[..., 2], sun[..., 1] + zy * sun[..., 2]
    disc = SUN_VARIANCE * inverse * inverse
    density = bivariate_normal(
        zx - slope[..., 0],
        zy - slope[..., 1],
        covariance[..., 0, 0] + disc * (1.0 + zx * zx - wx * wx),
        covariance[..., 1, 1] + disc * (1.0 + zy * zy - wy * wy),
        0.5 * (covariance[..., 0, 1] + covariance[..., 1, 0]) + disc * (zx * zy - wx * wy),
    )
    # |V + L| = 2 cosω
    square = jnp.where(up, square, 1.0)
    reflected = fresnel(0.5 * square * inverse_root(square))
    steep = square * inverse * inverse
    visible = masking(seen.hidden, lit.hidden, to_viewer, jnp.broadcast_to(sun, to_viewer.shape))
    rising = sun[..., 2] - slope[..., 0] * sun[..., 0] - slope[..., 1] * sun[..., 1]
    fade = jnp.clip(rising / RISE, 0.0, 1.0)
    # A quotient of the library: XLA writes it to memory, where all channels read it.
    radiance = reflected * density * steep * steep * visible * fade / (4.0 * seen.mean)
    # Where view and sun both graze, slopes move too fast with the direction for a linear law.
    return jnp.where(up, jnp.minimum(radiance, reflected * BRIGHTEST), 0.0)
