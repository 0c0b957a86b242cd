"""Facets that the waves hide from the viewer and from the light."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._elementary import reciprocal
from ..._numerics import safe_angle
from ._facing import facing

AZIMUTH_SCALE = 4.41
"""How fast masking and shadowing become independent with the azimuth between them [1/rad] (van Ginneken 1998)."""


class AbstractMasking(eqx.Module):
    """How masking (by the viewer) and shadowing (of the light) of one facet go together."""

    @abc.abstractmethod
    def __call__(
        self,
        view: Float[Array, "*b"],
        light: Float[Array, "*b"],
        to_viewer: Float[Array, "*b 3"],
        to_light: Float[Array, "*b 3"],
    ) -> Float[Array, "*b"]:
        """The fraction of facets that are both seen and lit.

        **Arguments:** `view`, `light`: Λ of the two directions (`smith_lambda`); `to_viewer`, `to_light`: the
        directions themselves, for those models that care about the azimuth between them.
        """


class HeightCorrelatedMasking(AbstractMasking):
    """High facets are more likely to be seen and to be lit; slopes along the way are independent.

    $$ G = \\frac{1}{1 + Λ_V + Λ_L} $$

    Exact for Smith's surfaces where the two azimuths are far apart. It masks too much where they meet: a facet that
    is seen from the sun is lit.

    **Source:** Ross, Dion & Potvin 2005, eq. 17; used by Bruneton, Neyret & Holzschuch 2010.
    """

    def __call__(
        self,
        view: Float[Array, "*b"],
        light: Float[Array, "*b"],
        to_viewer: Float[Array, "*b 3"],
        to_light: Float[Array, "*b 3"],
    ) -> Float[Array, "*b"]:
        return reciprocal(1.0 + view + light)


class AzimuthCorrelatedMasking(AbstractMasking):
    """`HeightCorrelatedMasking` that knows that whoever looks along the light sees no shadow.

    $$ G = \\frac{1}{1 + \\max(Λ_V, Λ_L) + w \\min(Λ_V, Λ_L)}, \\quad w = \\frac{4.41 φ}{4.41 φ + 1} $$

    with the azimuth φ in [0, π] between viewer and light. w is an empirical fit.

    **Source:** van Ginneken, Stavridi & Koenderink 1998, Appl. Opt. 37; Heitz 2014, J. Comput. Graph. Tech. 3, §6.4.
    """

    def __call__(
        self,
        view: Float[Array, "*b"],
        light: Float[Array, "*b"],
        to_viewer: Float[Array, "*b 3"],
        to_light: Float[Array, "*b 3"],
    ) -> Float[Array, "*b"]:
        vx, vy = to_viewer[..., 0], to_viewer[..., 1]
        lx, ly = to_light[..., 0], to_light[..., 1]
        turn = AZIMUTH_SCALE * jnp.abs(safe_angle(vx * lx + vy * ly, vx * ly - vy * lx))
        weight = turn / (turn + 1.0)
        return reciprocal(1.0 + jnp.maximum(view, light) + weight * jnp.minimum(view, light))


class IndependentMasking(AbstractMasking):
    """Masking and shadowing know nothing of one another: the darkest of the three.

    $$ G = \\frac{1}{(1 + Λ_V)(1 + Λ_L)} $$

    **Source:** Smith 1967, IEEE Trans. Antennas Propag. 15.
    """

    def __call__(
        self,
        view: Float[Array, "*b"],
        light: Float[Array, "*b"],
        to_viewer: Float[Array, "*b 3"],
        to_light: Float[Array, "*b 3"],
    ) -> Float[Array, "*b"]:
        return reciprocal((1.0 + view) * (1.0 + light))


HEIGHT_CORRELATED = HeightCorrelatedMasking()


def masking(
    to_viewer: Float[Array, "*b 3"],
    to_light: Float[Array, "*b 3"],
    slope: Float[Array, "*b 2"],
    covariance: Float[Array, "*b 2 2"],
    model: AbstractMasking = HEIGHT_CORRELATED,
) -> Float[Array, "*b"]:
    """The fraction of facets towards the viewer that waves in the same footprint leave both seen and lit.

    **Arguments:** `to_viewer`, `to_light`: unit vectors (*b, 3); `slope` and `covariance`: mean (*b, 2) and
    covariance (*b, 2, 2) of the slopes in the footprint; `model`: how the two go together.

    **Returns:** G in 0 … 1, (*b); 1 where the covariance is 0.
    """
    view, light = (facing(direction, slope, covariance) for direction in (to_viewer, to_light))
    return model(view.hidden, light.hidden, to_viewer, to_light)
