"""How much a sum of periodic patterns resembles itself some distance away."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar
from ..._types import PerPattern, ScalarLike
from ._cascade import Cascade
from ._choppiness import pattern_choppiness
from ._fields import wave_filters

BLOCK = 4096
"""Distances are worked off in blocks of so many, so that memory stays bounded."""


def autocovariance(
    energy: Float[Array, "pattern *field y x"],
    cascade: Cascade,
    distance: Float[np.ndarray, " r"] | Float[Array, " r"],
    *,
    axis: int = 0,
) -> Float[Array, "pattern *field r"]:
    """The autocovariance of each pattern along an axis of its lattice.

    $$ C_i(r) = \\sum_k E_i(k) \\cos(k · r) $$

    With E_i the expected variances of the waves (`cell_energy`) it is the expected one. With the squares |ĥ_i|² of
    one realised sea it is the average of η(x) η(x + r) over that sea's whole plane. The bands are disjoint, so that no
    two patterns share a wave: the autocovariance of their sum is the sum ΣC_i.

    **Arguments:**

    - `energy`: variance that each wave (ky, kx) carries, in the order of the FFT.
    - `cascade`: its patterns.
    - `distance`: r [m]; from kilometres on, float64 keeps its phases.
    - `axis`: 0 along x, 1 along y. Along the axes a pattern returns soonest.

    **Returns:** C_i(r) in the unit of `energy`.

    **Raises:** `ValueError` for another axis.
    """
    if axis not in (0, 1):
        raise ValueError(f"Argument `axis` must be 0 (x) or 1 (y), but is {axis}.")
    half = cascade.resolution // 2
    marginal = jnp.sum(energy, axis=-2 if axis == 0 else -1)
    # cos is even: the waves m and −m are one. The Nyquist wave carries nothing.
    positive, negative = marginal[..., 1:half], marginal[..., :half:-1]
    folded = jnp.concatenate([marginal[..., :1], positive + negative], axis=-1)
    blocks = -(-distance.shape[0] // BLOCK)
    padded = jnp.pad(jnp.asarray(distance), (0, blocks * BLOCK - distance.shape[0])).reshape(blocks, BLOCK)

    def one(pattern: tuple[Float[Array, "*field k"], Float[Array, ""]]) -> Float[Array, "*field r"]:
        weights, size = pattern

        def block(r: Float[Array, " s"]) -> Float[Array, "s *field"]:
            # Whole turns are taken off before anything is rounded.
            turns = jnp.mod(r / size, 1.0).astype(weights.dtype)
            table = _cosines(2 * np.pi * turns, half)
            return jnp.tensordot(table, weights, (1, weights.ndim - 1))

        values = jax.lax.map(block, padded)
        values = values.reshape(blocks * BLOCK, *values.shape[2:])
        return jnp.moveaxis(values[: distance.shape[0]], 0, -1)

    # A loop, so that one pattern is compiled and not all of them.
    return jax.lax.map(one, (folded, jnp.asarray(cascade.sizes, padded.dtype)))


def _cosines(angle: Float[Array, " s"], count: int) -> Float[Array, "s k"]:
    """cos(mθ) for m = 0 … count − 1, from powers of e^{iθ} that double in number: faster than cosines."""
    step = jax.lax.complex(jnp.cos(angle), jnp.sin(angle))[:, None]
    powers = jnp.ones_like(step)
    while powers.shape[1] < count:
        powers = jnp.concatenate([powers, powers * step], axis=1)
        step = step * step
    return powers[:, :count].real


def strain_autocovariance(
    energy: Float[Array, "pattern y x"],
    cascade: Cascade,
    distance: Float[np.ndarray, " r"] | Float[Array, " r"],
    *,
    choppiness: PerPattern = 1.0,
    breaking_wavenumber: ScalarLike | None = None,
    axis: int = 0,
) -> Float[Array, "pattern r 3 3"]:
    """The covariance of the strain (a, b, c) at a point with the strain a distance away, of each pattern.

    $$ Γ_i(r) = λ_i² \\sum_k G² E_i(k) k^{-2} (k_x², k_y², k_xk_y)(k_x², k_y², k_xk_y)^T \\cos(k · r) $$

    The autocovariance of the Jacobian of a Gaussian sea follows from ΓΣ = ΣΓ_i exactly as its variance does from the
    covariance at one point: A + B + 2S + AB + 3S² − 4PQ, each at distance r.

    **Arguments:** `energy`, `cascade`, `distance`, `axis` as in `autocovariance`, `energy` [m²]; `choppiness` λ [-];
    `breaking_wavenumber` k_b [rad/m] of the low-pass that foam sees, or None.

    **Returns:** Γ_i(r) [-].
    """
    lam = pattern_choppiness(choppiness, cascade.count).astype(energy.dtype)
    limit = None if breaking_wavenumber is None else as_leaf(breaking_wavenumber).astype(energy.dtype)
    check_scalar("breaking_wavenumber", limit, "rad/m", positive=True)
    filters = wave_filters(cascade, lam, limit)
    kx, ky = filters.kx, filters.ky
    xx, yy, xy = kx * kx + 0 * ky, ky * ky + 0 * kx, kx * ky
    weight = filters.strain**2 * energy
    # Five products make the nine entries.
    products = [weight * p for p in (xx * xx, yy * yy, xy * xy, xx * xy, yy * xy)]
    a, b, s, p, q = jnp.moveaxis(autocovariance(jnp.stack(products, 1), cascade, distance, axis=axis), 1, 0)
    rows = [jnp.stack(row, axis=-1) for row in ((a, s, p), (s, b, q), (p, q, s))]
    return jnp.stack(rows, axis=-2)
