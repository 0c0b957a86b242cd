"""Tone mapping: from the light of a scene to the code values of a picture."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar
from .._types import Scalar
from ._srgb import encode_srgb

TOE = 1e-4
"""Exposed light below which `Bruneton` follows a parabola."""


class AbstractTone(eqx.Module):
    """A map from linear light to sRGB code values in [0, 1]: never falling, continuous, of each channel alone."""

    @abc.abstractmethod
    def __call__(self, radiance: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """sRGB code values of linear light in any unit; light below 0 shows as black."""


class Exposure(AbstractTone):
    """Plain exposure: scale, clip, encode.

    $$ V = \\mathrm{sRGB}(e\\, L) $$

    **Arguments:** `exposure`: e, what 1 / e is the display's white; greater than 0, differentiable.
    """

    exposure: Scalar = eqx.field(converter=as_leaf, default=1.0)

    def __check_init__(self) -> None:
        check_scalar("exposure", self.exposure, "", positive=True)

    def __call__(self, radiance: Float[Array, "*b"]) -> Float[Array, "*b"]:
        return encode_srgb(self.exposure.astype(radiance.dtype) * radiance)


class Bruneton(AbstractTone):
    """The tone mapping of Bruneton's ocean and atmosphere programs, and so of the pictures in Dupuy & Bruneton (2012).

    $$ V = (0.38317\\, e L)^{1/2.2} \\;\\; (e L < 1.413), \\qquad V = 1 - \\exp(-e L) $$

    Both parts meet with the same slope. It gives code values at once: the exponent is the display's. Below
    e L = 1e-4, a code value under 2.5/255, a parabola with the same slope at its end replaces the power law, whose
    derivative at 0 is infinite.

    **Arguments:** `exposure`: e, greater than 0; differentiable. 1.05 belongs to the scenes of Dupuy & Bruneton, whose
    radiance has another unit.
    """

    exposure: Scalar = eqx.field(converter=as_leaf, default=1.05)

    def __check_init__(self) -> None:
        check_scalar("exposure", self.exposure, "", positive=True)

    def __call__(self, radiance: Float[Array, "*b"]) -> Float[Array, "*b"]:
        light = jnp.maximum(self.exposure.astype(radiance.dtype) * radiance, 0.0)
        toe, shoulder = light < TOE, light >= 1.413
        power = (0.38317 * jnp.where(toe, TOE, light)) ** (1.0 / 2.2)
        s = jnp.minimum(light / TOE, 1.0)
        parabola = power * s * (2.0 - 1.0 / 2.2 + (1.0 / 2.2 - 1.0) * s)
        return jnp.where(toe, parabola, jnp.where(shoulder, -jnp.expm1(-light), power))


class Filmic(AbstractTone):
    """A filmic curve: a dark toe, a straight middle, a soft shoulder. Narkowicz' fit to the ACES reference rendering.

    $$ V = \\mathrm{sRGB}\\left(\\frac{x (2.51 x + 0.03)}{x (2.43 x + 0.59) + 0.14}\\right), \\quad x = e L $$

    It reaches white at x = 7.24. **Arguments:** `exposure`: e, greater than 0; differentiable. 0.6 is the exposure of
    the reference itself.

    **Source:** K. Narkowicz, ACES Filmic Tone Mapping Curve, 2016.
    """

    exposure: Scalar = eqx.field(converter=as_leaf, default=1.0)

    def __check_init__(self) -> None:
        check_scalar("exposure", self.exposure, "", positive=True)

    def __call__(self, radiance: Float[Array, "*b"]) -> Float[Array, "*b"]:
        x = jnp.clip(self.exposure.astype(radiance.dtype) * radiance, 0.0, 100.0)
        return encode_srgb(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14))
