"""The unified wind-wave spectrum of Elfouhaily et al. (1997): from the swell to the ripples."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import CAPILLARY_PHASE_SPEED, CAPILLARY_WAVENUMBER, GRAVITY
from .._numerics import check_kind, check_scalar, optional_leaf
from .._types import Scalar
from ..wind import Wind
from ._spectrum import AbstractSpectrum, Harmonics, rotated_harmonics
from .spreading import AbstractSpreading, ElfouhailySpreading, WavePeak, capillary_gravity_speed

CALM = 1e-3  # m/s; below it the peak lies beyond any wavenumber and the spectrum underflows to 0
FARTHEST = 30.0  # k_p/k beyond which exp(−1.25 (k_p/k)²) is 0; keeps 0·∞ out of the gradients


class Elfouhaily(AbstractSpectrum):
    """Wind sea from the spectral peak to the capillary waves.

    $$ Ψ(k, φ) = (B_l + B_h)(1 + Δ(k) \\cos 2(φ − φ_w)) / (2π k⁴) $$

    with the long-wave curvature B_l = ½ α_p (c_p/c) L_PM γ^Γ exp(−Ω(√(k/k_p) − 1)/√10) and the short-wave
    curvature B_h = ½ α_m (c_m/c) exp(−¼(k/k_m − 1)²) L_PM. Another `spreading` D takes the place of
    (1 + Δ cos 2(φ − φ_w))/2π.

    **Arguments:**

    - `wind`: its speed, direction, fetch and drag law are leaves; the drag law sets u* in α_m and Δ.
    - `inverse_wave_age`: Ω = U10/c_p [-], 0.84 (fully developed) to 5; if None it follows from the wind's
      fetch, and is 0.84 without one.
    - `spreading`: another directional spreading, or None for the model's own Δ(k).
    - `half_plane`: keep only waves that travel downwind (|φ − φ_w| < π/2), energy unchanged; static.
    - `peak_enhancement`: γ [-]; if None it is 1.7 for Ω ≤ 1, else 1.7 + 6 log₁₀ Ω. Some programs take the natural
      logarithm there.

    **Raises:** `ValueError` if both a fetch and an inverse wave age are given, or Ω or γ is not positive.

    **Source:** Elfouhaily, Chapron, Katsaros & Vandemark 1997, J. Geophys. Res. 102(C7).
    """

    wind: Wind
    inverse_wave_age: Scalar | None = eqx.field(converter=optional_leaf, default=None)
    spreading: AbstractSpreading | None = eqx.field(default=None, kw_only=True)
    half_plane: bool = eqx.field(static=True, default=False, kw_only=True)
    peak_enhancement: Scalar | None = eqx.field(converter=optional_leaf, default=None, kw_only=True)

    def __check_init__(self) -> None:
        check_kind("wind", self.wind, Wind, "a `Wind`")
        if self.wind.fetch is not None and self.inverse_wave_age is not None:
            raise ValueError(
                "Give exactly one of the wind's `fetch` and `inverse_wave_age`, but both are given."
            )
        check_scalar("inverse_wave_age", self.inverse_wave_age, "", positive=True)
        check_scalar("peak_enhancement", self.peak_enhancement, "", positive=True)

    def age(self) -> Scalar:
        """Ω [-], as given or from the fetch."""
        return self.wind.inverse_wave_age() if self.inverse_wave_age is None else self.inverse_wave_age

    def peak_wavenumber(self) -> Scalar:
        """k_p = g (Ω/U10)² [rad/m]."""
        return GRAVITY * (self.age() / jnp.maximum(self.wind.speed, CALM)) ** 2

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        offset = angle - self.wind.direction
        spreading, wave = self._spreading(wavenumber)
        directional = spreading.density(offset, wave)
        if self.half_plane:
            folded = directional + spreading.density(offset + jnp.pi, wave)
            downwind = jnp.cos(offset)
            # On the edge itself half of the energy of the two opposite waves stays with each.
            edge = jnp.abs(downwind) < 4 * jnp.finfo(offset.dtype).eps
            directional = folded * jnp.where(edge, 0.5, jnp.where(downwind > 0, 1.0, 0.0))
        return self._curvature(wavenumber) / wavenumber**4 * directional

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        # Second moments do not see the half-plane option: they are even in k → −k.
        spreading, wave = self._spreading(wavenumber)
        mean = self._curvature(wavenumber) / wavenumber**3
        return rotated_harmonics(mean, *spreading.harmonics(wave), self.wind.direction)

    def _spreading(self, k: Float[Array, "*k"]) -> tuple[AbstractSpreading, WavePeak]:
        spreading = ElfouhailySpreading(self.wind) if self.spreading is None else self.spreading
        peak_speed = jnp.maximum(self.wind.speed, CALM) / self.age()
        frequency = k * capillary_gravity_speed(k)
        return spreading, WavePeak(frequency * peak_speed / GRAVITY, k, peak_speed)

    def _curvature(self, k: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """Total curvature B_l + B_h [-]."""
        blows = self.wind.speed > CALM
        u10 = jnp.where(blows, self.wind.speed, 1.0)
        omega = self.age()
        k_p = GRAVITY * (omega / u10) ** 2
        c = capillary_gravity_speed(k)  # whatever dispersion the animation uses
        c_p = u10 / omega
        c_m, k_m = CAPILLARY_PHASE_SPEED, CAPILLARY_WAVENUMBER
        friction = self.wind.drag.friction_velocity(u10, omega)

        low_pass = jnp.exp(-1.25 * jnp.minimum(k_p / k, FARTHEST) ** 2)
        root = jnp.sqrt(k / k_p)
        width = 0.08 * (1 + 4 / omega**3)
        gamma = self.peak_enhancement
        if gamma is None:
            old = omega <= 1
            gamma = jnp.where(old, 1.7, 1.7 + 6 * jnp.log10(jnp.where(old, 1.0, omega)))
        peak = gamma ** jnp.exp(-0.5 * ((root - 1) / width) ** 2)
        cut = jnp.exp(-omega * (root - 1) / jnp.sqrt(10.0))
        long_waves = 0.5 * 6e-3 * jnp.sqrt(omega) * c_p / c * low_pass * peak * cut

        growth = jnp.log(friction / c_m)
        alpha_m = 0.01 * jnp.where(friction <= c_m, jnp.maximum(1 + growth, 0.0), 1 + 3 * growth)
        short_waves = 0.5 * alpha_m * c_m / c * jnp.exp(-0.25 * (k / k_m - 1) ** 2) * low_pass
        return jnp.where(blows, long_waves + short_waves, 0.0)
