"""The fully developed sea of Pierson and Moskowitz (1964)."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import GRAVITY
from .._numerics import as_leaf, check_scalar
from .._types import Scalar, ScalarLike
from ..wind import Wind
from ._dispersion import Dispersion
from ._frequency import AbstractFrequencySpectrum
from ._jonswap_shape import alpha_from_height, height_from_alpha, pierson_moskowitz_shape
from .spreading import AbstractSpreading, Mitsuyasu

ALPHA = 0.0081
CALM = 1e-3  # m/s; the peak period of a calm sea is that of this wind, its height is 0


class PiersonMoskowitz(AbstractFrequencySpectrum):
    """A sea in balance with its wind.

    $$ E(f) = α g² (2π)^{−4} f^{−5} \\exp(−\\tfrac54 (f_p/f)^4) $$

    From a wind (`from_wind`) α = 0.0081 and the wind sets f_p. Built from a height and a period it is the
    two-parameter form (Bretschneider, ISSC), with α such that Hs is right.

    **Arguments:**

    - `significant_wave_height`: Hs [m], at least 0, over all frequencies.
    - `peak_period`: T_p [s].
    - `direction`: the mean direction towards which the waves travel [rad].
    - `spreading`: the directional spreading, `Mitsuyasu()` by default.
    - `dispersion`: how f and k go together; deep water without surface tension by default.

    **Raises:** `ValueError` for a negative height or a period that is not positive.

    **Source:** Pierson & Moskowitz 1964, J. Geophys. Res. 69(24).
    """

    significant_wave_height: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    peak_period: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    direction: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    spreading: AbstractSpreading = eqx.field(default_factory=Mitsuyasu, kw_only=True)
    dispersion: Dispersion = eqx.field(default_factory=Dispersion, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("significant_wave_height", self.significant_wave_height, "m", minimum=0.0)
        check_scalar("peak_period", self.peak_period, "s", positive=True)
        check_scalar("direction", self.direction, "rad")

    @classmethod
    def from_wind(
        cls,
        wind: Wind,
        *,
        spreading: AbstractSpreading | None = None,
        dispersion: Dispersion | None = None,
    ) -> "PiersonMoskowitz":
        """The fully developed sea of a wind: α = 0.0081, ω_p = (0.74/1.25)^¼ g/U_19.5.

        The wind at 19.5 m follows from U10 along the neutral logarithmic profile,
        U_19.5 = U10 + (u*/κ) ln 1.95, with u* of a fully developed sea.
        """
        speed = jnp.where(wind.speed > CALM, wind.at_height(19.5), CALM)
        peak_period = 2 * jnp.pi * speed / (GRAVITY * (0.74 / 1.25) ** 0.25)
        alpha = jnp.where(wind.speed > CALM, ALPHA, 0.0)
        return cls.from_alpha(
            alpha=alpha.astype(speed.dtype),
            peak_period=peak_period,
            direction=wind.direction,
            spreading=spreading,
            dispersion=dispersion,
        )

    @classmethod
    def from_alpha(
        cls,
        *,
        alpha: ScalarLike = ALPHA,
        peak_period: ScalarLike,
        direction: ScalarLike = 0.0,
        spreading: AbstractSpreading | None = None,
        dispersion: Dispersion | None = None,
    ) -> "PiersonMoskowitz":
        """The sea with Phillips constant α [-] and peak period T_p [s]."""
        alpha, peak_period = as_leaf(alpha), as_leaf(peak_period)
        check_scalar("alpha", alpha, "", minimum=0.0)
        return cls(
            significant_wave_height=height_from_alpha(alpha, peak_period, 0.2),
            peak_period=peak_period,
            direction=direction,
            spreading=Mitsuyasu() if spreading is None else spreading,
            dispersion=Dispersion() if dispersion is None else dispersion,
        )

    def alpha(self) -> Scalar:
        """The Phillips constant α [-]."""
        return alpha_from_height(self.significant_wave_height, self.peak_period, 0.2)

    def energy(self, frequency: Float[Array, "*k"], wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        del wavenumber
        variance = self.significant_wave_height**2 / 16
        return variance * self.peak_period / 0.2 * pierson_moskowitz_shape(frequency * self.peak_period)
