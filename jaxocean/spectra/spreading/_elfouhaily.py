"""The spreading of the unified spectrum, for use with other spectra."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._constants import CAPILLARY_PHASE_SPEED, CAPILLARY_WAVENUMBER, GRAVITY
from ..._types import Scalar
from ...wind import Wind
from ._spreading import AbstractSpreading, WavePeak


def upwind_crosswind_ratio(
    phase_speed: Float[Array, "*k"], peak_speed: Scalar, friction_velocity: Scalar
) -> Float[Array, "*k"]:
    """The anisotropy Δ [-] of waves of phase speed c.

    $$ Δ = \\tanh\\left(\\tfrac{\\ln 2}{4} + 4 (c/c_p)^{2.5} + 0.13 (u_*/c_m) (c_m/c)^{2.5}\\right) $$

    **Source:** Elfouhaily et al. 1997, eq. 57.
    """
    c_m = CAPILLARY_PHASE_SPEED
    # Far below the peak Δ is 1 to rounding; the bound keeps the power from overflowing.
    long_waves = 4 * jnp.minimum(phase_speed / peak_speed, 1e3) ** 2.5
    short_waves = 0.13 * (friction_velocity / c_m) * (c_m / phase_speed) ** 2.5
    return jnp.tanh(0.25 * jnp.log(2.0) + long_waves + short_waves)


def capillary_gravity_speed(wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """c = √((g/k)(1 + (k/k_m)²)) [m/s], as the unified spectrum always has it."""
    return jnp.sqrt(GRAVITY / wavenumber * (1 + (wavenumber / CAPILLARY_WAVENUMBER) ** 2))


class ElfouhailySpreading(AbstractSpreading):
    """Second harmonic only, symmetric between k and −k.

    $$ D(θ) = (1 + Δ(k) \\cos 2θ) / 2π $$

    **Arguments:** `wind`: its drag law gives u* for the inverse wave age U10/c_p of the spectrum's own peak.

    **Source:** Elfouhaily et al. 1997, eqs 49 and 57.
    """

    wind: Wind

    def density(self, offset: Float[Array, "*k"], wave: WavePeak) -> Float[Array, "*k"]:
        return (1 + self._anisotropy(wave) * jnp.cos(2 * offset)) / (2 * jnp.pi)

    def harmonics(self, wave: WavePeak) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
        anisotropy = self._anisotropy(wave)
        return 0.5 * anisotropy, jnp.zeros_like(anisotropy)

    def _anisotropy(self, wave: WavePeak) -> Float[Array, "*k"]:
        blows = self.wind.speed > 0
        age = jnp.where(blows, self.wind.speed, 1.0) / wave.peak_speed
        friction = jnp.where(blows, self.wind.friction_velocity(age), 0.0)
        return upwind_crosswind_ratio(capillary_gravity_speed(wave.wavenumber), wave.peak_speed, friction)
