"""From a spectrum and random numbers to a sea."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Complex, PRNGKeyArray, UInt32

from ..._numerics import check_kind, leaf_dtype, safe_sqrt
from ...spectra import AbstractSpectrum, Dispersion
from ._cascade import Cascade
from ._cells import cell_energy
from ._complex import scale, turn
from ._evolve import Waves
from ._noise import draw_noise
from ._phase import wave_rate
from ._sea import Sea


def realise(
    spectrum: AbstractSpectrum,
    cascade: Cascade,
    *,
    key: PRNGKeyArray | UInt32[Array, "2"] | None = None,
    noise: Complex[Array, "pattern y x"] | None = None,
    dispersion: Dispersion | None = None,
    repeat_period: float | int | None = None,
) -> Sea:
    """A random sea with a given spectrum.

    $$ h_0(k) = \\sqrt{E(k)/2}\\, ξ(k), \\quad E|ξ|² = 1 $$

    with E(k) the spectrum's variance in the lattice cell of k: Var(η) = Σ E, whatever N and L are.
    Amplitudes are Gaussian, not only the phases.

    **Arguments:**

    - `spectrum`: Ψ [m⁴]; its floating-point type is that of the sea.
    - `cascade`: sizes, bands, resolution.
    - `key` or `noise`: exactly one; the noise of `draw_noise`, kept as a leaf.
    - `dispersion`: how fast waves travel; deep water by default.
    - `repeat_period`: T [s]; every frequency is rounded to a multiple of 2π/T, so that the sea repeats
      exactly.

    **Returns:** a `Sea`, differentiable in the spectrum, the noise and the dispersion.

    **Raises:** `ValueError` unless exactly one of `key` and `noise` is given; for a noise of the wrong
    shape or a repeat period that is not positive.
    """
    check_kind("spectrum", spectrum, AbstractSpectrum, "a spectrum such as `Elfouhaily(wind)`")
    check_kind("cascade", cascade, Cascade, "a `Cascade`")
    if noise is None:
        if key is None:
            raise ValueError("Give exactly one of `key` and `noise`, but neither is given.")
        noise = draw_noise(cascade, key)
    elif key is not None:
        raise ValueError("Give exactly one of `key` and `noise`, but both are given.")
    shape = (cascade.count, cascade.resolution, cascade.resolution)
    if noise.shape != shape:
        raise ValueError(f"Argument `noise` must have the cascade's shape {shape}, but has {noise.shape}.")
    if repeat_period is not None:
        repeat_period = float(repeat_period)
        if not (math.isfinite(repeat_period) and repeat_period > 0):
            raise ValueError(f"Argument `repeat_period` must be greater than 0 s, but is {repeat_period:g}.")
    dispersion = Dispersion() if dispersion is None else dispersion
    return _realise(spectrum, cascade, noise, dispersion, repeat_period)


@eqx.filter_jit
def _realise(
    spectrum: AbstractSpectrum,
    cascade: Cascade,
    noise: Complex[Array, "pattern y x"],
    dispersion: Dispersion,
    repeat_period: float | None,
) -> Sea:
    dtype = leaf_dtype(spectrum)
    noise = noise.astype(jnp.complex64 if dtype == jnp.float32 else jnp.complex128)
    amplitude = scale(noise, safe_sqrt(0.5 * cell_energy(spectrum, cascade)))
    opposite = jnp.roll(jnp.flip(jnp.conj(amplitude), (-2, -1)), 1, (-2, -1))
    dispersion = jax.tree.map(lambda leaf: leaf.astype(dtype), dispersion)
    rate, ticks = wave_rate(cascade, dispersion, repeat_period, dtype)
    return Sea(
        cascade=cascade,
        spectrum=spectrum,
        dispersion=dispersion,
        noise=noise,
        repeat_period=repeat_period,
        waves=Waves(amplitude + opposite, turn(opposite - amplitude), rate, ticks),
    )
