"""The sea at any point of the plane: exact Fourier sums, infinitely smooth."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from ..._numerics import check_last_axis
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
    p = p if isinstance(p, jax.Array) else np.asarray(p)
    check_last_axis("p", p.shape, 2, "places (x, y)")
    shape = (cascade.count,) + (1,) * p.ndim
    if isinstance(p, np.ndarray):
        sizes = np.asarray(cascade.sizes).reshape(shape)
        return jnp.asarray(np.remainder(p.astype(np.float64), sizes), dtype)
    sizes = jnp.asarray(cascade.sizes, p.dtype).reshape(shape)
    return jax.lax.rem(*jnp.broadcast_arrays(p[None], sizes)).astype(dtype)


def wave_table(spectra: Complex[Array, "n field y x"]) -> Float[Array, "n rows columns"]:
    """The spectra of real fields, laid out for one real matrix product by [cos, sin] of the phases along y.

    The half kx ≥ 0 is enough since the fields are real.
    """
    n, fields, resolution, _ = spectra.shape
    half = resolution // 2
    weights = jnp.asarray(np.where(np.arange(half) > 0, 2.0, 1.0), spectra.real.dtype)
    kept = jnp.moveaxis(scale(spectra[..., :half], weights), 1, 2).reshape(n, resolution, fields * half)
    cosine = jnp.concatenate([kept.real, kept.imag], axis=2)
    sine = jnp.concatenate([-kept.imag, kept.real], axis=2)
    return jnp.concatenate([cosine, sine], axis=1)


def sum_waves(
    table: Float[Array, "n rows columns"], places: Float[Array, "n *b 2"], cascade: Cascade
) -> Float[Array, "*b field"]:
    """Σ_i Σ_k f̂_i(k) exp(ik·p) for the real fields f in `table`, over all patterns.

    The sum is separable: one matrix product over ky, then one weighted sum over kx. Many points go in
    chunks, so that memory stays bounded.
    """
    n, resolution = table.shape[0], cascade.resolution
    half = resolution // 2
    fields = table.shape[2] // resolution
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


def interpolate_grids(
    grids: Float[Array, "n y x field"], places: Float[Array, "n *b 2"], cascade: Cascade
) -> Float[Array, "*b field"]:
    """The same sum over patterns, bilinear between the samples of the grids."""
    resolution = cascade.resolution
    spacing = jnp.asarray(cascade.spacings, places.dtype).reshape((-1,) + (1,) * (places.ndim - 1))
    cell = places / spacing
    corner = jnp.floor(cell)
    fraction = (cell - corner)[..., None]
    low = corner.astype(jnp.int32) % resolution
    high = (low + 1) % resolution
    pattern = jnp.arange(cascade.count).reshape((-1,) + (1,) * (places.ndim - 2))

    def at(iy, ix):
        return grids[pattern, iy, ix]

    (x0, y0), (x1, y1) = (low[..., 0], low[..., 1]), (high[..., 0], high[..., 1])
    fx, fy = fraction[..., 0, :], fraction[..., 1, :]
    below = at(y0, x0) * (1 - fx) + at(y0, x1) * fx
    above = at(y1, x0) * (1 - fx) + at(y1, x1) * fx
    return jnp.sum(below * (1 - fy) + above * fy, axis=0)
