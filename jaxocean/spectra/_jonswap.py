"""The growing sea of the Joint North Sea Wave Project."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import GRAVITY
from .._numerics import as_leaf, check_scalar
from .._types import Scalar, ScalarLike
from ..wind import Wind
from ._dispersion import Dispersion
from ._frequency import AbstractFrequencySpectrum
from ._jonswap_shape import (
    alpha_from_height,
    height_from_alpha,
    jonswap_integral,
    log_enhancement,
    pierson_moskowitz_shape,
)
from .spreading import AbstractSpreading, Mitsuyasu

CALM = 1e-3  # m/s; the peak period of a calm sea is that of this wind, its height is 0
WIDTH_BELOW, WIDTH_ABOVE = 0.07, 0.09


class JONSWAP(AbstractFrequencySpectrum):
    """A Pierson–Moskowitz shape with an enhanced peak.

    $$ E(f) = α g² (2π)^{−4} f^{−5} \\exp(−\\tfrac54 (f_p/f)^4)\\, γ^{Γ}, \\quad
       Γ = \\exp\\left(−\\frac{(f/f_p − 1)²}{2σ²}\\right) $$

    α is such that Hs, over all frequencies, is exactly the given one (by quadrature, not by a fit in γ).
    `JONSWAP.from_fetch` has α and f_p from wind and fetch, `JONSWAP.from_alpha` has α itself.

    **Arguments:**

    - `significant_wave_height`: Hs [m], at least 0.
    - `peak_period`: T_p = 1/f_p [s].
    - `peak_enhancement`: γ [-], 3.3 on average, 1 is Pierson–Moskowitz.
    - `direction`: the mean direction towards which the waves travel [rad].
    - `spreading`: the directional spreading, `Mitsuyasu()` by default.
    - `dispersion`: how f and k go together; deep water without surface tension by default.
    - `width_below`, `width_above`: σ [-] of the peak on its two sides.

    **Raises:** `ValueError` for a negative height, or a period, γ or σ that is not positive.

    **Source:** Hasselmann et al. 1973, Dtsch. Hydrogr. Z. Suppl. A8(12).
    """

    significant_wave_height: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    peak_period: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    peak_enhancement: Scalar = eqx.field(converter=as_leaf, default=3.3, kw_only=True)
    direction: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    spreading: AbstractSpreading = eqx.field(default_factory=Mitsuyasu, kw_only=True)
    dispersion: Dispersion = eqx.field(default_factory=Dispersion, kw_only=True)
    width_below: Scalar = eqx.field(converter=as_leaf, default=WIDTH_BELOW, kw_only=True)
    width_above: Scalar = eqx.field(converter=as_leaf, default=WIDTH_ABOVE, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("significant_wave_height", self.significant_wave_height, "m", minimum=0.0)
        check_scalar("peak_period", self.peak_period, "s", positive=True)
        check_scalar("peak_enhancement", self.peak_enhancement, "", positive=True)
        check_scalar("direction", self.direction, "rad")
        check_scalar("width_below", self.width_below, "", positive=True)
        check_scalar("width_above", self.width_above, "", positive=True)

    @classmethod
    def from_fetch(
        cls,
        wind: Wind,
        *,
        fetch: ScalarLike | None = None,
        peak_enhancement: ScalarLike = 3.3,
        spreading: AbstractSpreading | None = None,
        dispersion: Dispersion | None = None,
    ) -> "JONSWAP":
        """The sea that a wind raises over a fetch X.

        $$ α = 0.076\\, X̃^{−0.22}, \\quad f_p = 3.5\\,(g/U)\\, X̃^{−0.33}, \\quad X̃ = gX/U² $$

        **Arguments:** `wind`: U10 and direction; `fetch` X [m], here or on the wind, not both.

        **Raises:** `ValueError` if there is no fetch, or two.
        """
        if fetch is not None and wind.fetch is None:
            length = as_leaf(fetch)
        elif fetch is None and wind.fetch is not None:
            length = wind.fetch
        else:
            given = "neither is" if fetch is None else "both are"
            raise ValueError(f"Give exactly one of `fetch` and the wind's own `fetch`, but {given} given.")
        check_scalar("fetch", length, "m", positive=True)
        blows = wind.speed > CALM
        speed = jnp.where(blows, wind.speed, CALM)
        dimensionless = GRAVITY * length / speed**2
        return cls.from_alpha(
            alpha=jnp.where(blows, 0.076 * dimensionless**-0.22, 0.0),
            peak_period=speed * dimensionless**0.33 / (3.5 * GRAVITY),
            peak_enhancement=peak_enhancement,
            direction=wind.direction,
            spreading=spreading,
            dispersion=dispersion,
        )

    @classmethod
    def from_alpha(
        cls,
        *,
        alpha: ScalarLike,
        peak_period: ScalarLike,
        peak_enhancement: ScalarLike = 3.3,
        direction: ScalarLike = 0.0,
        spreading: AbstractSpreading | None = None,
        dispersion: Dispersion | None = None,
    ) -> "JONSWAP":
        """The sea with Phillips constant α [-] and peak period T_p [s]."""
        alpha, peak_period, gamma = as_leaf(alpha), as_leaf(peak_period), as_leaf(peak_enhancement)
        check_scalar("alpha", alpha, "", minimum=0.0)
        below, above = jnp.asarray(WIDTH_BELOW, gamma.dtype), jnp.asarray(WIDTH_ABOVE, gamma.dtype)
        integral = jonswap_integral(gamma, below, above)
        return cls(
            significant_wave_height=height_from_alpha(alpha, peak_period, integral),
            peak_period=peak_period,
            peak_enhancement=gamma,
            direction=direction,
            spreading=Mitsuyasu() if spreading is None else spreading,
            dispersion=Dispersion() if dispersion is None else dispersion,
            width_below=below,
            width_above=above,
        )

    def alpha(self) -> Scalar:
        """The Phillips constant α [-]."""
        return alpha_from_height(self.significant_wave_height, self.peak_period, self._integral())

    def energy(self, frequency: Float[Array, "*k"], wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        del wavenumber
        ratio = frequency * self.peak_period
        enhancement = log_enhancement(ratio, self.peak_enhancement, self.width_below, self.width_above)
        shape = pierson_moskowitz_shape(ratio) * jnp.exp(enhancement)
        return self.significant_wave_height**2 / 16 * self.peak_period / self._integral() * shape

    def _integral(self) -> Scalar:
        return jonswap_integral(self.peak_enhancement, self.width_below, self.width_above)
