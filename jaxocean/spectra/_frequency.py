"""Spectra given in frequency: E(f) and a spreading law, turned into Ψ(k, φ) by the dispersion relation."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import GRAVITY
from .._types import Scalar
from ._dispersion import Dispersion
from ._spectrum import AbstractSpectrum, Harmonics, rotated_harmonics
from .spreading import AbstractSpreading, WavePeak


class AbstractFrequencySpectrum(AbstractSpectrum):
    """A spectrum E(f) with a directional spreading D.

    $$ Ψ(k, φ) = \\frac{E(f)\\, D(φ − φ_0)}{2π k} \\frac{dω}{dk}, \\quad f = ω(k)/2π $$

    with finite depth and surface tension as its `dispersion` has them.
    """

    direction: eqx.AbstractVar[Scalar]
    peak_period: eqx.AbstractVar[Scalar]
    spreading: eqx.AbstractVar[AbstractSpreading]
    dispersion: eqx.AbstractVar[Dispersion]

    @abc.abstractmethod
    def energy(self, frequency: Float[Array, "*k"], wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """E(f) [m²/Hz] of waves whose frequency f > 0 [Hz] and wavenumber k [rad/m] belong together."""

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        energy, wave = self._energy_per_wavenumber(wavenumber)
        return energy / wavenumber * self.spreading.density(angle - self.direction, wave)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        mean, wave = self._energy_per_wavenumber(wavenumber)
        return rotated_harmonics(mean, *self.spreading.harmonics(wave), self.direction)

    def peak_wavenumber(self) -> Scalar:
        """k_p [rad/m] at the peak frequency 1/T_p."""
        return self.dispersion.wavenumber(2 * jnp.pi / self.peak_period)

    def _energy_per_wavenumber(self, k: Float[Array, "*k"]) -> tuple[Float[Array, "*k"], WavePeak]:
        """E(k) = E(f) (dω/dk)/2π [m³] and what the spreading needs to know."""
        frequency = self.dispersion.frequency(k) / (2 * jnp.pi)
        per_wavenumber = self.energy(frequency, k) * self.dispersion.group_speed(k) / (2 * jnp.pi)
        peak_speed = GRAVITY * self.peak_period / (2 * jnp.pi)
        return per_wavenumber, WavePeak(frequency * self.peak_period, k, peak_speed)
