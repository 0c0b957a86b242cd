"""The dispersion relation of surface waves: gravity, surface tension, finite depth."""

import equinox as eqx
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Float

from .._constants import GRAVITY, WATER_DENSITY, WATER_SURFACE_TENSION
from .._numerics import as_leaf, check_scalar, optional_leaf, safe_sqrt
from .._types import Scalar


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
        """The wavenumber k [rad/m] of angular frequency ω ≥ 0 [rad/s]; differentiable."""
        omega = as_leaf(frequency)
        moves = omega > 0
        w = jnp.where(moves, omega, 1.0)
        deep = w**2 / GRAVITY
        if self.depth is None:
            start = deep
        else:
            # Guo's explicit fit, within 1 % at all depths, makes Newton's method safe.
            x = self.depth * w / jnp.sqrt(GRAVITY * self.depth)
            start = x**2 / self.depth * (1 - jnp.exp(-(x**2.4908))) ** -0.4015
        with_tension = jnp.cbrt(w**2 / jnp.maximum(self.surface_tension, 1e-30))
        start = jnp.minimum(start, with_tension)

        # ω is monotone in k, so Newton's method in log k from this start converges in a few steps.
        def residual(log_k, _):
            return jnp.log(self._frequency_squared(jnp.exp(log_k))) - 2 * jnp.log(w)

        tolerance = 1e-6 if w.dtype == jnp.float32 else 1e-12
        solution = optx.root_find(
            residual, optx.Newton(rtol=tolerance, atol=tolerance), jnp.log(start), max_steps=64, throw=False
        )
        return jnp.where(moves, jnp.exp(solution.value), 0.0)

    def _frequency_squared(self, k: Float[Array, "*k"]) -> Float[Array, "*k"]:
        restoring = GRAVITY * k + self.surface_tension * k**3
        return restoring if self.depth is None else restoring * jnp.tanh(k * self.depth)
