"""Swell: waves that left their storm long ago, in a narrow band and without a tail."""

import equinox as eqx
import jax.numpy as jnp
from jax.scipy.special import ndtr
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar
from .._types import Scalar
from ._dispersion import Dispersion
from ._frequency import AbstractFrequencySpectrum
from .spreading import AbstractSpreading, Mitsuyasu

NARROWEST = 0.01
PANELS = (-6.0, -3.0, 0.0, 3.0, 6.0)
"""Where a quadrature splits, in widths from the peak: panels of three widths are exact to rounding."""


class Swell(AbstractFrequencySpectrum):
    """A bell in frequency: the narrow spectrum of swell.

    $$ E(f) = \\frac{H_s^2}{16\\, σ \\sqrt{2π}\\, Φ(1/w)} \\exp\\left(−\\frac{(f − f_p)²}{2σ²}\\right),
       \\quad σ = w f_p $$

    Φ(1/w) is the share of the bell at f > 0, so that Hs is exact. Unlike a JONSWAP spectrum of the same height and
    period it has no f⁻⁵ tail: short waves die within hours of leaving the wind, and such a tail would strain the
    surface, hence break it, with waves that are not there.

    **Arguments:**

    - `significant_wave_height`: Hs [m], at least 0.
    - `peak_period`: T_p = 1/f_p [s].
    - `width`: w = σ/f_p [-], at least 0.01; 0.1 by default.
    - `direction`: the mean direction towards which the waves travel [rad].
    - `spreading`: the directional spreading, `Mitsuyasu(75)` (old swell) by default.
    - `dispersion`: how f and k go together; deep water without surface tension by default.

    **Raises:** `ValueError` for a negative height, a period that is not positive, or too small a width.

    **Source:** Bunney, Saulter & Palmer 2014, Reconstruction of complex 2D wave spectra for rapid deployment of
    nearshore wave models; the default width is a choice.
    """

    significant_wave_height: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    peak_period: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    width: Scalar = eqx.field(converter=as_leaf, default=0.1, kw_only=True)
    direction: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    spreading: AbstractSpreading = eqx.field(default_factory=lambda: Mitsuyasu(75.0), kw_only=True)
    dispersion: Dispersion = eqx.field(default_factory=Dispersion, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("significant_wave_height", self.significant_wave_height, "m", minimum=0.0)
        check_scalar("peak_period", self.peak_period, "s", positive=True)
        check_scalar("width", self.width, "", minimum=NARROWEST)
        check_scalar("direction", self.direction, "rad")

    def energy(self, frequency: Float[Array, "*k"], wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        del wavenumber
        offset = (frequency * self.peak_period - 1) / self.width
        top = self.peak_period / (self.width * jnp.sqrt(2 * jnp.pi) * ndtr(1 / self.width))
        return self.significant_wave_height**2 / 16 * top * jnp.exp(-0.5 * offset**2)

    def kinks(self) -> Float[Array, " n"]:
        ratio = 1 + self.width * jnp.asarray(PANELS, self.width.dtype)
        return self.dispersion.wavenumber(2 * jnp.pi * jnp.maximum(ratio, 0.0) / self.peak_period)
