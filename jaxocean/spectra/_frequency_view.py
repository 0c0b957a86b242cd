"""Any spectrum as a function of frequency, and its peak."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import leaf_dtype
from .._types import Scalar
from ._dispersion import Dispersion
from ._spectrum import AbstractSpectrum, ScaledSpectrum, SumSpectrum

FREQUENCIES = (0.005, 5.0)
"""Default range [Hz] in which the peak is sought."""


def frequency_spectrum(
    spectrum: AbstractSpectrum, frequency: Float[Array, "*f"], dispersion: Dispersion | None = None
) -> Float[Array, "*f"]:
    """The omnidirectional frequency spectrum of any spectrum.

    $$ E(f) = 2π \\left(\\frac{dω}{dk}\\right)^{−1} ∫ Ψ(k, φ)\\, k\\, dφ $$

    **Arguments:** `frequency` f > 0 [Hz]; `dispersion` relates f and k: if None, that of the spectrum itself
    where it has one (of a sum: its first), else deep water.

    **Returns:** E(f) [m²/Hz].
    """
    relation = own_dispersion(spectrum) if dispersion is None else dispersion
    k = relation.wavenumber(2 * jnp.pi * frequency)
    return spectrum.harmonics(k).mean * 2 * jnp.pi / relation.group_speed(k)


def peak_period(
    spectrum: AbstractSpectrum,
    dispersion: Dispersion | None = None,
    *,
    frequencies: tuple[float, float] = FREQUENCIES,
) -> Scalar:
    """The peak period T_p [s]: where E(f) is largest.

    A coarse search over log f, a fine one around its maximum, then the vertex of the parabola through the
    three highest points of log E. Differentiable: the vertex moves with E. A calm sea gives a finite but
    meaningless number.

    **Arguments:** `dispersion` as in `frequency_spectrum`; `frequencies`: the range of the search [Hz].

    **Raises:** `ValueError` for a range that is not 0 < lower < upper.
    """
    lower, upper = frequencies
    if not 0 < lower < upper < float("inf"):
        raise ValueError(
            "Argument `frequencies` must be (lower, upper) with 0 < lower < upper in Hz, "
            f"but is ({lower:g}, {upper:g})."
        )
    dtype = leaf_dtype(spectrum)

    def log_energy(log_frequency: Float[Array, " f"]) -> Float[Array, " f"]:
        energy = frequency_spectrum(spectrum, jnp.exp(log_frequency), dispersion)
        return jnp.log(jnp.maximum(energy, jnp.finfo(dtype).tiny))

    coarse = jnp.asarray(np.linspace(np.log(lower), np.log(upper), 400), dtype)
    step = float(np.log(upper / lower)) / 399
    centre = jax.lax.stop_gradient(coarse[jnp.argmax(log_energy(coarse))])
    fine = centre + jnp.asarray(np.linspace(-step, step, 65), dtype)
    values = log_energy(fine)
    highest = jnp.clip(jnp.argmax(values), 1, 63)
    left, middle, right = values[highest - 1], values[highest], values[highest + 1]
    bend = left - 2 * middle + right
    bends = bend < 0
    shift = jnp.where(bends, 0.5 * (left - right) / jnp.where(bends, bend, 1.0), 0.0)
    # On a straight flank (the peak lies outside the range) the vertex is far away: stay at the edge.
    return jnp.exp(-(fine[highest] + jnp.clip(shift, -1.0, 1.0) * (step / 32)))


def own_dispersion(spectrum: AbstractSpectrum) -> Dispersion:
    """The dispersion relation that a spectrum carries, else deep water."""
    if isinstance(spectrum, SumSpectrum):
        return own_dispersion(spectrum.first)
    if isinstance(spectrum, ScaledSpectrum):
        return own_dispersion(spectrum.spectrum)
    own = getattr(spectrum, "dispersion", None)
    return own if isinstance(own, Dispersion) else Dispersion()
