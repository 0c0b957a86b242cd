"""The waves of a sea, and their spectrum at one time."""

from typing import NamedTuple

from jaxtyping import Array, Complex, Float, Int

from ._complex import scale
from ._phase import Clock, phase
from ._sincos import sincos_turns


class Waves(NamedTuple):
    """All that moves: ĥ(k, t) = cosine · cos ωt + sine · sin ωt, in the order of the FFT."""

    cosine: Complex[Array, "pattern y x"]
    sine: Complex[Array, "pattern y x"]
    rate: Float[Array, "pattern y x"]  # ω/2π [1/s]
    ticks: Int[Array, "pattern y x"] | None  # the same in whole numbers, see `_phase`


def height_spectrum(waves: Waves, clock: Clock) -> Complex[Array, "pattern y x"]:
    """ĥ(k, t) [m]."""
    sine, cosine = sincos_turns(phase(waves.rate, waves.ticks, clock))
    return scale(waves.cosine, cosine) + scale(waves.sine, sine)
