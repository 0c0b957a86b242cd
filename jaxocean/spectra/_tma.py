"""The wind sea of finite depth: Texel, MARSEN, ARSLOE."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar, safe_divide
from .._types import Scalar
from ._dispersion import Dispersion
from ._frequency import AbstractFrequencySpectrum
from ._jonswap import WIDTH_ABOVE, WIDTH_BELOW
from ._jonswap_shape import alpha_from_height, log_enhancement, pierson_moskowitz_shape
from .spreading import AbstractSpreading, Mitsuyasu


def _panels() -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights in log(k/k_p), graded towards the peak, where the shape has a kink."""
    steps = (0.04, 0.08, 0.16, 0.3, 0.5, 0.8, 1.6)
    edges = np.array([*(-np.cumsum((*steps, 2.0))[::-1]), 0.0, *np.cumsum((*steps, 2.0, 2.0, 2.0))])
    x, w = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(edges)[:, None]
    nodes = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * x).ravel()
    return nodes, (half * w).ravel()


NODES, WEIGHTS = _panels()
DEEP = 80.0  # 2kd beyond which the depth factor is 1 to rounding; keeps sinh finite in float32


def depth_factor(wavenumber: Float[Array, "*k"], depth: Scalar) -> Float[Array, "*k"]:
    """Kitaigorodskii's factor on E(f) [-]: ½(ωd)²/(gd) in shallow water, 1 in deep.

    $$ φ = \\frac{\\tanh² kd}{1 + 2kd/\\sinh 2kd} $$

    **Source:** Bouws, Günther, Rosenthal & Vincent 1985, J. Geophys. Res. 90(C1), 975–986.
    """
    double = jnp.minimum(2 * wavenumber * depth, DEEP)
    small = double < 1e-3
    over_sinh = jnp.where(small, 1 - double**2 / 6, safe_divide(double, jnp.sinh(double)))
    return jnp.tanh(0.5 * double) ** 2 / (1 + over_sinh)


class TMA(AbstractFrequencySpectrum):
    """A JONSWAP sea whose waves feel the bottom.

    $$ E(f) = E_{JONSWAP}(f)\\, φ(k(f), d) $$

    Hs is that of the result, over all frequencies: α follows from it by quadrature.

    **Arguments:**

    - `significant_wave_height`: Hs [m], at least 0.
    - `peak_period`: T_p [s] of the JONSWAP factor; φ moves the maximum of E(f) slightly up in frequency.
    - `dispersion`: must have a depth.
    - `peak_enhancement`: γ [-].
    - `direction`: the mean direction towards which the waves travel [rad].
    - `spreading`: the directional spreading, `Mitsuyasu()` by default.
    - `width_below`, `width_above`: σ [-] of the peak on its two sides.

    **Raises:** `ValueError` without a depth, for a negative height, or a period, γ or σ that is not positive.

    **Source:** Bouws, Günther, Rosenthal & Vincent 1985, J. Geophys. Res. 90(C1), 975–986.
    """

    significant_wave_height: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    peak_period: Scalar = eqx.field(converter=as_leaf, kw_only=True)
    dispersion: Dispersion = eqx.field(kw_only=True)
    peak_enhancement: Scalar = eqx.field(converter=as_leaf, default=3.3, kw_only=True)
    direction: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    spreading: AbstractSpreading = eqx.field(default_factory=Mitsuyasu, kw_only=True)
    width_below: Scalar = eqx.field(converter=as_leaf, default=WIDTH_BELOW, kw_only=True)
    width_above: Scalar = eqx.field(converter=as_leaf, default=WIDTH_ABOVE, kw_only=True)

    def __check_init__(self) -> None:
        if self.dispersion.depth is None:
            raise ValueError(
                "Argument `dispersion` must have a depth for TMA, but is deep water: use JONSWAP there."
            )
        check_scalar("significant_wave_height", self.significant_wave_height, "m", minimum=0.0)
        check_scalar("peak_period", self.peak_period, "s", positive=True)
        check_scalar("peak_enhancement", self.peak_enhancement, "", positive=True)
        check_scalar("direction", self.direction, "rad")
        check_scalar("width_below", self.width_below, "", positive=True)
        check_scalar("width_above", self.width_above, "", positive=True)

    def alpha(self) -> Scalar:
        """The Phillips constant α [-] of the JONSWAP factor."""
        return alpha_from_height(self.significant_wave_height, self.peak_period, self._integral())

    def energy(self, frequency: Float[Array, "*k"], wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        scale = self.significant_wave_height**2 / 16 * self.peak_period / self._integral()
        return scale * self._shape(frequency * self.peak_period, wavenumber)

    def _shape(self, ratio: Float[Array, "*k"], wavenumber: Float[Array, "*k"]) -> Float[Array, "*k"]:
        enhancement = log_enhancement(ratio, self.peak_enhancement, self.width_below, self.width_above)
        return pierson_moskowitz_shape(ratio) * jnp.exp(enhancement) * depth_factor(wavenumber, self._depth())

    def _integral(self) -> Scalar:
        """∫ of the shape over f/f_p, taken over log k, where φ and f are explicit."""
        k = self.peak_wavenumber() * jnp.exp(jnp.asarray(NODES, self.peak_period.dtype))
        ratio = self.dispersion.frequency(k) * self.peak_period / (2 * jnp.pi)
        per_log_wavenumber = self.dispersion.group_speed(k) * k * self.peak_period / (2 * jnp.pi)
        return jnp.sum(jnp.asarray(WEIGHTS, k.dtype) * self._shape(ratio, k) * per_log_wavenumber)

    def _depth(self) -> Scalar:
        depth = self.dispersion.depth
        assert depth is not None  # checked when the spectrum was built
        return depth
