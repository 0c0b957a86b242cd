"""The spectrum of computer graphics: Phillips' k⁻⁴ with Tessendorf's directional factor."""

import math

import equinox as eqx
import jax.numpy as jnp
from jax.scipy.special import gammaln
from jaxtyping import Array, Float

from .._constants import GRAVITY
from .._numerics import as_leaf, check_scalar
from .._types import Scalar, ScalarLike
from ..wind import Wind
from ._spectrum import AbstractSpectrum, Harmonics, rotated_harmonics

CALM = 1e-3  # m/s; a calmer sea is flat
LONGEST = 9.0  # 1/(kL) beyond which exp(−1/(kL)²) counts as 0, in float32 too
CROSSWIND = 1e-6  # floor of |cos θ|, so that waves across the wind keep a finite logarithm


class Phillips(AbstractSpectrum):
    """A saturated sea below the waves that the wind can raise.

    $$ Ψ(k) = A \\frac{\\exp(−1/(kL)²)}{k⁴} |\\hat k·\\hat w|^{p} \\exp(−(kℓ)²), \\quad L = V²/g $$

    **The amplitude.** Here A is dimensionless and Ψ [m⁴] is a density, ∬Ψ dk = Var(η) = ½π A L² (for p = 2,
    ℓ = 0), whatever the grid. Tessendorf's A_T [m⁻²] sets the variance of one Fourier mode of one grid,
    E|h̃0|² = A_T exp(−1/(kL)²)/k⁴ |k̂·ŵ|² with η = Σ (h̃0(k) + h̃0*(−k)) e^{ik·x}, so that his sea changes with
    the size of the patch. With our E|h0|² = Ψ Δk²/2 and Δk = 2π/size the same sea has

    $$ A = 2 A_T / Δk² = 2 A_T (\\mathrm{size}/2π)² $$

    which is what `Phillips.from_tessendorf` does.

    **Arguments:**

    - `wind`: V is its speed, ŵ its direction.
    - `amplitude`: A [-], at least 0.
    - `exponent`: p [-] of the directional factor, 2 in Tessendorf's notes, larger is narrower.
    - `smallest_wave`: ℓ [m]: waves much shorter are suppressed; 0 keeps them all.
    - `opposing`: the share [-] of Ψ that waves against the wind keep, 1 (all, symmetric) to 0 (none).

    **Raises:** `ValueError` for a negative number or an `opposing` above 1.

    **Source:** Tessendorf 2004, Simulating Ocean Water (course notes).
    """

    wind: Wind
    amplitude: Scalar = eqx.field(converter=as_leaf)
    exponent: Scalar = eqx.field(converter=as_leaf, default=2.0, kw_only=True)
    smallest_wave: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    opposing: Scalar = eqx.field(converter=as_leaf, default=1.0, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("amplitude", self.amplitude, "", minimum=0.0)
        check_scalar("exponent", self.exponent, "", minimum=0.0)
        check_scalar("smallest_wave", self.smallest_wave, "m", minimum=0.0)
        check_scalar("opposing", self.opposing, "", minimum=0.0, maximum=1.0)

    @classmethod
    def from_tessendorf(
        cls,
        wind: Wind,
        *,
        amplitude: ScalarLike,
        size: float | int,
        exponent: ScalarLike = 2.0,
        smallest_wave: ScalarLike = 0.0,
        opposing: ScalarLike = 1.0,
    ) -> "Phillips":
        """The sea that Tessendorf's program shows with amplitude A_T [m⁻²] on a square patch of `size` [m].

        A student report's well-known case is A_T = 6e-7 with V = 30 m/s towards (1, 1) on 1000 m.
        """
        if not (math.isfinite(size) and size > 0):
            raise ValueError(f"Argument `size` must be greater than 0 m, but is {size:g} m.")
        check_scalar("amplitude", as_leaf(amplitude), "m⁻²", minimum=0.0)
        return cls(
            wind,
            2 * as_leaf(amplitude) * (size / (2 * math.pi)) ** 2,
            exponent=exponent,
            smallest_wave=smallest_wave,
            opposing=opposing,
        )

    def peak_wavenumber(self) -> Scalar:
        """The maximum of kΨ without the small-wave cut-off: √(2/3)/L [rad/m]."""
        return math.sqrt(2 / 3) / self._longest_wave()

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        cosine = jnp.cos(angle - self.wind.direction)
        directional = jnp.exp(self.exponent * jnp.log(jnp.maximum(jnp.abs(cosine), CROSSWIND)))
        return self._isotropic(wavenumber) * directional * jnp.where(cosine < 0, self.opposing, 1.0)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        p = self.exponent
        # ∫ |cos θ|ᵖ dθ over the circle; all harmonics are even, so the opposing half only scales them.
        whole = 2 * jnp.sqrt(jnp.pi) * jnp.exp(gammaln(0.5 * (p + 1)) - gammaln(0.5 * p + 1))
        mean = self._isotropic(wavenumber) * wavenumber * whole * 0.5 * (1 + self.opposing)
        second = p / (p + 2)
        return rotated_harmonics(mean, second, second * (p - 2) / (p + 4), self.wind.direction)

    def _isotropic(self, k: Float[Array, "*k"]) -> Float[Array, "*k"]:
        length = self._longest_wave()
        # 1/(kL), not its square, is bounded: the square of a calm sea's overflows in float32.
        inverse = jnp.minimum(1 / (k * length), LONGEST)
        shape = (length * inverse) ** 4 * jnp.exp(-(inverse**2) - (k * self.smallest_wave) ** 2)
        return self.amplitude * jnp.where((self.wind.speed > CALM) & (inverse < LONGEST), shape, 0.0)

    def _longest_wave(self) -> Scalar:
        """L = V²/g [m], the largest wave that the wind raises."""
        blows = self.wind.speed > CALM
        return jnp.where(blows, self.wind.speed, CALM) ** 2 / GRAVITY
