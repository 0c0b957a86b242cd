"""The sea at any point of the plane: exact Fourier sums, infinitely smooth."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from .._protocol import Points
from ._cascade import Cascade
from ._cells import lattice_indices
from ._complex import scale
from ._sincos import sincos_turns

CHUNK = 512  # points that are summed at once


def reduce_points(p: Points, cascade: Cascade, dtype: jnp.dtype) -> Float[Array, "n *b 2"]:
    """The points inside each pattern [m], in the sea's type.

    A NumPy array is reduced in float64 before it is rounded to the sea's type: far from the origin the
    difference is visible.
    """
    shape = (cascade.count,) + (1,) * p.ndim
    if isinstance(p, np.ndarray):
        sizes = np.asarray(cascade.sizes).reshape(shape)
        return jnp.asarray(np.remainder(p.astype(np.float64), sizes), dtype)
    sizes = jnp.asarray(cascade.sizes, p.dtype).reshape(shape)
    return jax.lax.rem(*jnp.broadcast_arrays(p[None], sizes)).astype(dtype)


def sum_waves(
    spectra: Complex[Array, "n field y x"], places: Float[Array, "n *b 2"], cascade: Cascade
) -> Float[Array, "*b field"]:
    """Σ_i Σ_k f̂_i(k) exp(ik·p) for real fields f, over all patterns.

    The sum is separable: one matrix product over ky, then one weighted sum over kx, of which the half kx ≥
    0 is enough since the fields are real. Many points go in chunks, so that memory stays bounded.
    """
    n, fields, resolution, _ = spectra.shape
    half = resolution // 2
    weights = jnp.asarray(np.where(np.arange(half) > 0, 2.0, 1.0), places.dtype)
    kept = jnp.moveaxis(scale(spectra[..., :half], weights), 1, 2).reshape(n, resolution, fields * half)
    # Real products of [cos, sin] with the real and imaginary parts run as one matrix product.
    table = jnp.concatenate(
        [
            jnp.concatenate([kept.real, kept.imag], axis=2),
            jnp.concatenate([-kept.imag, kept.real], axis=2),
        ],
        axis=1,
    )
    index = jnp.asarray(lattice_indices(resolution), places.dtype)
    sizes = jnp.asarray(cascade.sizes, places.dtype)[:, None, None]

    @jax.checkpoint
    def evaluate(chunk: Float[Array, "n p 2"]) -> Float[Array, "p field"]:
        turns = (chunk / sizes)[..., None] * index
        sine, cosine = sincos_turns(turns - jax.lax.stop_gradient(jnp.round(turns)))
        rows = jnp.concatenate([cosine[:, :, 1], sine[:, :, 1]], axis=2) @ table
        rows = rows.reshape(*rows.shape[:2], 2, fields, half)
        columns = jnp.stack([cosine[:, :, 0, :half], -sine[:, :, 0, :half]], axis=2)
        return jnp.einsum("npcfx,npcx->pf", rows, columns)

    batch = places.shape[1:-1]
    points = places.reshape(n, -1, 2)
    count = points.shape[1]
    if count <= CHUNK:
        return evaluate(points).reshape(*batch, fields)
    chunks = -(-count // CHUNK)
    padded = jnp.pad(points, ((0, 0), (0, chunks * CHUNK - count), (0, 0)))
    parts = jax.lax.map(evaluate, jnp.moveaxis(padded.reshape(n, chunks, CHUNK, 2), 1, 0))
    return parts.reshape(chunks * CHUNK, fields)[:count].reshape(*batch, fields)
