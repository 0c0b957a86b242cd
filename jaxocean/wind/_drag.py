"""Drag laws: from the wind at 10 m to the friction velocity u*."""

import abc

import equinox as eqx
import jax.numpy as jnp

from .._constants import GRAVITY, VON_KARMAN
from .._types import Scalar


class AbstractDrag(eqx.Module):
    """How the sea drags at the wind."""

    @abc.abstractmethod
    def friction_velocity(self, speed: Scalar, inverse_wave_age: Scalar) -> Scalar:
        """u* [m/s] from U10 [m/s] and the inverse wave age Ω = U10/c_p [-]; 0 in calm air."""


class ElfouhailyDrag(AbstractDrag):
    """Roughness that grows with young waves.

    $$ u_* = κ U / \\ln(10/z_0), \\quad z_0 = 3.7·10^{-5} (U²/g) Ω^{0.9} $$

    **Source:** Elfouhaily et al. 1997, eq. 66.
    """

    def friction_velocity(self, speed: Scalar, inverse_wave_age: Scalar) -> Scalar:
        blows = speed > 0
        u = jnp.where(blows, speed, 1.0)
        roughness = 3.7e-5 * u**2 / GRAVITY * inverse_wave_age**0.9
        return jnp.where(blows, VON_KARMAN * u / jnp.log(10.0 / roughness), 0.0)


class WuDrag(AbstractDrag):
    """Drag coefficient linear in the wind, blind to the waves.

    $$ u_* = U \\sqrt{C_d}, \\quad C_d = (0.8 + 0.065 U)·10^{-3} $$

    **Source:** Wu 1982.
    """

    def friction_velocity(self, speed: Scalar, inverse_wave_age: Scalar) -> Scalar:
        del inverse_wave_age
        return speed * jnp.sqrt((0.8 + 0.065 * speed) * 1e-3)
