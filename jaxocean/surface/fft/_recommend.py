"""Which patterns a sea needs: sizes and resolution for a wind and a smallest wave."""

import math
from fractions import Fraction

import numpy as np

from ..._constants import GRAVITY
from ..._numerics import check_scalar
from ..._types import ScalarLike
from ...wind import Wind
from ._cascade import MOST_PATTERNS, RESOLUTIONS, Cascade

USUAL_RESOLUTION, USUAL_PATTERNS = 256, 4
FEWEST_WAVES = 2.5
"""Fewer wavelengths than that in a pattern, and its lattice hardly knows directions."""
SLACK = 0.95
"""Primes of four digits and more are at most 34 apart: the steps stay this far below their limit."""
FARTHEST_PEAK = 1 / 8
"""The peak stays below a quarter of the largest pattern's Nyquist wavenumber: N/8 peak wavelengths fit into it."""
NARROWEST = 1.5
"""Sizes differ at least by this factor."""


def recommend_cascade(
    wind: Wind | None = None,
    *,
    smallest_scale: float | int,
    peak_wavenumber: ScalarLike | None = None,
    resolution: int | None = None,
    patterns: int | None = None,
    waves: float | int = 8.0,
) -> Cascade:
    """A cascade that carries a sea from its peak to its smallest waves, and repeats late.

    $$ L_1 ≥ m λ_p, \\quad L_i ≤ \\frac{N}{2m} L_{i+1}, \\quad L_n ≤ \\tfrac12 N λ_{min} $$

    - The longest wave that a pattern must carry, the peak's or the first that the next larger pattern leaves to it,
      fits m times into it. That decides how many directions there are: in the first octave of a band of a rather
      narrow sea (cos²ˢ(θ/2), s = 20) the variance of the strain across the wind is 8 % too high with m = 2.5, 3 % with
      4, 0.8 % with 8 and 0.3 % with 12, with 46, 102, 350 and 748 independent waves.
    - The largest pattern is as large as the others allow, up to N/8 wavelengths of the peak: nearly all of the height
      is in it, and comes again after L_1. For more, split the peak between two large patterns with
      `Cascade(bands=…)`.
    - The sizes fall in equal steps, which shares the strain among the patterns about evenly.
    - Each size is a prime number times one small unit, so that the sum of the patterns repeats after the product of
      all of them.

    **Arguments:**

    - `wind` or `peak_wavenumber` k_p [rad/m]: exactly one; the wind's is g(Ω/U)² with the Ω of its fetch.
    - `smallest_scale`: λ_min [m], the shortest wave to be carried: the band ends at 2π/λ_min or a little above.
    - `resolution`: N, even; by default 256 or, with `patterns`, the least that will do.
    - `patterns`: n; by default 4, or more if N needs them.
    - `waves`: m, at least 2.5.

    **Returns:** a `Cascade`.

    **Raises:** `ValueError` unless exactly one of wind and peak is given; for numbers that make no sense; and for a
    resolution and a number of patterns that cannot do it together, with what could.
    """
    longest = 2 * math.pi / _peak(wind, peak_wavenumber)
    smallest, m = float(smallest_scale), float(waves)
    if not (math.isfinite(smallest) and 0 < smallest < longest):
        raise ValueError(
            f"Argument `smallest_scale` must be greater than 0 m and less than the peak's wavelength, {longest:g} m, "
            f"but is {smallest:g} m."
        )
    if not (math.isfinite(m) and m >= FEWEST_WAVES):
        raise ValueError(f"Argument `waves` must be at least {FEWEST_WAVES:g}, but is {m:g}.")
    if patterns is not None and not 1 <= patterns <= MOST_PATTERNS:
        raise ValueError(f"Argument `patterns` must be 1 to {MOST_PATTERNS}, but is {patterns}.")
    largest = m * longest
    if patterns is None:
        n = USUAL_RESOLUTION if resolution is None else _checked(resolution)
        count = _enough_patterns(largest, smallest, n, m)
    else:
        count = patterns
        n = _least_resolution(largest, smallest, count, m) if resolution is None else _checked(resolution)
        if _reach(smallest, n, count, m) < largest:
            least = _least_resolution(largest, smallest, count, m)
            raise ValueError(
                f"Argument `resolution` must be at least {least} for {count} patterns from {largest:g} m down to waves "
                f"of {smallest:g} m, but is {n}."
            )
    largest = max(largest, min(_reach(smallest, n, count, m), FARTHEST_PEAK * n * longest))
    least = min(0.5 * n * smallest, largest / NARROWEST ** (count - 1))
    return Cascade(spread_sizes(largest, least, count), n)


