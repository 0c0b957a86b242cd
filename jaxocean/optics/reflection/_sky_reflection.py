"""The sky as the sea mirrors it."""

import abc
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._elementary import inverse_root, once, reciprocal
from ..sky import AbstractSky
from ._facing import facing
from ._fresnel import AbstractFresnel
from ._mean_fresnel import bruneton_mean_fresnel
from ._visible_slopes import THREE_SLOPES, AbstractVisibleSlopes, SlopeNode, SlopeQuadrature

NOTHING = 1e-12
"""Reflectance [-] below which the mean reflecting facet is not asked for."""


class SkyReflection(NamedTuple):
    """Mean reflectance F̄ [-] of the facets in view, (*b), and the reflected sky [radiance], (*b, 3)."""

    reflectance: Float[Array, "*b"]
    radiance: Float[Array, "*b 3"]


class AbstractSkyReflection(eqx.Module):
    """How the sky's radiance is averaged over the facets in view, each with its reflectance.

    $$ L = \\overline{F(ω)\\, L_{\\mathrm{sky}}(R)}, \\quad R = 2 (V·N) N - V $$
    """

    @abc.abstractmethod
    def __call__(
        self,
        to_viewer: Float[Array, "*b 3"],
        slope: Float[Array, "*b 2"],
        covariance: Float[Array, "*b 2 2"],
        sky: AbstractSky,
        fresnel: AbstractFresnel,
    ) -> SkyReflection:
        """The sky that footprints with mean `slope` and `covariance` of slopes reflect `to_viewer`."""


class LobeReflection(AbstractSkyReflection):
    """One look-up in the sky, where the mean reflecting facet points, widened by the spread of the mirrored rays.

    The mean facet is weighted by what the viewer sees of each facet and by what it reflects, the spread by the former
    alone.
    """

    def __call__(
        self,
        to_viewer: Float[Array, "*b 3"],
        slope: Float[Array, "*b 2"],
        covariance: Float[Array, "*b 2 2"],
        sky: AbstractSky,
        fresnel: AbstractFresnel,
    ) -> SkyReflection:
        seen = facing(to_viewer, slope, covariance)
        nodes = THREE_SLOPES.nodes(to_viewer, slope, covariance)
        parts = [node.weight * fresnel(node.cosine) for node in nodes]
        whole = sum(node.weight for node in nodes)
        # Quotients of the library, here and below: XLA writes them to memory, and all that follows reads them.
        reflectance = (parts[0] + parts[1] + parts[2]) / whole
        steps = parts[0] * nodes[0].step + parts[1] * nodes[1].step + parts[2] * nodes[2].step
        step = steps / jnp.maximum(reflectance, NOTHING)
        turn_x, turn_y = seen.turn
        x, y = slope[..., 0] - step * turn_x, slope[..., 1] - step * turn_y
        area = seen.mean + step * seen.deviation
        loose = nodes[0].loose
        length = 1.0 + x * x + y * y + loose
        shift = seen.below * seen.deviation / seen.area
        spread = (turn_x * turn_x + turn_y * turn_y) * (2.0 - (seen.ratio + shift) * shift)
        # A facet that tilts by δ along the view turns the ray by 2δ, across it by 2δ cosω.
        variance = 2.0 * (spread * length + area * area * loose) / length
        radiance = sky.lobe_radiance(mirrored(to_viewer, x, y), once(variance))
        return SkyReflection(reflectance, _times(reflectance, radiance))


class FacetReflection(AbstractSkyReflection):
    """One look-up in the sky for each facet of a quadrature: the reference, and slow.

    **Arguments:** `visible`: the rule for means over the facets in view.
    """

    visible: AbstractVisibleSlopes = SlopeQuadrature()

    def __call__(
        self,
        to_viewer: Float[Array, "*b 3"],
        slope: Float[Array, "*b 2"],
        covariance: Float[Array, "*b 2 2"],
        sky: AbstractSky,
        fresnel: AbstractFresnel,
    ) -> SkyReflection:
        nodes = self.visible.nodes(to_viewer, slope, covariance)

        def add(total: SkyReflection, node: SlopeNode) -> tuple[SkyReflection, None]:
            each = node.weight * fresnel(node.cosine)
            radiance = each[..., None] * sky.radiance(mirrored(to_viewer, node.x, node.y))
            return SkyReflection(total.reflectance + each, total.radiance + radiance), None

        # One node after the other: all at once would hold as many pictures as there are nodes.
        start = SkyReflection(jnp.zeros_like(to_viewer[..., 0]), jnp.zeros_like(to_viewer))
        steps = jax.tree.map(lambda *each: jnp.stack(each), *nodes)
        return jax.lax.scan(add, start, steps)[0]


class BrunetonReflection(AbstractSkyReflection):
    """The mean facet mirrors a widened sky, with the reflectance of Bruneton's fit.

    **Source:** Bruneton, Neyret & Holzschuch 2010, Comput. Graph. Forum 29, §4; see `bruneton_mean_fresnel`.
    """

    def __call__(
        self,
        to_viewer: Float[Array, "*b 3"],
        slope: Float[Array, "*b 2"],
        covariance: Float[Array, "*b 2 2"],
        sky: AbstractSky,
        fresnel: AbstractFresnel,
    ) -> SkyReflection:
        del fresnel
        seen = facing(to_viewer, slope, covariance)
        x, y = slope[..., 0], slope[..., 1]
        cosine = seen.mean * inverse_root(1.0 + x * x + y * y)
        total = covariance[..., 0, 0] + covariance[..., 1, 1]
        along = jnp.minimum(seen.turn[0] ** 2 + seen.turn[1] ** 2, total)
        reflectance = bruneton_mean_fresnel(cosine, along)
        variance = 2.0 * (along + cosine * cosine * (total - along))
        radiance = sky.lobe_radiance(mirrored(to_viewer, x, y), variance)
        return SkyReflection(reflectance, _times(reflectance, radiance))


def _times(factor: Float[Array, "*b"], colour: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
    return jnp.stack([factor * colour[..., i] for i in range(3)], axis=-1)


def mirrored(
    direction: Float[Array, "*b 3"], x: Float[Array, "*b"], y: Float[Array, "*b"]
) -> Float[Array, "*b 3"]:
    """The unit vector (*b, 3) from which a facet of slope (x, y) reflects light into `direction`."""
    dx, dy, dz = direction[..., 0], direction[..., 1], direction[..., 2]
    scale = 2.0 * (dz - x * dx - y * dy) * reciprocal(1.0 + x * x + y * y)
    rx, ry, rz = -scale * x - dx, -scale * y - dy, scale - dz
    # A quotient of the library, which XLA writes to memory before a sky reads it many times.
    length = jnp.sqrt(rx * rx + ry * ry + rz * rz)
    return jnp.stack([rx / length, ry / length, rz / length], axis=-1)
