"""What a sea does above the highest frequency that was measured.

Buoys stop near 0.5 Hz (1 rad/m), the strain that breaks waves lives at 1 to 73 rad/m and beyond: whitecap
coverage of a measured sea is decided by its tail, so the tail is always named.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar, optional_leaf
from ..._types import Scalar
from ...wind import Wind
from .._elfouhaily import Elfouhaily
from .._spectrum import AbstractSpectrum


class AbstractTail(eqx.Module):
    """How a measured spectrum goes on above its cut-off frequency f_c."""

    @abc.abstractmethod
    def continuation(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """The factor [-] on the spectrum measured at f_c, E(f_c, φ), at `ratio` = f/f_c > 1."""

    @abc.abstractmethod
    def model(self) -> AbstractSpectrum | None:
        """A model spectrum that is blended in above f_c, or None."""

    @abc.abstractmethod
    def share(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """The share [-] of the model at `ratio` = f/f_c > 1."""


class NoTail(AbstractTail):
    """Nothing above the cut-off: a lower bound, of use only for heights."""

    def continuation(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return jnp.zeros_like(ratio)

    def model(self) -> AbstractSpectrum | None:
        return None

    def share(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return jnp.zeros_like(ratio)


class PowerTail(AbstractTail):
    """A power law in frequency, continuous at the cut-off, with the directions of the last measured bins.

    $$ E(f, φ) = E(f_c, φ)\\, (f/f_c)^{n} $$

    **Arguments:** `exponent`: n [-], −5 (Phillips' saturation, the default) or −4 (equilibrium range).

    **Raises:** `ValueError` for an exponent of −1 or more: the variance would be infinite.
    """

    exponent: Scalar = eqx.field(converter=as_leaf, default=-5.0)

    def __check_init__(self) -> None:
        check_scalar("exponent", self.exponent, "", maximum=-1.01)

    def continuation(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return ratio**self.exponent

    def model(self) -> AbstractSpectrum | None:
        return None

    def share(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return jnp.zeros_like(ratio)


class ElfouhailyTail(AbstractTail):
    """The unified spectrum of a wind, blended in above the cut-off.

    $$ Ψ = (1 − w)\\, Ψ_{power} + w\\, Ψ_{Elfouhaily} $$

    where w rises smoothly in log f from 0 at f_c to 1 at `blend`·f_c. What was measured is left alone.

    **Arguments:**

    - `wind`: the wind over the measured sea.
    - `inverse_wave_age`: Ω of the unified spectrum, as `Elfouhaily` takes it.
    - `blend`: the frequency ratio over which the two are blended [-], greater than 1.
    - `exponent`: of the power law that the measured spectrum follows meanwhile.

    **Raises:** `ValueError` for a blend that is not greater than 1.
    """

    wind: Wind
    inverse_wave_age: Scalar | None = eqx.field(converter=optional_leaf, default=None)
    blend: Scalar = eqx.field(converter=as_leaf, default=1.5, kw_only=True)
    exponent: Scalar = eqx.field(converter=as_leaf, default=-5.0, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("blend", self.blend, "", minimum=1.01)
        check_scalar("exponent", self.exponent, "", maximum=-1.01)

    def continuation(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return ratio**self.exponent * (1 - self.share(ratio))

    def model(self) -> AbstractSpectrum | None:
        return Elfouhaily(self.wind, self.inverse_wave_age)

    def share(self, ratio: Float[Array, "*k"]) -> Float[Array, "*k"]:
        x = jnp.clip(jnp.log(ratio) / jnp.log(self.blend), 0.0, 1.0)
        return x * x * (3 - 2 * x)
