"""A directional spectrum that was measured or modelled elsewhere, as a table in frequency and direction."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar, is_concrete
from ..._types import Scalar
from .._dispersion import Dispersion
from .._spectrum import AbstractSpectrum, Harmonics
from ._tails import AbstractTail, PowerTail

LAST_BINS = 3
"""How many of the highest frequencies give the tail its directions; one alone is noisy."""


class MeasuredSpectrum(AbstractSpectrum):
    """A table of E(f, φ), piecewise linear in frequency and direction, and a tail above it.

    $$ Ψ(k, φ) = \\frac{E(f, φ)}{2π k} \\frac{dω}{dk}, \\quad f = ω(k)/2π $$

    Each frequency stands for the cell that reaches half-way to its neighbours, first and last cell being
    symmetric; the interpolant is constant in the outer halves of those two. It therefore integrates to
    Σ E_i Δf_i, with Δf_i the cells' widths, exactly: no energy is lost or gained against the table. In the
    last half-cell the directions turn to the mean ones of the three highest frequencies, with which the tail
    goes on.

    **Arguments:**

    - `energy`: E [m²/(Hz rad)] at least 0, of shape (frequency, direction); a leaf.
    - `frequency`: f [Hz], increasing, the same length as the first axis.
    - `first_direction`: the direction towards [rad] of the first column; the others follow counter-clockwise,
      equally spaced over the circle. A leaf: it turns the sea.
    - `tail`: what follows above the cut-off.
    - `dispersion`: how f and k go together where it was measured (depth).
    - `tail_bins`: how many of the highest frequencies give the tail its level; static. With 1 (default) the tail
      continues the last bin, whose noise then decides about all short waves; with n the mean of what the n last bins
      say of it, each carried to the last one along the tail. What was measured is left alone.

    **Raises:** `ValueError` for shapes that do not fit, frequencies that do not increase from above 0, or
    energies that are negative or not finite.
    """

    energy: Float[Array, "f d"] = eqx.field(converter=as_leaf)
    frequency: Float[Array, " f"] = eqx.field(converter=as_leaf)
    first_direction: Scalar = eqx.field(converter=as_leaf, default=0.0)
    tail: AbstractTail = eqx.field(default_factory=PowerTail, kw_only=True)
    dispersion: Dispersion = eqx.field(default_factory=Dispersion, kw_only=True)
    tail_bins: int = eqx.field(static=True, default=1, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("first_direction", self.first_direction, "rad")
        if not 1 <= self.tail_bins <= self.frequency.shape[0]:
            raise ValueError(
                f"Argument `tail_bins` must lie between 1 and the {self.frequency.shape[0]} frequencies, "
                f"but is {self.tail_bins}."
            )
        if is_concrete(self.frequency) and isinstance(self.frequency, (np.ndarray, jnp.ndarray)):
            f = np.asarray(self.frequency)
            increasing = f.ndim == 1 and f.size > 1 and np.isfinite(f).all() and (np.diff(f) > 0).all()
            if not increasing or f[0] <= 0:
                raise ValueError(
                    "Argument `frequency` must be at least two increasing numbers greater than 0 Hz, "
                    f"but is {np.array2string(f, threshold=6)}."
                )
        if is_concrete(self.energy) and isinstance(self.energy, (np.ndarray, jnp.ndarray)):
            e = np.asarray(self.energy)
            if e.ndim != 2 or e.shape[0] != self.frequency.shape[0] or e.shape[1] < 5:
                raise ValueError(
                    "Argument `energy` must be of shape (frequency, direction) with "
                    f"{self.frequency.shape[0]} frequencies and at least 5 directions, but is {e.shape}."
                )
            if not np.isfinite(e).all() or (e < 0).any():
                raise ValueError(
                    "Argument `energy` must be finite and at least 0 m²/(Hz rad), but has other values."
                )

    def cut_off(self) -> Scalar:
        """The highest measured frequency [Hz]: the upper edge of the last cell."""
        return self.frequency[-1] + 0.5 * (self.frequency[-1] - self.frequency[-2])

    def cut_off_wavenumber(self) -> Scalar:
        """The wavenumber [rad/m] of `cut_off`."""
        return self.dispersion.wavenumber(2 * jnp.pi * self.cut_off())

    def density(self, wavenumber: Float[Array, "*k"], angle: Float[Array, "*k"]) -> Float[Array, "*k"]:
        columns = self.energy.shape[1]
        knots, table, edge = self._table()
        place = jnp.mod((angle - self.first_direction) * (columns / (2 * jnp.pi)), columns)
        whole = jnp.clip(jnp.floor(place), 0, columns - 1)  # rounding may lift `place` to the full circle
        left, part = whole.astype(int), place - whole
        row, upper, beyond, scale, share = self._row(knots, wavenumber)
        right = (left + 1) % columns
        below = (1 - part) * table[row, left] + part * table[row, right]
        above = (1 - part) * table[row + 1, left] + part * table[row + 1, right]
        after = (1 - part) * edge[left] + part * edge[right]
        measured = scale / wavenumber * jnp.where(beyond, after, (1 - upper) * below + upper * above)
        model = self.tail.model()
        return measured if model is None else measured + share * model.density(wavenumber, angle)

    def harmonics(self, wavenumber: Float[Array, "*k"]) -> Harmonics:
        knots, table, edge = self._table()
        moments = table @ self._basis()
        row, upper, beyond, scale, share = self._row(knots, wavenumber)
        upper, beyond, scale = upper[..., None], beyond[..., None], scale[..., None]
        inside = (1 - upper) * moments[row] + upper * moments[row + 1]
        measured = scale * jnp.where(beyond, edge @ self._basis(), inside)
        harmonics = Harmonics(*jnp.moveaxis(measured, -1, 0))
        model = self.tail.model()
        if model is None:
            return harmonics
        pairs = zip(harmonics, model.harmonics(wavenumber), strict=True)
        return Harmonics(*(own + share * other for own, other in pairs))

    def kinks(self) -> Float[Array, " n"]:
        knots, *_ = self._table()
        return self.dispersion.wavenumber(2 * jnp.pi * knots)

    def _basis(self) -> Float[Array, "d 5"]:
        """What each column adds to the five harmonics, exact for the linear interpolant.

        Each column is a hat function as wide as two steps h: its harmonics are those of a point times
        h sinc²(nh/2).
        """
        columns = self.energy.shape[1]
        step = 2 * np.pi / columns
        phi = self.first_direction + jnp.asarray(step * np.arange(columns), self.energy.dtype)
        second, fourth = (step * np.sinc(n * step / (2 * np.pi)) ** 2 for n in (2, 4))
        return jnp.stack(
            [
                jnp.full_like(phi, step),
                second * jnp.cos(2 * phi),
                second * jnp.sin(2 * phi),
                fourth * jnp.cos(4 * phi),
                fourth * jnp.sin(4 * phi),
            ],
            axis=-1,
        )

    def _table(self) -> tuple[Float[Array, " knots"], Float[Array, "knots d"], Float[Array, " d"]]:
        """The table with a row at each outer edge of its first and last cell, and the row that the tail continues."""
        f, e = self.frequency, self.energy
        lowest = jnp.maximum(f[0] - 0.5 * (f[1] - f[0]), 0.0)
        last = jnp.sum(e[-LAST_BINS:], axis=0)
        total = jnp.sum(last)
        shape = last / jnp.where(total > 0, total, 1.0)
        return (
            jnp.concatenate([lowest[None], f, self.cut_off()[None]]),
            jnp.concatenate([e[:1], e, (shape * jnp.sum(e[-1]))[None]]),
            shape * self._tail_level(),
        )

    def _tail_level(self) -> Scalar:
        """What the last `tail_bins` frequencies say of the energy at the last one."""
        f, e = self.frequency[-self.tail_bins :], jnp.sum(self.energy[-self.tail_bins :], axis=1)
        if self.tail_bins == 1:
            return e[0]
        along = self.tail.continuation(f / f[-1])
        follows = along > 0  # no tail continues nothing
        return jnp.mean(jnp.where(follows, e / jnp.where(follows, along, 1.0), e[-1]))

    def _row(self, knots: Float[Array, " knots"], k: Float[Array, "*k"]):
        """Row of the table, weight of the row above it, whether it is tail, factor from E to Ψk, share of the model."""
        f = self.dispersion.frequency(k) / (2 * jnp.pi)
        cut_off = knots[-1]
        inside = jnp.clip(f, knots[0], cut_off)
        row = jnp.clip(jnp.searchsorted(knots, inside, side="right") - 1, 0, knots.size - 2)
        upper = (inside - knots[row]) / (knots[row + 1] - knots[row])
        beyond = f > cut_off
        ratio = jnp.where(beyond, f, cut_off) / cut_off
        level = jnp.where(beyond, self.tail.continuation(ratio), jnp.where(f < knots[0], 0.0, 1.0))
        share = jnp.where(beyond, self.tail.share(ratio), 0.0)
        return row, upper, beyond, level * self.dispersion.group_speed(k) / (2 * jnp.pi), share
