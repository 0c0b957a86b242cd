"""A wind sea that is as uncertain as spectra of different authors are."""

from typing import Any

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxocean import Wind
from jaxocean._numerics import as_leaf
from jaxocean._types import Scalar
from jaxocean.spectra import AbstractSpectrum, Swell

from .._spectral_model import ElfouhailySea

SHORT = 3.0
"""Wavenumber [rad/m] above which spectra of different authors part: currents and gusts change short waves."""

RIPPLES = 40.0
"""Wavenumber [rad/m] from which films damp waves: no picture shows these one by one, but light is spread by them."""


class TiltedSpectrum(AbstractSpectrum):
    """A spectrum with more or fewer waves, above all short ones.

    $$ Ψ'(k, φ) = e^{a + c\\, k^2/(k^2 + k_1^2)}\\, (1 + (k/k_0)^2)^{b/2}\\, Ψ(k, φ), \\quad
       k_0 = 3\\,\\mathrm{rad/m},\\; k_1 = 40\\,\\mathrm{rad/m} $$

    **Arguments:** `spectrum` Ψ; `level` a, `tilt` b and `ripples` c [-].

    **Source:** Cox & Munk 1954 for films that damp ripples; the factors are our own.
    """

    spectrum: AbstractSpectrum
    level: Scalar = eqx.field(converter=as_leaf)
    tilt: Scalar = eqx.field(converter=as_leaf)
    ripples: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return self._factor(wavenumber) * self.spectrum.density(wavenumber, angle)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Any:
        own = self.spectrum.harmonics(wavenumber)
        return type(own)(*(self._factor(wavenumber) * each for each in own))

    def kinks(self) -> Float[Array, " n"]:
        return self.spectrum.kinks()

    def _factor(self, wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        level, tilt, ripples = (
            each.astype(wavenumber.dtype) for each in (self.level, self.tilt, self.ripples)
        )
        short = wavenumber**2 / (wavenumber**2 + RIPPLES**2)
        return jnp.exp(level + ripples * short + 0.5 * tilt * jnp.log1p((wavenumber / SHORT) ** 2))


class UncertainSea(eqx.Module):
    """Makes the spectrum of a wind sea with swell below it.

    | leaf | unit | default | role |
    |---|---|---|---|
    | leaves of `wind_sea` | theirs | Elfouhaily, Ω = 0.84 | how a wind makes a spectrum |
    | `level`, `tilt`, `ripples` | - | 0 | of all its waves, of shorter ones, of ripples, see `TiltedSpectrum` |
    | `swell_height`, `swell_period` | m, s | 0, 10 | of a swell |
    | `swell_turn` | rad | 0 | where it runs to, from where the wind blows to |
    """

    wind_sea: ElfouhailySea = eqx.field(default_factory=ElfouhailySea)
    level: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    tilt: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    ripples: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    swell_height: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    swell_period: Scalar = eqx.field(converter=as_leaf, default=10.0, kw_only=True)
    swell_turn: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)

    def __call__(self, wind: Wind) -> AbstractSpectrum:
        """The spectrum."""
        raised = TiltedSpectrum(self.wind_sea(wind), self.level, self.tilt, self.ripples)
        return raised + Swell(
            significant_wave_height=self.swell_height,
            peak_period=self.swell_period,
            direction=wind.direction + self.swell_turn.astype(wind.direction.dtype),
        )
