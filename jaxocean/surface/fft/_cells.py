"""How much of a spectrum's energy each wave of the lattice carries."""

from functools import lru_cache
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import leaf_dtype
from ...spectra import AbstractSpectrum
from ._cascade import Cascade

LOW = 4  # cells with |ix|, |iy| ≤ LOW see the spectral peak: they are sampled finely
FINE = 8  # fine cells take FINE × FINE points
GAUSS = 0.5 / np.sqrt(3.0)  # offsets of the two-point Gauss rule in a cell of width 1


class FineCells(NamedTuple):
    """Cells that an edge of the annulus cuts, and the lowest ones: their place, and the wave they feed."""

    pattern: np.ndarray
    centre: np.ndarray
    wave: np.ndarray
    wedge: np.ndarray


def lattice_indices(resolution: int) -> np.ndarray:
    """Wave numbers 0 … N/2−1, −N/2 … −1 per pattern length, in the order of the FFT."""
    return np.fft.fftfreq(resolution, 1.0 / resolution).astype(np.int32)


def cell_energy(spectrum: AbstractSpectrum, cascade: Cascade) -> Float[Array, "pattern y x"]:
    """The height variance [m²] that each wave (ky, kx) of each pattern carries.

    $$ E_i(k) = \\int_{cell(k) ∩ annulus_i} Ψ \\, d²k $$

    Integrating over the cell, instead of sampling Ψ in its middle, makes the sum equal to the variance of
    the sea in the cascade's bands whatever N and L are, also where a narrow spectral peak falls between two
    waves.

    **Arguments:** `spectrum` Ψ [m⁴]; `cascade`.

    **Returns:** variances in the order of the FFT; 0 at k = 0, in the Nyquist row and in the Nyquist column.
    """
    dtype = leaf_dtype(spectrum)
    step = 2 * np.pi / np.asarray(cascade.sizes)
    index = lattice_indices(cascade.resolution)
    width = jnp.asarray(step, dtype)[:, None, None]
    ky = jnp.asarray(index, dtype)[None, :, None] * width
    kx = jnp.asarray(index, dtype)[None, None, :] * width

    # A loop, because four copies of a spectrum take four times as long to compile.
    def add(energy: Float[Array, "pattern y x"], offset: Float[Array, "2"]):
        dy, dx = offset
        return energy + 0.25 * spectrum(kx + dx * width, ky + dy * width), None

    offsets = jnp.asarray([(dy, dx) for dy in (-GAUSS, GAUSS) for dx in (-GAUSS, GAUSS)], dtype)
    shape = (cascade.count, cascade.resolution, cascade.resolution)
    energy, _ = jax.lax.scan(add, jnp.zeros(shape, dtype), offsets)
    energy = jnp.where(_whole_cells(cascade), energy, 0.0)

    cells = _fine_cells(cascade)
    offsets = (np.arange(FINE) + 0.5) / FINE - 0.5
    dy, dx = (jnp.asarray(d.ravel(), dtype) for d in np.meshgrid(offsets, offsets, indexing="ij"))
    spacing = jnp.asarray(step[cells.pattern], dtype)[:, None]
    ky = (jnp.asarray(cells.centre[:, :1], dtype) + dy) * spacing
    kx = (jnp.asarray(cells.centre[:, 1:], dtype) + dx) * spacing
    lower, upper = (
        jnp.asarray(np.asarray(cascade.bands)[cells.pattern, side, None], dtype) for side in (0, 1)
    )
    k = jnp.hypot(kx, ky)
    # The part of each point's own small square that lies inside a straight edge.
    edge = spacing / FINE * jnp.maximum(jnp.abs(kx), jnp.abs(ky)) / k
    inside = jnp.clip((k - lower) / edge + 0.5, 0, 1) * jnp.clip((upper - k) / edge + 0.5, 0, 1)
    weight = inside * _wedge_weight(cells.wedge, dy, dx) / FINE**2
    fine = jnp.sum(weight * spectrum(kx, ky), axis=-1)
    energy = energy.at[cells.pattern, cells.wave[:, 0], cells.wave[:, 1]].add(fine)
    return energy * width**2


