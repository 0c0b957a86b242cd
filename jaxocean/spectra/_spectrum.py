"""What a directional wavenumber spectrum is, and how spectra add and scale."""

import abc
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar, leaf_dtype, periodic_nodes, safe_angle, safe_norm
from .._types import Scalar, ScalarLike


class Harmonics(NamedTuple):
    """Angular harmonics of a spectrum: ∫ Ψ(k, φ) k {1, cos 2φ, sin 2φ, cos 4φ, sin 4φ} dφ [m³].

    They are all that the second moments of height, slope and strain need.
    """

    mean: Float[Array, "*k"]
    cos2: Float[Array, "*k"]
    sin2: Float[Array, "*k"]
    cos4: Float[Array, "*k"]
    sin4: Float[Array, "*k"]


def rotated_harmonics(
    mean: Float[Array, "*k"],
    second: Float[Array, "*#k"],
    fourth: Float[Array, "*#k"],
    direction: Scalar,
) -> Harmonics:
    """Harmonics of a distribution symmetric about `direction` [rad], from those about its own axis."""
    return Harmonics(
        mean,
        mean * second * jnp.cos(2 * direction),
        mean * second * jnp.sin(2 * direction),
        mean * fourth * jnp.cos(4 * direction),
        mean * fourth * jnp.sin(4 * direction),
    )


class AbstractSpectrum(eqx.Module):
    """A directional wavenumber spectrum Ψ(kx, ky) [m⁴]: waves travel along +k, ∬Ψ dkx dky = Var(η).

    Spectra add (`wind_sea + swell`) and scale (`2.0 * spectrum` doubles the variance).
    """

    @abc.abstractmethod
    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        """Ψ [m⁴] at wavenumber k > 0 [rad/m] and direction φ [rad] (towards, counter-clockwise from +x)."""

    @abc.abstractmethod
    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        """Angular harmonics [m³] at wavenumbers k > 0 [rad/m]."""

    def kinks(self) -> Float[Array, " n"]:
        """Wavenumbers [rad/m] where the spectrum jumps or bends and a quadrature should split; often none."""
        return jnp.zeros(0, leaf_dtype(self))

    def __call__(self, kx: Float[Array, "*#k"], ky: Float[Array, "*#k"]) -> Float[Array, "..."]:
        """Ψ(kx, ky) [m⁴] at wave vectors [rad/m]; 0, with finite derivatives, at k = 0."""
        kx, ky = jnp.broadcast_arrays(as_leaf(kx), as_leaf(ky))
        k = safe_norm(kx, ky)
        moves = k > 0
        density = self.density(jnp.where(moves, k, 1.0), safe_angle(kx, ky))
        return jnp.where(moves, density, 0.0)

    def __add__(self, other: "AbstractSpectrum") -> "SumSpectrum":
        if not isinstance(other, AbstractSpectrum):
            return NotImplemented
        return SumSpectrum(self, other)

    def __mul__(self, factor: ScalarLike) -> "ScaledSpectrum":
        if isinstance(factor, AbstractSpectrum):
            return NotImplemented
        return ScaledSpectrum(self, factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: ScalarLike) -> "ScaledSpectrum":
        return NotImplemented if isinstance(divisor, AbstractSpectrum) else ScaledSpectrum(self, 1 / divisor)

    def __radd__(self, other: object) -> "AbstractSpectrum":
        # `sum` starts with 0.
        return self if isinstance(other, int) and other == 0 else NotImplemented


class SumSpectrum(AbstractSpectrum):
    """Two independent wave systems on one sea: Ψ = Ψ₁ + Ψ₂ [m⁴]."""

    first: AbstractSpectrum
    second: AbstractSpectrum

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return self.first.density(wavenumber, angle) + self.second.density(wavenumber, angle)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        pairs = zip(self.first.harmonics(wavenumber), self.second.harmonics(wavenumber), strict=True)
        return Harmonics(*(a + b for a, b in pairs))

    def kinks(self) -> Float[Array, " n"]:
        return jnp.concatenate([self.first.kinks(), self.second.kinks()])


class ScaledSpectrum(AbstractSpectrum):
    """A spectrum with its variance multiplied by `factor` ≥ 0 (the heights by √factor)."""

    spectrum: AbstractSpectrum
    factor: Scalar = eqx.field(converter=as_leaf)

    def __check_init__(self) -> None:
        check_scalar("factor", self.factor, "", minimum=0.0)

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        return self.factor * self.spectrum.density(wavenumber, angle)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        return Harmonics(*(self.factor * h for h in self.spectrum.harmonics(wavenumber)))

    def kinks(self) -> Float[Array, " n"]:
        return self.spectrum.kinks()


def integrate_harmonics(
    spectrum: AbstractSpectrum, wavenumber: Float[Array, "*k"], *, directions: int = 128
) -> Harmonics:
    """Harmonics of any spectrum by the trapezoidal rule over `directions` angles.

    It converges geometrically where the spectrum is smooth in direction.
    """
    angles, weight = periodic_nodes(directions)
    phi = jnp.asarray(angles, wavenumber.dtype)
    k = wavenumber[..., None]
    k, phi_grid = jnp.broadcast_arrays(k, phi)
    density = spectrum.density(k, phi_grid) * k * weight
    basis = jnp.stack(
        [jnp.ones_like(phi), jnp.cos(2 * phi), jnp.sin(2 * phi), jnp.cos(4 * phi), jnp.sin(4 * phi)], axis=-1
    )
    return Harmonics(*jnp.moveaxis(density @ basis, -1, 0))
