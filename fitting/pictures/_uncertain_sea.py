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
"""Wavenumber [rad/m] above which spectra of different authors part: films, currents and gusts change short waves."""


class TiltedSpectrum(AbstractSpectrum):
    """A spectrum with more or fewer waves, above all short ones.

    $$ Ψ'(k, φ) = e^{a}\\, (1 + (k/k_0)^2)^{b/2}\\, Ψ(k, φ), \\quad k_0 = 3\\,\\mathrm{rad/m} $$

    **Arguments:** `spectrum` Ψ; `level` a [-] and `tilt` b [-].
    """

    spectrum: AbstractSpectrum
    level: Scalar = eqx.field(converter=as_leaf)
    tilt: Scalar = eqx.field(converter=as_leaf)

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return self._factor(wavenumber) * self.spectrum.density(wavenumber, angle)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Any:
        own = self.spectrum.harmonics(wavenumber)
        return type(own)(*(self._factor(wavenumber) * each for each in own))

    def kinks(self) -> Float[Array, " n"]:
        return self.spectrum.kinks()

    def _factor(self, wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        level, tilt = (each.astype(wavenumber.dtype) for each in (self.level, self.tilt))
        return jnp.exp(level + 0.5 * tilt * jnp.log1p((wavenumber / SHORT) ** 2))


class UncertainSea(eqx.Module):
    """Makes the spectrum of a wind sea with swell below it.

    | leaf | unit | default | role |
    |---|---|---|---|
    | leaves of `wind_sea` | theirs | Elfouhaily, Ω = 0.84 | how a wind makes a spectrum |
    | `level`, `tilt` | - | 0 | of all its waves, see `TiltedSpectrum` |
    | `swell_height`, `swell_period` | m, s | 0, 10 | of a swell |
    | `swell_turn` | rad | 0 | where it runs to, from where the wind blows to |
    """

    wind_sea: ElfouhailySea = eqx.field(default_factory=ElfouhailySea)
    level: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    tilt: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    swell_height: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    swell_period: Scalar = eqx.field(converter=as_leaf, default=10.0, kw_only=True)
    swell_turn: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)

    def __call__(self, wind: Wind) -> AbstractSpectrum:
        """The spectrum."""
        raised = TiltedSpectrum(self.wind_sea(wind), self.level, self.tilt)
        return raised + Swell(
            significant_wave_height=self.swell_height,
            peak_period=self.swell_period,
            direction=wind.direction + self.swell_turn.astype(wind.direction.dtype),
        )
