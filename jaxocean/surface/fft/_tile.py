"""A finite piece of sea on which the sum of all patterns is periodic: the world tile."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from ..._numerics import as_leaf, check_scalar, is_concrete
from ..._types import PerPattern, ScalarLike
from ._cascade import RESOLUTIONS, Cascade
from ._choppiness import pattern_choppiness
from ._evolve import Waves, height_spectrum
from ._fields import Filters, wave_filters
from ._phase import split_time
from ._sea import Sea

WHOLE = 1e-9  # relative; how far a ratio of sizes may lie from a whole number


def tiling_cascade(cascade: Cascade, size: float | int) -> Cascade:
    """The cascade with each size replaced by the nearest whole fraction of a tile's side, size/1, size/2, …

    $$ L_i → L/n_i, \\quad n_i = \\mathrm{round}(L/L_i) ≥ 1 $$

    The bands follow from the new sizes. Nearest means in the number of repeats: 101 m becomes 893/9 = 99.2 m on a
    tile of 893 m.

    **Arguments:** `cascade`; `size` L [m] of the tile.

    **Returns:** a `Cascade` of the same resolution, for `WorldTile`.

    **Raises:** `ValueError` for a size that makes no sense, and where two patterns become one.
    """
    side = _checked_size(size)
    repeats = [max(1, round(side / one)) for one in cascade.sizes]
    if len(set(repeats)) < len(repeats):
        sizes = ", ".join(f"{one:g}" for one in cascade.sizes)
        raise ValueError(
            f"Argument `size` must leave the patterns apart, but on a tile of {side:g} m two of the sizes {sizes} m "
            "become the same: choose a larger tile, or fewer patterns."
        )
    return Cascade([side / n for n in repeats], cascade.resolution)


class WorldTile(eqx.Module):
    """A square of sea that repeats exactly, with the sum of all patterns on one lattice.

    Breaking is a property of the *sum* of the patterns. Where every size is a whole fraction of the tile's side,
    L_i = L/n_i, the wave m of pattern i is the wave m n_i of the tile: all patterns share one inverse FFT, and what
    it gives is the sea itself, not an interpolation of it. The tile is as exact as `sea.strain` at the same points.

    **Arguments:**

    - `sea`: a sea whose sizes all divide the tile (`tiling_cascade` makes such a cascade).
    - `resolution`: N, samples along each side of the tile; even, 8 to 4096; static.
    - `size`: side L [m]; by default the period of the sea's cascade; static.

    **Raises:** `ValueError` for a size that some pattern does not divide, and for a resolution that makes no sense.
    """

    sea: Sea
    resolution: int = eqx.field(static=True)
    size: float = eqx.field(static=True)

    def __init__(self, sea: Sea, resolution: int, size: float | int | None = None) -> None:
        self.sea = sea
        self.resolution = resolution
        self.size = _checked_size(sea.cascade.period if size is None else size)

    def __check_init__(self) -> None:
        least, most = RESOLUTIONS
        if self.resolution % 2 or not least <= self.resolution <= most:
            raise ValueError(
                f"Argument `resolution` must be an even whole number from {least} to {most}, but is {self.resolution}."
            )
        for one in self.sea.cascade.sizes:
            repeats = self.size / one
            if round(repeats) < 1 or abs(repeats - round(repeats)) > WHOLE * repeats:
                raise ValueError(
                    f"Argument `size` must be a whole multiple of every size of the sea's cascade, but {self.size:g} m "
                    f"is {repeats:.6g} times {one:g} m: round the sizes with `tiling_cascade(cascade, {self.size:g})`."
                )

    @property
    def repeats(self) -> tuple[int, ...]:
        """How often each pattern repeats along the tile."""
        return tuple(round(self.size / one) for one in self.sea.cascade.sizes)

    @property
    def spacing(self) -> float:
        """Distance L/N [m] between neighbouring samples."""
        return self.size / self.resolution

    def points(self) -> np.ndarray:
        """Rest points (x, y) [m] of the samples, shape (N, N, 2), indexed [y, x]."""
        along = np.arange(self.resolution) * self.spacing
        return np.stack(np.meshgrid(along, along), axis=-1)

    def strain(
        self, time: ScalarLike, choppiness: PerPattern = 1.0, breaking_wavenumber: ScalarLike | None = None
    ) -> Float[Array, "y x 3"]:
        """Strain (a, b, c) [-] of the sum of all patterns at the samples.

        **Arguments:** `time` t [s]; `choppiness` λ [-], one number or one per pattern; `breaking_wavenumber` k_b
        [rad/m] of the low-pass that foam sees, or None.

        **Raises:** `ValueError` if the lattice is too coarse for a wave that foam sees.
        """
        self._check_resolved(breaking_wavenumber)
        return self._fields(("a", "b", "c"), time, choppiness, breaking_wavenumber)

    def displacement(self, time: ScalarLike, choppiness: PerPattern = 1.0) -> Float[Array, "y x 2"]:
        """Horizontal displacement Σλ_i(u_i, v_i) [m] at the samples, of all waves that the lattice resolves."""
        return self._fields(("u", "v"), time, choppiness, None)

    def height(self, time: ScalarLike) -> Float[Array, "y x"]:
        """Height η [m] at the samples, of all waves that the lattice resolves."""
        return self._fields(("height",), time, 1.0, None)[..., 0]

    def _check_resolved(self, breaking_wavenumber: ScalarLike | None) -> None:
        if breaking_wavenumber is not None and not is_concrete(breaking_wavenumber):
            return
        cascade = self.sea.cascade
        highest = 0
        for size, (_, upper), repeats in zip(cascade.sizes, cascade.bands, self.repeats, strict=True):
            index = min(cascade.resolution // 2 - 1, math.floor(upper * size / (2 * math.pi) + 0.5))
            if breaking_wavenumber is not None:
                index = min(index, math.ceil(float(breaking_wavenumber) * size / (2 * math.pi)) - 1)
            highest = max(highest, index * repeats)
        if 2 * highest >= self.resolution:
            raise ValueError(
                f"Argument `resolution` must be at least {2 * highest + 2} to resolve the waves that foam sees on a "
                f"tile of {self.size:g} m, but is {self.resolution}: raise it, or lower the breaking wavenumber."
            )

    def _fields(
        self,
        names: tuple[str, ...],
        time: ScalarLike,
        choppiness: PerPattern,
        breaking_wavenumber: ScalarLike | None,
    ) -> Float[Array, "y x field"]:
        dtype = self.sea.waves.rate.dtype
        clock = split_time(time, self.sea.repeat_period, dtype)
        lam = pattern_choppiness(choppiness, self.sea.cascade.count).astype(dtype)
        limit = None if breaking_wavenumber is None else as_leaf(breaking_wavenumber).astype(dtype)
        check_scalar("breaking_wavenumber", limit, "rad/m", positive=True)
        half = self.sea.cascade.resolution // 2
        # The half kx ≥ 0 is enough since the fields are real; the Nyquist column is empty.
        kept = jax.tree.map(lambda x: x[..., :half], self.sea.waves)
        filters = wave_filters(self.sea.cascade, lam, limit)
        filters = Filters(
            filters.kx[..., :half], filters.ky, filters.inverse[..., :half], filters.strain[..., :half]
        )
        spectra = filters.apply(names, height_spectrum(Waves(*kept), clock))
        total = self._gather(spectra)
        shape = (self.resolution, self.resolution)
        return jnp.moveaxis(jnp.fft.irfft2(total, s=shape) * self.resolution**2, 0, -1)

    def _gather(self, spectra: Complex[Array, "pattern field ky kx"]) -> Complex[Array, "field y x"]:
        """The waves of all patterns at their places among the waves of the tile; what does not fit is left out."""
        n, rows = self.resolution, spectra.shape[-2]
        zero = jnp.zeros((), spectra.dtype)
        total = jnp.zeros((spectra.shape[1], n, n // 2 + 1), spectra.dtype)
        for pattern, r in zip(spectra, self.repeats, strict=True):
            # Waves 0 … count − 1 lie below the tile's Nyquist wave.
            count = min(rows // 2, (n // 2 + r - 1) // r)
            if count < 2:
                continue
            span = (count - 1) * r + 1
            columns = (0, n // 2 + 1 - span, r - 1)
            upper = jax.lax.pad(pattern[:, :count, :count], zero, ((0, 0, 0), (0, n - span, r - 1), columns))
            lower = pattern[:, rows - count + 1 :, :count]
            lower = jax.lax.pad(lower, zero, ((0, 0, 0), (n - span + 1, r - 1, r - 1), columns))
            total = total + upper + lower
        return total


def _checked_size(size: float | int) -> float:
    side = float(size)
    if not (math.isfinite(side) and side > 0):
        raise ValueError(f"Argument `size` must be finite and greater than 0 m, but is {side:g}.")
    return side
