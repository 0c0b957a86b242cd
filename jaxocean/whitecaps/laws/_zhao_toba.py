"""Whitecaps by the Reynolds number of breaking waves."""

from typing import ClassVar

import jax.numpy as jnp

from ..._constants import AIR_VISCOSITY, GRAVITY
from ..._types import Scalar
from ...wind import Wind
from ._law import AbstractLaw, Constant

CALM = 1e-3  # m/s; below it the logarithm of the roughness has no finite slope, so u* is not asked for


class ZhaoToba2001(AbstractLaw):
    """Coverage by the breaking-wave parameter R_B: friction velocity and age of the waves together.

    $$ W = 3.88·10^{-7} R_B^{1.09}, \\quad R_B = u_*²/(ν_a ω_p), \\quad ω_p = gΩ/U $$

    **Arguments:** `inverse_wave_age` Ω [-], or None for that of the wind (its fetch, or a fully
      developed sea).

    The range is (unverified).

    **Source:** Zhao & Toba 2001, J. Oceanogr. 57 (published in percent).
    """

    name: ClassVar[str] = "Zhao & Toba 2001"
    citation: ClassVar[str] = "Zhao & Toba 2001, J. Oceanogr. 57, 603-616"
    range: ClassVar[tuple[float, float]] = (3.0, 25.0)

    inverse_wave_age: Constant | None = None
    coefficient: Constant = 3.88e-7
    exponent: Constant = 1.09
    air_viscosity: Constant = AIR_VISCOSITY

    def coverage(self, wind: Wind) -> Scalar:
        blows = wind.speed > CALM
        speed = jnp.where(blows, wind.speed, 1.0)
        age = wind.inverse_wave_age() if self.inverse_wave_age is None else self.inverse_wave_age
        age = jnp.asarray(age, speed.dtype)
        friction = wind.drag.friction_velocity(speed, age)
        breaking = friction**2 * speed / (self.air_viscosity * GRAVITY * age)
        return jnp.where(blows, self.coefficient * breaking**self.exponent, 0.0)
