"""The random numbers of a sea: drawn once from a key, then kept."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, PRNGKeyArray, UInt32

from ._cascade import Cascade
from ._cells import lattice_indices


def draw_noise(cascade: Cascade, key: PRNGKeyArray | UInt32[Array, "2"]) -> Complex[Array, "pattern y x"]:
    """Complex standard normal numbers, E|ξ|² = 1, one for each wave of each pattern.

    Amplitudes and phases are both random. The number of a wave depends on the key, the pattern and the wave's
    place in the lattice, not on the resolution: a finer sea is the same sea with more waves. It is drawn in
    single precision, so that a float32 and a float64 sea from one key are the same sea.

    **Arguments:** `cascade`; `key`: from `jax.random.key`.

    **Returns:** an array in the order of the FFT, of the default floating-point type; it can itself be
    fitted.
    """
    count, n = cascade.count, cascade.resolution
    # Waves are numbered ring by ring around k = 0, because the first numbers drawn from a key do not depend
    # on how many follow.
    keys = jax.vmap(lambda i: jax.random.fold_in(key, i))(jnp.arange(count))
    rows = jax.vmap(lambda k: jax.random.normal(k, ((n + 1) ** 2, 2), jnp.float32))(keys)
    rows = rows.astype(jnp.result_type(float)) * np.sqrt(0.5)
    place = _ring_number(n)
    chosen = rows[:, place]
    return jax.lax.complex(chosen[..., 0], chosen[..., 1])


def _ring_number(resolution: int) -> np.ndarray:
    """The place of each wave (iy, ix) in a walk along squares of growing size around (0, 0)."""
    i = lattice_indices(resolution).astype(np.int64)
    iy, ix = np.meshgrid(i, i, indexing="ij")
    ring = np.maximum(np.abs(iy), np.abs(ix))
    side = 2 * ring
    bottom, right, top = iy == -ring, ix == ring, iy == ring
    along = np.where(
        bottom & ~right,
        ix + ring,
        np.where(right & ~top, side + iy + ring, np.where(top, 3 * side - ix - ring, 4 * side - iy - ring)),
    )
    start = np.where(ring > 0, (side - 1) ** 2, 0)
    number = np.where(ring > 0, start + along, 0)
    # The walk along top (ix from ring down to −ring + 1) and left (iy from ring down) closes the ring.
    return number.astype(np.int32)
