"""From what ships and buoys report in three numbers, wind, height and phase speed, to wind sea and swell."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

from .._constants import GRAVITY
from .._numerics import as_leaf, check_scalar, safe_sqrt
from .._types import Scalar, ScalarLike
from ..wind import Wind
from ._elfouhaily import Elfouhaily
from ._moments import BAND, height_variance
from ._spectrum import AbstractSpectrum
from ._swell import Swell
from .spreading import AbstractSpreading, Mitsuyasu

YOUNGEST = 5.0
"""Largest inverse wave age Ω of the unified spectrum."""

BISECTIONS = 24


class WindSeaAndSwell(eqx.Module):
    """A sea in two parts; `wind_sea + swell` has exactly the height that was measured.

    **Arguments:**

    - `wind_sea`: what the wind of the place has raised.
    - `swell`: the rest, at the phase speed that was measured.
    - `inverse_wave_age`: Ω of the wind sea [-].
    - `younger`: whether Ω was raised, since the wind sea would have been higher than all that was measured.
    """

    wind_sea: AbstractSpectrum
    swell: Swell
    inverse_wave_age: Scalar
    younger: Bool[Array, ""]

    def spectrum(self) -> AbstractSpectrum:
        """Both together."""
        return self.wind_sea + self.swell


def wind_sea_and_swell(
    wind: Wind,
    *,
    significant_wave_height: ScalarLike,
    peak_speed: ScalarLike,
    swell_direction: ScalarLike | None = None,
    swell_width: ScalarLike = 0.1,
    swell_spreading: AbstractSpreading | None = None,
    band: tuple[float, float] = BAND,
) -> WindSeaAndSwell:
    """The sea of a wind that has a given height, and whose longest waves have a given speed.

    $$ Ω = \\max(0.84, U_{10}/c_p), \\quad H_{swell}^2 = H_s^2 − H_{wind sea}^2(U_{10}, Ω),
       \\quad T_{swell} = 2πc_p/g $$

    The wind sea is Elfouhaily's, fully developed or as young as the speed c_p of its peak says. Where it alone would
    be higher than what was measured, the wind has not blown long enough: Ω is raised until it has just that height,
    and there is no swell. Where even Ω = 5 is too high, that sea is scaled down.

    **Arguments:**

    - `wind`: U10 and direction; without a fetch, since the heights say how developed the sea is.
    - `significant_wave_height`: Hs [m] of everything, more than 0.
    - `peak_speed`: c_p [m/s], the phase speed at the peak, in deep water.
    - `swell_direction`: towards which the swell travels [rad]; None: along the wind.
    - `swell_width`, `swell_spreading`: as `Swell` takes them.
    - `band`: of the waves [rad/m] that make up the height of the wind sea.

    **Returns:** `WindSeaAndSwell`, differentiable in all numbers.

    **Raises:** `ValueError` for a wind with a fetch, or a height or speed that is not positive.
    """
    if wind.fetch is not None:
        raise ValueError("Argument `wind` must have no fetch, since its sea is known, but has one.")
    height, speed = as_leaf(significant_wave_height), as_leaf(peak_speed)
    check_scalar("significant_wave_height", height, "m", positive=True)
    check_scalar("peak_speed", speed, "m/s", positive=True)
    variance = height**2 / 16
    oldest = jnp.clip(wind.speed / speed, wind.inverse_wave_age(), YOUNGEST)
    youngest = jnp.full_like(oldest, YOUNGEST)

    def wind_sea_variance(omega: Scalar) -> Scalar:
        return height_variance(Elfouhaily(wind, omega), band=band)

    most, least = jax.vmap(wind_sea_variance)(jnp.stack([oldest, youngest]))
    younger, fits = most > variance, least <= variance
    omega = jnp.where(younger, jnp.where(fits, _age(wind_sea_variance, variance, oldest), youngest), oldest)
    raised = wind_sea_variance(omega)
    factor = jnp.where(younger, variance / jnp.where(raised > 0, raised, 1.0), 1.0)
    rest = jnp.where(younger, 0.0, variance - raised)
    swell = Swell(
        significant_wave_height=4 * safe_sqrt(rest),
        peak_period=2 * jnp.pi * speed / GRAVITY,
        width=swell_width,
        direction=wind.direction if swell_direction is None else swell_direction,
        spreading=Mitsuyasu(75.0) if swell_spreading is None else swell_spreading,
    )
    return WindSeaAndSwell(factor * Elfouhaily(wind, omega), swell, omega, younger)


def _age(wind_sea_variance, variance: Scalar, oldest: Scalar) -> Scalar:
    """Ω whose wind sea has this variance: the variance falls with Ω, so halving an interval is safe."""

    def halve(_, interval):
        low, high = interval
        middle = jnp.sqrt(low * high)
        too_high = wind_sea_variance(middle) > variance
        return jnp.where(too_high, middle, low), jnp.where(too_high, high, middle)

    ends = jax.lax.stop_gradient((oldest, jnp.full_like(oldest, YOUNGEST)))
    low, high = jax.lax.stop_gradient(jax.lax.fori_loop(0, BISECTIONS, halve, ends))
    # One step of Newton's method in logarithms, which also carries the derivatives in wind and height.
    log_omega = jnp.log(jax.lax.stop_gradient(jnp.sqrt(low * high)))

    def excess(x: Scalar) -> Scalar:
        found = wind_sea_variance(jnp.exp(x))
        return jnp.log(jnp.where(found > 0, found, 1.0)) - jnp.log(variance)

    value, slope = jax.jvp(excess, (log_omega,), (jnp.ones_like(log_omega),))
    falls = slope < 0
    step = value / jax.lax.stop_gradient(jnp.where(falls, slope, 1.0))
    return jnp.exp(log_omega - jnp.where(falls, step, 0.0))
