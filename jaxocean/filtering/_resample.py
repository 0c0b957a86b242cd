"""A periodic pattern at the points of a rectangular lattice, exactly."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float


def resample(
    samples: Float[Array, "rows columns channel"],
    size: float,
    x: Float[np.ndarray, " x"],
    y: Float[np.ndarray, " y"],
) -> Float[Array, "y x channel"]:
    """The waves of one pattern, summed at all (x, y) of a lattice: two matrix products for each channel.

    $$ f(x, y) = \\sum_{k_x, k_y} \\hat f(k) e^{i(k_x x + k_y y)} $$

    **Arguments:** `samples`: N × N samples of a field without waves at its Nyquist wavenumber, as all fields of a sea
    are; `size` L [m] of the pattern; `x`, `y` [m], reduced in float64.

    **Returns:** values at the lattice's points, indexed [y, x].
    """
    count = samples.shape[0]
    index = np.fft.fftfreq(count, 1 / count)
    tables = []
    for along, waves in ((y, index), (x, index[: count // 2])):
        turns = np.outer(np.remainder(along, size) / size, waves)
        tables.append(np.exp(2j * np.pi * (turns - np.round(turns))))
    dtype = jnp.complex64 if samples.dtype == jnp.float32 else jnp.complex128
    return _sum(samples, jnp.asarray(tables[0], dtype), jnp.asarray(tables[1], dtype))


@eqx.filter_jit
def _sum(
    samples: Float[Array, "n n c"], rows: Complex[Array, "y n"], columns: Complex[Array, "x half"]
) -> Float[Array, "y x c"]:
    count = samples.shape[0]
    waves = jnp.fft.fft2(jnp.moveaxis(samples, -1, 0))[:, :, : count // 2] / count**2
    # The waves with −kx are the conjugates of those kept; those with kx = 0 stand once.
    often = np.where(np.arange(count // 2) > 0, 2.0, 1.0)
    known = np.fft.fftfreq(count, 1 / count) != -(count // 2)
    waves = waves * jnp.asarray(known[:, None] * often, waves.dtype)

    def one(wave: Complex[Array, "n half"]) -> Float[Array, "y x"]:
        part = rows @ wave
        return part.real @ columns.real.T - part.imag @ columns.imag.T

    return jnp.stack([one(wave) for wave in waves], axis=-1)
