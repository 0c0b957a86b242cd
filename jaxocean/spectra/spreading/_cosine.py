"""Spreading by powers of a cosine: D ∝ cos²ˢ(θ/2), with three laws for s."""

import equinox as eqx
import jax.numpy as jnp
from jax.scipy.special import gammaln
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar
from ..._types import Scalar
from ._spreading import AbstractSpreading, WavePeak

OPPOSITE = 1e-12  # floor of cos²(θ/2), so that opposite directions keep a finite logarithm
LARGEST = 1e4  # of s: a beam of about one degree


def cosine_power(offset: Float[Array, "*k"], s: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """The normalised beam [1/rad].

    $$ D(θ) = \\frac{Γ(s + 1)}{2\\sqrt{π}\\,Γ(s + ½)} \\cos^{2s}(θ/2) $$

    **Source:** Longuet-Higgins, Cartwright & Smith 1963.
    """
    s = jnp.minimum(s, LARGEST)
    log_cosine = jnp.log(jnp.maximum(0.5 * (1 + jnp.cos(offset)), OPPOSITE))
    return jnp.exp(gammaln(s + 1) - gammaln(s + 0.5) + s * log_cosine) / (2 * jnp.sqrt(jnp.pi))


def cosine_harmonics(s: Float[Array, "*k"]) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
    """∫ D cos 2θ dθ and ∫ D cos 4θ dθ [-] of `cosine_power`, which are rational in s."""
    s = jnp.minimum(s, LARGEST)
    second = s / (s + 1) * ((s - 1) / (s + 2))
    return second, second * ((s - 2) / (s + 3)) * ((s - 3) / (s + 4))


class Cosine2s(AbstractSpreading):
    """One exponent for all waves: D ∝ cos²ˢ(θ/2).

    **Arguments:** `s`: the spreading parameter [-], at least 0: 0 is isotropic, 10 a wind sea, 75 long swell.
    """

    s: Scalar = eqx.field(converter=as_leaf)

    def __check_init__(self) -> None:
        check_scalar("s", self.s, "", minimum=0.0)

    def density(self, offset: Float[Array, "*k"], wave: WavePeak) -> Float[Array, "*k"]:
        return cosine_power(offset, self._parameter(wave))

    def harmonics(self, wave: WavePeak) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
        return cosine_harmonics(self._parameter(wave))

    def _parameter(self, wave: WavePeak) -> Float[Array, "*k"]:
        return self.s * jnp.ones_like(wave.frequency_ratio)


class Mitsuyasu(AbstractSpreading):
    """Narrowest at the peak, broader on both sides.

    $$ s = s_{max} \\min\\left((f/f_p)^5, (f/f_p)^{-2.5}\\right) $$

    **Arguments:** `s_max`: s at the peak [-]: 10 for wind waves (default), 25 for young and 75 for old swell.

    **Source:** Mitsuyasu et al. 1975 in the form of Goda & Suzuki 1975.
    """

    s_max: Scalar = eqx.field(converter=as_leaf, default=10.0)

    def __check_init__(self) -> None:
        check_scalar("s_max", self.s_max, "", minimum=0.0)

    def density(self, offset: Float[Array, "*k"], wave: WavePeak) -> Float[Array, "*k"]:
        return cosine_power(offset, self._parameter(wave))

    def harmonics(self, wave: WavePeak) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
        return cosine_harmonics(self._parameter(wave))

    def _parameter(self, wave: WavePeak) -> Float[Array, "*k"]:
        ratio = wave.frequency_ratio
        below = ratio <= 1
        return self.s_max * jnp.where(
            below, jnp.where(below, ratio, 1.0) ** 5, jnp.where(below, 1.0, ratio) ** -2.5
        )


class Hasselmann1980(AbstractSpreading):
    """The JONSWAP experiment's directional measurements; the decay above the peak depends on the wave age.

    $$ s = \\min\\left(6.97\\,(f/f_p)^{4.06},\\; 9.77\\,(f/f_p)^{μ}\\right), \\quad
       μ = −2.33 − 1.45\\,(U/c_p − 1.17) $$

    The paper changes branch at f = 1.05 f_p, where the two differ by 2 %; the minimum changes where they meet
    (1.054 f_p at U/c_p = 1.17) and is continuous.

    **Arguments:** `inverse_wave_age`: U10/c_p [-].

    **Source:** Hasselmann, Dunckel & Ewing 1980, J. Phys. Oceanogr. 10, 1264–1280.
    """

    inverse_wave_age: Scalar = eqx.field(converter=as_leaf, default=1.17)

    def __check_init__(self) -> None:
        check_scalar("inverse_wave_age", self.inverse_wave_age, "", positive=True)

    def density(self, offset: Float[Array, "*k"], wave: WavePeak) -> Float[Array, "*k"]:
        return cosine_power(offset, self._parameter(wave))

    def harmonics(self, wave: WavePeak) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
        return cosine_harmonics(self._parameter(wave))

    def _parameter(self, wave: WavePeak) -> Float[Array, "*k"]:
        decay = -2.33 - 1.45 * (self.inverse_wave_age - 1.17)
        log_ratio = jnp.log(jnp.maximum(wave.frequency_ratio, 1e-6))
        growth = jnp.log(6.97) + 4.06 * log_ratio
        return jnp.exp(jnp.minimum(growth, jnp.log(9.77) + decay * log_ratio))
