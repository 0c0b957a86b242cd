"""Breaking counted on random strains: plain Monte Carlo draws, FFT realisations, and how far to trust them."""

import math
from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.special import ndtri
from jaxtyping import Array, Float, PRNGKeyArray

import jaxocean as jo
from jaxocean.whitecaps import jacobian, realised_coverage

BATCH = 100_000
BATCHES = 100
"""Draws are counted in at least so many batches of at most so many draws: the spread over them is the error."""


class Counted(NamedTuple):
    """Coverage [-] counted in independent batches of draws, or in independent realisations."""

    coverage: Float[np.ndarray, "batch threshold"]

    @property
    def mean(self) -> Float[np.ndarray, " threshold"]:
        return self.coverage.mean(axis=0)

    @property
    def error(self) -> Float[np.ndarray, " threshold"]:
        """Standard error of the mean."""
        return self.coverage.std(axis=0, ddof=1) / math.sqrt(len(self.coverage))

    def deviation(self, expected: Float[np.ndarray, " threshold"]) -> Float[np.ndarray, " threshold"]:
        """Counted minus expected in standard errors; NaN where nothing was counted."""
        return _over(self.mean - expected, self.error)

    @property
    def seen(self) -> Float[np.ndarray, " threshold"]:
        """In how many batches anything broke: where few, the error cannot be trusted."""
        return np.count_nonzero(self.coverage, axis=0)


class Draws(NamedTuple):
    """Plain Monte Carlo of one sea: coverage, a histogram of j, and its variance and skewness."""

    counted: Counted
    size: int  # draws per batch
    measure: str
    density: Float[np.ndarray, " bin"]
    variance: float
    skewness: float

    @property
    def total(self) -> int:
        return self.size * len(self.counted.coverage)

    def interval(self, confidence: float) -> tuple[np.ndarray, np.ndarray]:
        """Confidence interval of the coverage: binomial on the plane at rest, else from the batches."""
        if self.measure == "rest":
            return wilson_interval(self.counted.mean, self.total, confidence)
        half = normal_quantile(confidence) * self.counted.error
        return np.maximum(self.counted.mean - half, 0), self.counted.mean + half

    def deviation(self, expected: Float[np.ndarray, " threshold"]) -> Float[np.ndarray, " threshold"]:
        """Counted minus expected in standard errors: those that the expected coverage has, where binomial."""
        if self.measure != "rest":
            return self.counted.deviation(expected)
        return _over(self.counted.mean - expected, np.sqrt(expected * (1 - expected) / self.total))


def _over(difference: np.ndarray, error: np.ndarray) -> np.ndarray:
    return np.divide(difference, error, out=np.full_like(difference, np.nan), where=error > 0)


def batches(draws: int) -> tuple[int, int]:
    """How many batches, and how many draws in each, so that there are `draws` or a few more."""
    count = max(BATCHES, math.ceil(draws / BATCH))
    return count, math.ceil(draws / count)


def draw(
    stats: jo.whitecaps.StrainStatistics,
    thresholds: Float[np.ndarray, " threshold"],
    edges: Float[np.ndarray, " edge"],
    *,
    draws: int,
    measure: str,
    key: PRNGKeyArray,
    advance: Callable[[], None],
) -> Draws:
    """Count breaking on Gaussian draws of (a, b, c); `edges` of the histogram are evenly spaced."""
    count, size = batches(draws)
    # Of a symmetric covariance, singular or not.
    values, vectors = np.linalg.eigh(np.asarray(stats.covariance, np.float64))
    root = jnp.asarray(vectors * np.sqrt(np.maximum(values, 0)), jnp.float32)
    levels, bins = jnp.asarray(thresholds, jnp.float32), jnp.asarray(edges, jnp.float32)
    coverage, histogram, moments = [], np.zeros(len(edges) - 1), []
    for batch in jax.random.split(key, count):
        w, h, m = _draw_batch(batch, root, levels, bins, size, measure)
        coverage.append(np.asarray(w, np.float64))
        histogram += np.asarray(h)
        moments.append(np.asarray(m, np.float64))
        advance()
    first, second, third = np.mean(moments, axis=0)
    variance = second - first**2
    return Draws(
        Counted(np.stack(coverage)),
        size,
        measure,
        histogram / (count * size * (edges[1] - edges[0])),
        float(variance),
        float((third - 3 * first * second + 2 * first**3) / variance**1.5),
    )


