"""More samples of the same waves."""

import jax.numpy as jnp
from jaxtyping import Array, Float


def refine(samples: Float[Array, "*b y x c"], factor: int) -> Float[Array, "*b Y X c"]:
    """Periodic fields on `factor` times as many samples a side, exactly: their spectrum with zeros around it.

    **Arguments:** `samples`: N × N samples of fields without waves at the Nyquist wavenumber, as all fields of a sea
    are, channels last; `factor`: 1 leaves them as they are.

    **Raises:** `ValueError` for a factor below 1.
    """
    if factor < 1:
        raise ValueError(f"Argument `factor` must be at least 1, but is {factor}.")
    if factor == 1:
        return samples
    count, half = samples.shape[-2], samples.shape[-2] // 2
    waves = jnp.fft.rfft2(samples, axes=(-3, -2)) * factor**2
    zeros = [(0, 0)] * (samples.ndim - 3)
    # Waves 0 … N/2 − 1 stand first and −(N/2 − 1) … −1 last; what is between them is new, and zero.
    low, high = waves[..., :half, :half, :], waves[..., half + 1 :, :half, :]
    gap = (factor - 1) * count + 1
    columns = (0, factor * half + 1 - half)
    padded = jnp.concatenate(
        [
            jnp.pad(low, [*zeros, (0, gap), columns, (0, 0)]),
            jnp.pad(high, [*zeros, (0, 0), columns, (0, 0)]),
        ],
        axis=-3,
    )
    return jnp.fft.irfft2(padded, (factor * count, factor * count), axes=(-3, -2))
