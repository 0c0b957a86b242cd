"""The static geometry of an FFT sea: which pattern carries which waves."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

MOST_PATTERNS = 16
RESOLUTIONS = (8, 4096)
SLACK = 1e-9  # relative; two band edges this close are one edge


@dataclass(frozen=True, init=False)
class Cascade:
    """Periodic square patterns, each with its own band of wavenumbers.

    Pattern i repeats every L_i metres and owns the waves of one annulus lo_i ≤ |k| < hi_i. The annuli are
    disjoint and leave no gap. By default the largest pattern starts at π/L, where its first lattice cell
    ends, each pattern carries waves up to its Nyquist wavenumber πN/L, and the next smaller one takes over
    there, in whatever order the sizes are given.

    **Arguments:**

    - `sizes`: L_i [m], at most 16 patterns.
    - `resolution`: N, samples along each side of every pattern; even, 8 to 4096.
    - `bands`: (lo_i, hi_i) [rad/m] in the order of `sizes`, or None for the default.

    **Raises:** `ValueError` for a size, resolution or band that makes no sense.

    Frozen and hashable: under `jit` it is static.
    """

    sizes: tuple[float, ...]
    resolution: int
    bands: tuple[tuple[float, float], ...]

    def __init__(
        self,
        sizes: Sequence[float | int] = (893.0, 101.0, 21.0, 11.0),
        resolution: int = 256,
        bands: Sequence[Sequence[float | int]] | None = None,
    ) -> None:
        if not np.iterable(sizes):
            raise ValueError(
                f"Argument `sizes` must hold one size [m] per pattern, but is {sizes}: write ({sizes},)."
            )
        sizes = tuple(float(size) for size in sizes)
        _check_sizes(sizes)
        _check_resolution(resolution)
        edges = _default_bands(sizes, resolution) if bands is None else _given_bands(bands, sizes)
        _check_bands(edges, sizes, resolution)
        object.__setattr__(self, "sizes", sizes)
        object.__setattr__(self, "resolution", int(resolution))
        object.__setattr__(self, "bands", edges)

    @property
    def count(self) -> int:
        """The number of patterns n."""
        return len(self.sizes)

    @property
    def spacings(self) -> tuple[float, ...]:
        """Distance L_i/N [m] between neighbouring samples of each pattern."""
        return tuple(size / self.resolution for size in self.sizes)

    @property
    def wavenumber_limit(self) -> float:
        """The largest wavenumber [rad/m] that some pattern carries."""
        return max(upper for _, upper in self.bands)

    @property
    def band(self) -> tuple[float, float]:
        """The band (lo, hi) [rad/m] of all patterns together."""
        return min(lower for lower, _ in self.bands), self.wavenumber_limit

    @property
    def period(self) -> float:
        """Distance [m] after which the sum of the patterns repeats in x and in y.

        It is the least common multiple of the sizes, taken as the decimal fractions that they are written as.
        """
        fractions = [Fraction(repr(size)) for size in self.sizes]
        numerator = math.lcm(*(f.numerator for f in fractions))
        return float(Fraction(numerator, math.gcd(*(f.denominator for f in fractions))))

    def points(self, pattern: int) -> np.ndarray:
        """Rest points (x, y) [m] of the samples of one pattern, shape (N, N, 2), indexed [y, x]."""
        along = np.arange(self.resolution) * self.spacings[pattern]
        x, y = np.meshgrid(along, along)
        return np.stack([x, y], axis=-1)


def _check_sizes(sizes: tuple[float, ...]) -> None:
    if not 1 <= len(sizes) <= MOST_PATTERNS:
        raise ValueError(f"Argument `sizes` must hold 1 to {MOST_PATTERNS} sizes, but holds {len(sizes)}.")
    for size in sizes:
        if not (math.isfinite(size) and size > 0):
            raise ValueError(f"Argument `sizes` must hold finite sizes greater than 0 m, but holds {size:g}.")


def _check_resolution(resolution: int) -> None:
    least, most = RESOLUTIONS
    whole = isinstance(resolution, (int, np.integer)) and not isinstance(resolution, bool)
    if not whole or resolution % 2 or not least <= resolution <= most:
        raise ValueError(
            f"Argument `resolution` must be an even whole number from {least} to {most}, but is {resolution}."
        )


def _default_bands(sizes: tuple[float, ...], resolution: int) -> tuple[tuple[float, float], ...]:
    bands: dict[int, tuple[float, float]] = {}
    lower = math.pi / max(sizes)
    for index in sorted(range(len(sizes)), key=lambda i: -sizes[i]):
        upper = math.pi * resolution / sizes[index]
        if lower >= upper * (1 - SLACK):
            raise ValueError(
                f"Argument `sizes` must differ from each other, but {sizes[index]:g} m is there twice, "
                "which leaves the second pattern an empty band."
            )
        bands[index] = (lower, upper)
        lower = upper
    return tuple(bands[index] for index in range(len(sizes)))


def _given_bands(
    bands: Sequence[Sequence[float | int]], sizes: tuple[float, ...]
) -> tuple[tuple[float, float], ...]:
    if len(bands) != len(sizes):
        raise ValueError(
            f"Argument `bands` must hold one (lower, upper) for each of the {len(sizes)} sizes, "
            f"but holds {len(bands)}."
        )
    edges = []
    for band in bands:
        if len(band) != 2:
            raise ValueError(
                f"Argument `bands` must hold pairs (lower, upper), but one has {len(band)} numbers."
            )
        lower, upper = float(band[0]), float(band[1])
        if not (math.isfinite(lower) and math.isfinite(upper) and 0 < lower < upper):
            raise ValueError(
                f"Argument `bands` must hold (lower, upper) with 0 < lower < upper in rad/m, "
                f"but holds the empty or invalid band ({lower:g}, {upper:g})."
            )
        edges.append((lower, upper))
    return tuple(edges)


def _check_bands(bands: tuple[tuple[float, float], ...], sizes: tuple[float, ...], resolution: int) -> None:
    ordered = sorted(bands)
    for (_, upper), (lower, _) in itertools.pairwise(ordered):
        if lower < upper * (1 - SLACK):
            raise ValueError(
                "Argument `bands` must not overlap, "
                f"but one ends at {upper:g} rad/m and the next starts at {lower:g} rad/m."
            )
        if lower > upper * (1 + SLACK):
            raise ValueError(
                "Argument `bands` must leave no gap, "
                f"but one ends at {upper:g} rad/m and the next starts at {lower:g} rad/m."
            )
    for (lower, upper), size in zip(bands, sizes, strict=True):
        least, most = math.pi / size, math.pi * resolution / size
        if lower < least * (1 - SLACK) or upper > most * (1 + SLACK):
            raise ValueError(
                f"The pattern of {size:g} m at resolution {resolution} must carry waves between its own "
                f"limits {least:g} and {most:g} rad/m, but its band is ({lower:g}, {upper:g}): "
                "raise the resolution, add a size in between, or move the band."
            )