@eqx.filter_jit
def _draw_batch(key, root, levels, edges, size, measure):
    """Coverage, histogram of j, and means of (j − 1), its square and its cube."""
    strain = jax.random.normal(key, (1, 1, size, 3), jnp.float32) @ root.T
    j = jacobian(strain)
    bins = edges.size - 1
    place = jnp.floor((j.ravel() - edges[0]) * (bins / (edges[-1] - edges[0]))).astype(jnp.int32)
    inside = (place >= 0) & (place < bins)
    histogram = jnp.bincount(jnp.where(inside, place, bins), length=bins + 1)[:bins]
    return (
        _coverage(strain, levels, measure, 1),
        histogram,
        jnp.stack([jnp.mean((j - 1) ** n) for n in (1, 2, 3)]),
    )


def realise(
    spectrum: jo.spectra.AbstractSpectrum,
    cascade: jo.surface.Cascade,
    thresholds: Float[np.ndarray, " threshold"],
    *,
    choppiness: float | tuple[float, ...],
    breaking_wavenumber: float | None,
    realisations: int,
    shifts: int,
    measure: str,
    key: PRNGKeyArray,
    advance: Callable[[], None],
) -> Counted:
    """Count breaking on seas made by FFT, each from random numbers of its own.

    `shifts`: arrangements of the patterns of one sea against each other.
    """
    levels = jnp.asarray(thresholds)
    # Seas of one group share the spectrum's integrals over the waves' cells.
    groups = jax.random.split(key, (realisations // math.gcd(realisations, 8), math.gcd(realisations, 8)))
    coverage = []
    for keys in groups:
        counted = _realise_group(
            spectrum, cascade, keys, choppiness, breaking_wavenumber, levels, measure, shifts
        )
        coverage.append(np.asarray(counted, np.float64))
        advance()
    return Counted(np.concatenate(coverage))


@eqx.filter_jit
def _realise_group(spectrum, cascade, keys, choppiness, breaking_wavenumber, levels, measure, shifts):
    def one(key: PRNGKeyArray) -> Float[Array, " threshold"]:
        sea = jo.surface.realise(spectrum, cascade, key=key)
        strain = sea.strains(0.0, choppiness, breaking_wavenumber)
        return _coverage(strain, levels, measure, shifts)

    return jax.lax.map(one, keys)


def _coverage(strain, levels, measure, shifts):
    return jax.vmap(lambda level: realised_coverage(strain, level, measure=measure, shifts=shifts))(levels)


def groups_of(realisations: int) -> int:
    """How often `realise` calls `advance`."""
    return realisations // math.gcd(realisations, 8)


def normal_quantile(confidence: float) -> float:
    """z of the central interval that holds this share of a normal distribution."""
    return float(ndtri(jnp.asarray(0.5 + 0.5 * confidence)))


def wilson_interval(
    share: Float[np.ndarray, " n"], draws: int, confidence: float
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """Confidence interval of a probability from the share of independent draws.

    $$ \\frac{p + z²/2n ± z\\sqrt{p(1 − p)/n + z²/4n²}}{1 + z²/n} $$

    Never empty and never below 0, not even where nothing was counted.

    **Source:** Wilson 1927, J. Am. Stat. Assoc. 22, 209-212.
    """
    z = normal_quantile(confidence)
    centre = share + z**2 / (2 * draws)
    half = z * np.sqrt(share * (1 - share) / draws + (z / (2 * draws)) ** 2)
    scale = 1 + z**2 / draws
    return np.maximum(centre - half, 0) / scale, np.minimum((centre + half) / scale, 1)
