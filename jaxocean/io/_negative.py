"""What to do with the negative cells of a truncated Fourier sum.

Buoys report four Fourier coefficients per frequency; the directional distribution that is summed from them is
negative in places (13 % of the cells of a typical NDBC record).
"""

import abc

import equinox as eqx
import numpy as np

Table = np.ndarray
"""E(f, φ), float64, of shape (frequency, direction)."""

IMPOSSIBLE = -3.0
"""Smallest value, in units of the mean, of 1 + 2 r₁ cos + 2 r₂ cos with r ≤ 1; below it the directions are
missing values, not measurements."""


class AbstractNegativeCells(eqx.Module):
    """A repair of tables with negative cells."""

    @abc.abstractmethod
    def __call__(self, table: Table, angles: np.ndarray) -> Table:
        """A table of the same shape without negative cells; `angles` [rad] are those of its columns."""


class Clip(AbstractNegativeCells):
    """Set negative cells to 0. The energy grows: Hs by 3 % for NDBC buoys. For comparison."""

    def __call__(self, table: Table, angles: np.ndarray) -> Table:
        del angles
        return np.maximum(table, 0.0)


class ClipAndRenormalise(AbstractNegativeCells):
    """Set negative cells to 0, then scale each frequency back to its energy; E(f) and Hs are kept."""

    def __call__(self, table: Table, angles: np.ndarray) -> Table:
        del angles
        return _with_energy_of(np.maximum(table, 0.0), table)


class MaximumEntropy(AbstractNegativeCells):
    """The positive distribution of largest entropy with the same first four Fourier coefficients.

    $$ D(θ) = \\frac{1}{2π} \\frac{1 − φ_1 c_1^* − φ_2 c_2^*}{|1 − φ_1 e^{−iθ} − φ_2 e^{−2iθ}|²} $$

    $$ φ_1 = \\frac{c_1 − c_2 c_1^*}{1 − |c_1|²}, \\quad φ_2 = c_2 − c_1 φ_1 $$

    with c_n = ∫ D e^{inθ} dθ. Sharper than the truncated sum; E(f) is kept on the table's own directions. It
    is meant for buoys, which report only those coefficients: of a full spectrum it keeps no more than them.

    **Source:** Lygre & Krogstad 1986, J. Phys. Oceanogr. 16(12).
    """

    def __call__(self, table: Table, angles: np.ndarray) -> Table:
        total = table.sum(axis=1)
        share = table / np.where(total > 0, total, 1.0)[:, None]
        c1, c2 = (share @ np.exp(1j * n * angles) for n in (1, 2))
        # A coefficient of modulus 1 is a single direction: infinitely sharp, and never measured.
        c1 = c1 * np.minimum(1.0, 0.98 / np.maximum(np.abs(c1), 1e-12))
        phi1 = (c1 - c2 * np.conj(c1)) / (1 - np.abs(c1) ** 2)
        phi2 = c2 - c1 * phi1
        wave = np.exp(-1j * angles)
        denominator = np.abs(1 - phi1[:, None] * wave - phi2[:, None] * wave**2) ** 2
        return _with_energy_of(1 / np.maximum(denominator, 1e-6), table)


def repair(table: Table, angles: np.ndarray, negative: AbstractNegativeCells) -> Table:
    """Apply `negative`, after rows whose directions are missing values have become isotropic."""
    mean = table.mean(axis=1)[:, None]
    missing = np.any(table < IMPOSSIBLE * np.abs(mean), axis=1) & (mean[:, 0] > 0)
    return negative(np.where(missing[:, None], mean, table), angles)


def _with_energy_of(table: Table, original: Table) -> Table:
    wanted = np.maximum(original.sum(axis=1), 0.0)
    total = table.sum(axis=1)
    return table * (wanted / np.where(total > 0, total, 1.0))[:, None]