def spread_sizes(largest: float | int, smallest: float | int, count: int) -> tuple[float, ...]:
    """Sizes in equal steps, each a prime number times one power of ten, so that their common period is long.

    **Arguments:** `largest` [m]: the first size is at least that; `smallest` [m]: the last is at most that; `count`.

    **Returns:** `count` sizes [m], falling; their least common multiple is the product of the primes times the unit.

    **Raises:** `ValueError` for lengths or a count that make no sense.
    """
    if count < 1 or not 0 < smallest <= largest < math.inf or (count > 1 and largest == smallest):
        raise ValueError(
            f"Arguments `largest`, `smallest` and `count` must be lengths of one or more falling sizes, but are "
            f"{largest:g} m, {smallest:g} m and {count}."
        )
    unit = Fraction(10) ** (math.floor(math.log10(smallest)) - 3)
    targets = np.geomspace(largest, smallest, count) / float(unit)
    primes = [_prime(math.ceil(targets[0] - 1e-9), 1)]
    primes += [_prime(round(target), -1) for target in targets[1:-1]]
    if count > 1:
        primes.append(_prime(math.floor(targets[-1] + 1e-9), -1))
    if primes != sorted(set(primes), reverse=True):
        raise ValueError(
            f"Argument `count` must leave room between the sizes, but {count} do not fit between {largest:g} and "
            f"{smallest:g} m."
        )
    return tuple(float(prime * unit) for prime in primes)


def _peak(wind: Wind | None, peak_wavenumber: ScalarLike | None) -> float:
    if (wind is None) == (peak_wavenumber is None):
        given = "neither is" if wind is None else "both are"
        raise ValueError(f"Give exactly one of `wind` and `peak_wavenumber`, but {given} given.")
    if peak_wavenumber is not None:
        peak = np.asarray(peak_wavenumber)
        if peak.ndim or not (np.isfinite(peak) and peak > 0):
            raise ValueError(f"Argument `peak_wavenumber` must be greater than 0 rad/m, but is {peak}.")
        return float(peak)
    assert wind is not None
    check_scalar("wind.speed", wind.speed, "m/s", positive=True)
    return float(GRAVITY * (wind.inverse_wave_age() / wind.speed) ** 2)


def _checked(resolution: int) -> int:
    return Cascade((1.0,), resolution).resolution


def _reach(smallest: float, resolution: int, count: int, waves: float) -> float:
    """How large the largest of so many patterns may be, 0 if none can follow another."""
    step = SLACK * resolution / (2 * waves)
    return (
        SLACK * 0.5 * resolution * smallest * step ** (count - 1) if count == 1 or step > NARROWEST else 0.0
    )


def _enough_patterns(largest: float, smallest: float, resolution: int, waves: float) -> int:
    for count in range(USUAL_PATTERNS, MOST_PATTERNS + 1):
        if _reach(smallest, resolution, count, waves) >= largest:
            return count
    raise ValueError(
        f"Argument `resolution` must be larger, but is {resolution}: {MOST_PATTERNS} patterns do not reach from "
        f"{largest:g} m down to waves of {smallest:g} m."
    )


def _least_resolution(largest: float, smallest: float, count: int, waves: float) -> int:
    """The least even N without prime factors above 5, which transforms fast."""
    least, most = RESOLUTIONS
    for n in range(least, most + 1, 2):
        if _is_smooth(n) and _reach(smallest, n, count, waves) >= largest:
            return n
    raise ValueError(
        f"Argument `patterns` must be larger, but is {count}: at the largest resolution, {most}, they do not reach "
        f"from {largest:g} m down to waves of {smallest:g} m."
    )


def _is_smooth(number: int) -> bool:
    for factor in (2, 3, 5):
        while number % factor == 0:
            number //= factor
    return number == 1


def _prime(start: int, step: int) -> int:
    """The first prime from `start` on, upwards or downwards."""
    number = max(start, 2)
    while any(number % factor == 0 for factor in range(2, math.isqrt(number) + 1)):
        number += step
    return number
