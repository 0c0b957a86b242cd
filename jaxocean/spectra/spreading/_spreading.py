"""What a directional spreading law is."""

import abc
from typing import NamedTuple

import equinox as eqx
from jaxtyping import Array, Float

from ..._types import Scalar


class WavePeak(NamedTuple):
    """Where waves lie with respect to the peak of their spectrum: what a spreading law depends on.

    - `frequency_ratio`: f/f_p [-] of each wave.
    - `wavenumber`: k [rad/m] of each wave.
    - `peak_speed`: phase speed of the peak in deep water, c_p = g/ω_p [m/s].
    """

    frequency_ratio: Float[Array, "*k"]
    wavenumber: Float[Array, "*k"]
    peak_speed: Scalar


class AbstractSpreading(eqx.Module):
    """A directional distribution D [1/rad], symmetric about the mean direction, with ∫ D dθ = 1."""

    @abc.abstractmethod
    def density(self, offset: Float[Array, "*k"], wave: WavePeak) -> Float[Array, "*k"]:
        """D [1/rad] at the angle `offset` [rad] from the mean direction."""

    @abc.abstractmethod
    def harmonics(self, wave: WavePeak) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
        """∫ D cos 2θ dθ and ∫ D cos 4θ dθ [-]; the sines vanish by symmetry."""
