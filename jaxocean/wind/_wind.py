"""The wind: the first link of the chain."""

import math

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import GRAVITY, KNOT, VON_KARMAN
from .._numerics import as_leaf, check_kind, check_scalar, optional_leaf
from .._types import FloatLike, Scalar, ScalarLike
from ._drag import AbstractDrag, ElfouhailyDrag

FULLY_DEVELOPED = 0.84
"""Inverse wave age Ω of a fully developed sea (Elfouhaily et al. 1997, eq. 37)."""


class Wind(eqx.Module):
    """The wind over the sea, each number a differentiable leaf.

    **Arguments:**

    - `speed`: U10 [m/s] at 10 m, at least 0.
    - `direction`: where it blows **towards** [rad], counter-clockwise from +x (east).
    - `fetch`: the distance over which it has blown [m], or None (a fully developed sea unless a spectrum is
      told its inverse wave age).
    - `sea_air_temperature_difference`: sea minus air, T_w − T_a [K]; positive is unstable.
    - `drag`: the law for the friction velocity.

    **Raises:** `ValueError` for a negative or non-finite number, or an array where one number is due.
    """

    speed: Scalar = eqx.field(converter=as_leaf)
    direction: Scalar = eqx.field(converter=as_leaf, default=0.0)
    fetch: Scalar | None = eqx.field(converter=optional_leaf, default=None, kw_only=True)
    sea_air_temperature_difference: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    drag: AbstractDrag = eqx.field(default=ElfouhailyDrag(), kw_only=True)

    def __check_init__(self) -> None:
        check_kind("drag", self.drag, AbstractDrag, "a drag law such as `ElfouhailyDrag()` or `WuDrag()`")
        check_scalar("speed", self.speed, "m/s", minimum=0.0)
        check_scalar("direction", self.direction, "rad")
        check_scalar("fetch", self.fetch, "m", positive=True)
        check_scalar("sea_air_temperature_difference", self.sea_air_temperature_difference, "K")

    @classmethod
    def from_meteorological(
        cls,
        speed: ScalarLike,
        *,
        from_degrees: ScalarLike,
        height: float | int = 10.0,
        drag: AbstractDrag | None = None,
        fetch: ScalarLike | None = None,
        sea_air_temperature_difference: ScalarLike = 0.0,
    ) -> "Wind":
        """A wind as weather services report it.

        The speed is brought to 10 m along the neutral logarithmic profile,
        U10 = U_z ln(10/z0)/ln(z/z0), z0 = 10 exp(−κ U10/u*), with u* of a fully developed sea.

        **Arguments:** `speed` [m/s] at `height` [m]; `from_degrees`: where it comes **from** [degrees],
        clockwise from north.

        **Returns:** a `Wind`.
        """
        _check_height(height)
        law = ElfouhailyDrag() if drag is None else drag
        measured = as_leaf(speed)
        check_scalar("speed", measured, "m/s", minimum=0.0)
        return cls(
            _to_ten_metres(measured, height, law),
            direction_from_meteorological(from_degrees),
            fetch=fetch,
            sea_air_temperature_difference=sea_air_temperature_difference,
            drag=law,
        )

    def friction_velocity(self, inverse_wave_age: ScalarLike = FULLY_DEVELOPED) -> Scalar:
        """u* [m/s] by the wind's drag law for the inverse wave age Ω [-]."""
        return self.drag.friction_velocity(self.speed, jnp.asarray(inverse_wave_age, self.speed.dtype))

    def at_height(self, height: float | int) -> Scalar:
        """The wind [m/s] at `height` [m] on the neutral logarithmic profile, U_z = U10 + (u*/κ) ln(z/10).

        u* is that of a fully developed sea.
        """
        _check_height(height)
        return self.speed + self.friction_velocity() / VON_KARMAN * math.log(height / 10.0)

    def inverse_wave_age(self) -> Scalar:
        """Ω [-] from the fetch, or 0.84 (fully developed) where no fetch is given."""
        if self.fetch is None:
            return jnp.asarray(FULLY_DEVELOPED, self.speed.dtype)
        return inverse_wave_age_from_fetch(self.speed, self.fetch)


def _check_height(height: float | int) -> None:
    if not (math.isfinite(height) and height > 0.01):
        raise ValueError(f"Argument `height` must be greater than 0.01 m, but is {height:g} m.")


def _to_ten_metres(speed: Scalar, height: float | int, drag: AbstractDrag) -> Scalar:
    """Fixed point of the neutral profile; it contracts by about ten per step, so twelve steps are exact."""
    if height == 10.0:
        return speed
    blows = speed > 0
    measured = jnp.where(blows, speed, 1.0)
    u10 = measured
    for _ in range(12):
        ratio = VON_KARMAN * u10 / drag.friction_velocity(u10, jnp.asarray(FULLY_DEVELOPED, u10.dtype))
        # ln(z/z0) = ln(z/10) + κU10/u*
        u10 = measured * ratio / (ratio + math.log(height / 10.0))
    return jnp.where(blows, u10, 0.0)


def inverse_wave_age_from_fetch(speed: ScalarLike, fetch: ScalarLike) -> Scalar:
    """Inverse wave age of a fetch-limited sea.

    $$ Ω_c = 0.84 \\tanh((X̃/2.2·10^4)^{0.4})^{-0.75}, \\quad X̃ = gX/U² $$

    **Arguments:** `speed` U10 [m/s], `fetch` X [m]. **Returns:** Ω [-].

    **Source:** Elfouhaily et al. 1997, eq. 37.
    """
    u = as_leaf(speed)
    blows = u > 0
    dimensionless = GRAVITY * as_leaf(fetch) / jnp.where(blows, u, 1.0) ** 2
    omega = FULLY_DEVELOPED * jnp.tanh((dimensionless / 2.2e4) ** 0.4) ** -0.75
    return jnp.where(blows, omega, FULLY_DEVELOPED)


def direction_from_meteorological(from_degrees: FloatLike) -> Float[Array, "..."]:
    """Where something is going [rad, counter-clockwise from east] that comes from `from_degrees`.

    **Arguments:** `from_degrees`: degrees clockwise from north, as weather services have it.
    """
    return jnp.mod(1.5 * math.pi - jnp.deg2rad(as_leaf(from_degrees)), 2.0 * math.pi)


def knots(speed: FloatLike) -> Float[Array, "..."]:
    """A speed in knots [kn] as m/s."""
    return as_leaf(speed) * KNOT
