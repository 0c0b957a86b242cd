"""The dispersion relation of surface waves: gravity, surface tension, finite depth."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import GRAVITY, WATER_DENSITY, WATER_SURFACE_TENSION
from .._numerics import as_leaf, check_scalar, optional_leaf, safe_sqrt
from .._types import Scalar

NEWTON_STEPS = 6


class Dispersion(eqx.Module):
    """How fast waves travel.

    $$ ω² = (g k + (γ_s/ρ) k³) \\tanh(k d) $$

    **Arguments:**

    - `depth`: water depth d [m], or None for deep water.
    - `surface_tension`: γ_s/ρ [m³/s²]; 0 (default) leaves capillary waves out,
      `Dispersion.CLEAN_WATER` is that of clean sea water.

    **Raises:** `ValueError` for a depth that is not positive or a negative surface tension.
    """

    CLEAN_WATER = WATER_SURFACE_TENSION / WATER_DENSITY

    depth: Scalar | None = eqx.field(converter=optional_leaf, default=None)
    surface_tension: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def __check_init__(self) -> None:
        check_scalar("depth", self.depth, "m", positive=True)
        check_scalar("surface_tension", self.surface_tension, "m³/s²", minimum=0.0)

    def frequency(self, wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """Angular frequency ω(k) [rad/s] of wavenumber k ≥ 0 [rad/m]; 0 with finite derivatives at k = 0."""
        return safe_sqrt(self._frequency_squared(wavenumber))

    def stiffening(self, wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """ω²/(gk) [-]: what tension and depth make of a gravity wave in deep water; 1 without both."""
        tension = 1 + self.surface_tension * wavenumber**2 / GRAVITY
        return tension if self.depth is None else tension * jnp.tanh(wavenumber * self.depth)

    def group_speed(self, wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """Group speed dω/dk [m/s] at k > 0 [rad/m], in closed form."""
        k, gamma = wavenumber, self.surface_tension
        restoring = GRAVITY * k + gamma * k**3
        stiffness = GRAVITY + 3 * gamma * k**2
        if self.depth is None:
            slope = stiffness
        else:
            tanh = jnp.tanh(k * self.depth)
            slope = stiffness * tanh + restoring * self.depth * (1 - tanh**2)
        omega = self.frequency(k)
        moves = omega > 0
        return jnp.where(moves, slope / (2 * jnp.where(moves, omega, 1.0)), 0.0)

    def wavenumber(self, frequency: Float[Array, "*w"]) -> Float[Array, "*w"]:
        """The wavenumber k [rad/m] of angular frequency ω ≥ 0 [rad/s]; differentiable, in the leaves too."""
        moves = frequency > 0
        w = jnp.where(moves, frequency, 1.0)
        deep = w**2 / GRAVITY
        if self.depth is None:
            start = deep
        else:
            # Guo's explicit fit, within 1 % at all depths, makes Newton's method safe.
            x = w * jnp.sqrt(self.depth / GRAVITY)
            start = x**2 / self.depth * (-jnp.expm1(-(x**2.4908))) ** -0.4015
        start = jnp.minimum(start, jnp.cbrt(w**2 / jnp.maximum(self.surface_tension, 1e-30)))
        start = jax.lax.stop_gradient(start)

        # log ω is a smooth increasing function of log k with a slope between ½ and 3/2: Newton's method there
        # needs a handful of steps. Each number is iterated on its own; only the last two steps are
        # differentiated, which makes first and second derivatives exact.
        def step(_, log_k):
            k = jnp.exp(log_k)
            omega = self.frequency(k)
            return log_k - jnp.log(omega / w) * omega / (k * self.group_speed(k))

        settled = jax.lax.stop_gradient(jax.lax.fori_loop(0, NEWTON_STEPS, step, jnp.log(start)))
        return jnp.where(moves, jnp.exp(step(1, step(0, settled))), 0.0)

    def _frequency_squared(self, k: Float[Array, "*k"]) -> Float[Array, "*k"]:
        restoring = GRAVITY * k + self.surface_tension * k**3
        return restoring if self.depth is None else restoring * jnp.tanh(k * self.depth)