def _wedge_weight(
    wedge: np.ndarray, dy: Float[Array, " s"], dx: Float[Array, " s"]
) -> Float[Array, "cell s"]:
    """1 in the whole cell, or in the quarter of it that looks along `wedge`; ½ between two quarters."""
    ny, nx = (jnp.asarray(wedge[:, axis, None], dy.dtype) for axis in (0, 1))
    along = ny * dy + nx * dx
    across = jnp.abs(nx * dy) + jnp.abs(ny * dx)
    quarter = jnp.where(along > across, 1.0, jnp.where(along == across, 0.5, 0.0))
    whole = jnp.asarray(~np.any(wedge, axis=1, keepdims=True))
    return jnp.where(whole, jnp.ones_like(quarter), quarter)


def _thresholds(cascade: Cascade) -> tuple[np.ndarray, np.ndarray]:
    """Squares of the annulus edges in half cells, so that a cell's place is decided in whole numbers."""
    half = np.asarray(cascade.bands) * np.asarray(cascade.sizes)[:, None] / np.pi
    return np.ceil(half[:, 0] ** 2 - 1e-6).astype(np.int32), np.floor(half[:, 1] ** 2 + 1e-6).astype(np.int32)


def _whole_cells(cascade: Cascade) -> jax.Array:
    """Whether a cell lies wholly inside its annulus and above the lowest block."""
    lower, upper = (jnp.asarray(t)[:, None, None] for t in _thresholds(cascade))
    a = jnp.abs(jnp.asarray(lattice_indices(cascade.resolution)))
    near, far = jnp.maximum(2 * a - 1, 0) ** 2, (2 * a + 1) ** 2
    inside = (near[:, None] + near >= lower) & (far[:, None] + far <= upper)
    nyquist = a == cascade.resolution // 2
    return inside & ((a[:, None] > LOW) | (a > LOW)) & ~(nyquist[:, None] | nyquist)


@lru_cache(maxsize=64)
def _fine_cells(cascade: Cascade) -> FineCells:
    """The cells that `_whole_cells` leaves out although a part of them lies in the annulus.

    The half cells beyond the last wave before the Nyquist one go to that wave, and the corners of the cell
    at k = 0 to their neighbours on the axes: nothing of the annulus is lost.
    """
    half = cascade.resolution // 2
    index = np.arange(-half, half + 1)
    a = np.abs(index)
    near, far = np.maximum(2 * a - 1, 0) ** 2, (2 * a + 1) ** 2
    nearest, farthest = near[:, None] + near, far[:, None] + far
    low = (a[:, None] <= LOW) & (a <= LOW)
    outermost = (a[:, None] == half) | (a == half)
    parts: list[np.ndarray] = []
    for pattern, (lower, upper) in enumerate(zip(*_thresholds(cascade), strict=True)):
        touches = (farthest > lower) & (nearest < upper)
        whole = (nearest >= lower) & (farthest <= upper) & ~low & ~outermost
        iy, ix = np.nonzero(touches & ~whole)
        centre = np.stack([index[iy], index[ix]], axis=1)
        origin = (centre == 0).all(axis=1)
        centre = centre[~origin]
        wave = np.clip(centre, 1 - half, half - 1)
        table = np.concatenate(
            [np.full((len(centre), 1), pattern), centre, wave, np.zeros_like(centre)], axis=1
        )
        parts.append(table)
        if origin.any():
            for axis in ((0, 1), (0, -1), (1, 0), (-1, 0)):
                parts.append(np.array([[pattern, 0, 0, *axis, *axis]]))
    table = np.concatenate(parts).astype(np.int32)
    return FineCells(table[:, 0], table[:, 1:3], table[:, 3:5], table[:, 5:7])
