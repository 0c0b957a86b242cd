"""The light that comes out of the water."""

import abc
import math

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar
from .._types import Scalar
from ._colour import reflectance_to_srgb
from ._sea_water import WAVELENGTHS, absorption, backscatter
from .reflection import AbstractFresnel
from .sky import AbstractSky
from .sky._colour_leaf import as_colour, check_colour

PAPER_COLOUR = tuple(channel / 255.0 * 140.0 / 255.0 for channel in (11.0, 121.0, 49.0))
"""Reflectance of the sea in the scenes of Dupuy & Bruneton 2012, linear sRGB."""

# Gordon et al. 1988, J. Geophys. Res. 93: L_u/E_d below the surface by u = b_b/(a + b_b), and how much of L_u comes
# back from below the surface.
LINEAR, QUADRATIC = 0.0949, 0.0794
INTERNAL = 1.7


class AbstractWater(eqx.Module):
    """What the water sends up to a facet, before the facet reflects part of it back down."""

    @abc.abstractmethod
    def radiance(self, sky: AbstractSky, fresnel: AbstractFresnel) -> Float[Array, "*b 3"]:
        """Radiance [that of the sky] that would leave the water if the surface let all of it through, (3,), or one for
        each place of a `LocalSky`."""


class Water(AbstractWater):
    """Open-ocean water, coloured by what absorbs and scatters in it.

    $$ L = \\frac{r}{n² (1 - 1.7 r)} \\left( (1 - F(θ_S)) \\cos θ_S\\, E_{\\mathrm{sun}} +
    (1 - F_d)\\, E_{\\mathrm{sky}} \\right), \\quad r = 0.0949 u + 0.0794 u², \\quad u = \\frac{b_b}{a + b_b} $$

    F(θ_S) and F_d are what a flat sea reflects of the sun and of a uniform sky. r is formed per wavelength and becomes
    linear sRGB as a reflectance under D65; clear water lies outside of the gamut, with a negative red. Raman scattering
    and fluorescence are left out.

    | leaf | unit | default | range | role |
    |---|---|---|---|---|
    | `chlorophyll` C | mg/m³ | 0.1 | 0.02–20 | how much grows in it: clear blue to green |
    | `refractive_index` n | - | 1.34 | 1–2 | spreads the light on its way out |

    **Raises:** `ValueError` for a chlorophyll that is not positive or an index below 1.

    **Source:** Gordon et al. 1988, J. Geophys. Res. 93; a and b_b of Prieur & Sathyendranath 1981 and Morel 1988.
    """

    chlorophyll: Scalar = eqx.field(converter=as_leaf, default=0.1)
    refractive_index: Scalar = eqx.field(converter=as_leaf, default=1.34)

    def __check_init__(self) -> None:
        check_scalar("chlorophyll", self.chlorophyll, "mg/m³", positive=True)
        check_scalar("refractive_index", self.refractive_index, "", minimum=1.0)

    def spectral_reflectance(self) -> Float[Array, "wavelength"]:
        """L/E [1/sr] at 400, 410 … 700 nm: radiance through the surface per irradiance below it."""
        a, scattered = absorption(self.chlorophyll), backscatter(self.chlorophyll)
        u = scattered / (a + scattered)
        below = u * (LINEAR + QUADRATIC * u)
        index = self.refractive_index.astype(below.dtype)
        return below / (index * index * (1.0 - INTERNAL * below))

    def radiance_reflectance(self) -> Float[Array, "3"]:
        """`spectral_reflectance` in linear sRGB [1/sr]."""
        return reflectance_to_srgb(WAVELENGTHS, self.spectral_reflectance())

    def radiance(self, sky: AbstractSky, fresnel: AbstractFresnel) -> Float[Array, "*b 3"]:
        height = jnp.maximum(sky.sun_direction[..., 2:], 0.0)
        direct = height * (1.0 - fresnel(height)) * sky.sun_irradiance
        diffuse = (1.0 - diffuse_reflectance(fresnel, height.dtype)) * sky.irradiance()
        return self.radiance_reflectance().astype(direct.dtype) * (direct + diffuse)


class ConstantWater(AbstractWater):
    """Water of one colour, that scatters like paint.

    $$ L = \\frac{R}{π} \\left( \\cos θ_S\\, E_{\\mathrm{sun}} + E_{\\mathrm{sky}} \\right) $$

    **Arguments:** `colour` R [-], linear sRGB (3,); by default that of Dupuy & Bruneton's scenes,
    (11, 121, 49)/255 × 140/255. `sunlit`: whether the sun's beam lights it; in their program only the sky does
    (R E_sky/π), and their colours belong to that.
    """

    colour: Float[Array, "3"] = eqx.field(converter=as_colour, default=PAPER_COLOUR)
    sunlit: bool = eqx.field(static=True, default=True, kw_only=True)

    def __check_init__(self) -> None:
        check_colour("colour", self.colour, "")

    def radiance(self, sky: AbstractSky, fresnel: AbstractFresnel) -> Float[Array, "*b 3"]:
        if not self.sunlit:
            return self.colour / math.pi * sky.irradiance()
        height = jnp.maximum(sky.sun_direction[..., 2:], 0.0)
        return self.colour / math.pi * (height * sky.sun_irradiance + sky.irradiance())


def diffuse_reflectance(fresnel: AbstractFresnel, dtype: jnp.dtype) -> Scalar:
    """What a flat sea reflects of a uniform sky, ∫ F 2c dc [-]: 0.0675 for n = 1.34."""
    x, w = np.polynomial.legendre.leggauss(24)
    # Nodes in √c, since F is steep at grazing incidence.
    root = 0.5 * (x + 1.0)
    cosine, weight = (jnp.asarray(each, dtype) for each in (root**2, 2.0 * root**3 * w))
    return jnp.sum(weight * fresnel(cosine))
