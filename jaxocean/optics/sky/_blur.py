"""A panorama blurred over lobes of several widths, by spherical harmonics."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

DEGREE = 63
"""Largest degree l; the narrowest lobe leaves e^(−10) of it."""

ROWS = 128
"""Rows of the grid from which the harmonics are taken, pole to pole: their quadrature is exact there."""

LEVEL_ROWS, LEVEL_COLUMNS = 64, 128
"""The grid of each blurred level, pole to pole."""

VARIANCES = 0.005 * 2.0 ** np.arange(7)
"""Variance [rad²] of the levels' lobes: deviations from 4° to 32°."""


def blurred_levels(upper: Float[Array, "h w 3"]) -> Float[Array, "level 32 128 3"]:
    """The upper half of a panorama, mirrored at the horizon, under round Gaussian lobes of `VARIANCES`.

    $$ a_{lm} \\to a_{lm}\\, e^{-l (l + 1) s / 2} $$

    which is diffusion on the sphere; for narrow lobes it is a Gaussian of variance s along both directions.

    **Arguments:** `upper`: equirectangular, its first row at the zenith, its last just above the horizon.

    **Returns:** the upper halves of the levels, from the narrowest to the widest. It is linear in `upper`.
    """
    dtype = upper.dtype
    sphere = jnp.concatenate([upper, upper[::-1]], axis=0)
    down = jnp.asarray(_row_shares(sphere.shape[0]), dtype)
    across = jnp.asarray(_column_shares(sphere.shape[1]), dtype)
    grid = jnp.einsum("ih,hwc,jw->icj", down, sphere, across)
    waves = jnp.fft.rfft(grid, axis=-1)[..., : DEGREE + 1] / (2 * ROWS)
    # Both grids have their columns half a column off the first angle, and their columns differ in width.
    shift = np.exp(1j * np.pi * np.arange(DEGREE + 1) * (1.0 / LEVEL_COLUMNS - 0.5 / ROWS))
    waves = waves * jnp.asarray(shift, waves.dtype)
    parts = jnp.stack([waves.real, waves.imag], axis=-1)
    analysis = jnp.asarray(_legendre(ROWS) * _fejer(ROWS), dtype)
    harmonics = jnp.einsum("mli,icmp->mlcp", analysis, parts)
    degrees = np.arange(DEGREE + 1)
    damping = jnp.asarray(np.exp(-0.5 * VARIANCES[:, None] * degrees * (degrees + 1)), dtype)
    synthesis = jnp.asarray(_legendre(LEVEL_ROWS)[:, :, : LEVEL_ROWS // 2], dtype)
    level = jnp.einsum("mli,kl,mlcp->kicmp", synthesis, damping, harmonics)
    columns = jnp.fft.irfft(jax.lax.complex(level[..., 0], level[..., 1]), n=LEVEL_COLUMNS, axis=-1)
    return jnp.moveaxis(LEVEL_COLUMNS * columns, -1, 2).astype(dtype)


@functools.cache
def _row_shares(rows: int) -> np.ndarray:
    """(ROWS, rows): the share of each given row in the mean over each row of the grid, by solid angle."""
    return _overlaps(-np.cos(np.pi * np.arange(ROWS + 1) / ROWS), -np.cos(np.pi * np.arange(rows + 1) / rows))


@functools.cache
def _column_shares(columns: int) -> np.ndarray:
    """(2 ROWS, columns): the share of each given column in the mean over each column of the grid."""
    return _overlaps(np.linspace(0.0, 1.0, 2 * ROWS + 1), np.linspace(0.0, 1.0, columns + 1))


def _overlaps(coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """How much of each interval between the edges `coarse` each interval between the edges `fine` covers."""
    low = np.maximum(coarse[:-1, None], fine[None, :-1])
    high = np.minimum(coarse[1:, None], fine[None, 1:])
    return np.maximum(high - low, 0.0) / np.diff(coarse)[:, None]


@functools.cache
def _fejer(rows: int) -> np.ndarray:
    """Weights of Fejér's first rule for ∫_{−1}^{1} f(cosθ) d(cosθ) at the row centres, exact to degree rows − 1."""
    angle = np.pi * (np.arange(rows) + 0.5) / rows
    k = np.arange(1, rows // 2 + 1)
    return 2.0 / rows * (1.0 - 2.0 * np.sum(np.cos(2.0 * k * angle[:, None]) / (4.0 * k * k - 1.0), axis=1))


@functools.cache
def _legendre(rows: int) -> np.ndarray:
    """(m, l, rows): associated Legendre functions of cosθ at the row centres, each with ∫ P² d(cosθ) = 1."""
    angle = np.pi * (np.arange(rows) + 0.5) / rows
    x, flat = np.cos(angle), np.sin(angle)
    table = np.zeros((DEGREE + 1, DEGREE + 1, rows))
    sectoral = np.full(rows, np.sqrt(0.5))
    for m in range(DEGREE + 1):
        if m:
            sectoral = -np.sqrt((2 * m + 1) / (2 * m)) * flat * sectoral
        table[m, m] = sectoral
        if m < DEGREE:
            table[m, m + 1] = np.sqrt(2 * m + 3) * x * sectoral
        for n in range(m + 2, DEGREE + 1):
            a = np.sqrt((4 * n * n - 1) / (n * n - m * m))
            b = np.sqrt(((n - 1) ** 2 - m * m) / (4 * (n - 1) ** 2 - 1))
            table[m, n] = a * (x * table[m, n - 1] - b * table[m, n - 2])
    return table
