"""How far from normal slopes and the Jacobian are inside footprints."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.special import ndtr
from jaxtyping import Array, Float

from jaxocean import filtering
from jaxocean.whitecaps import jacobian

from ..common._tiles import Tile

QUANTITIES = ("slope along x", "slope along y", "Jacobian j")
STATISTICS = ("skewness", "excess kurtosis", "Kolmogorov distance")
LEAST = 8
"""Samples a side below which the distribution inside a footprint is not looked at."""

MOST_SAMPLES = 2**19
"""Of one quantity in all footprints of one size, where they are sorted."""


def sizes(tile: Tile) -> tuple[int, ...]:
    """Sides [samples] of the footprints looked at."""
    return tuple(side for side in tile.sides if side >= LEAST)


def measure(
    slope: Float[Array, "y x 2"], strain: Float[Array, "y x 3"], tile: Tile
) -> Float[np.ndarray, "quantity statistic size"]:
    """Skewness, excess kurtosis and distance from the normal distribution of the footprint's own mean and variance.

    **Returns:** means over the footprints of each size.
    """
    fields = _fields(slope, strain)
    skewness, kurtosis = (np.asarray(each, np.float64).T for each in _moments(fields, tile))
    distance = np.stack([_distance(np.asarray(fields), side) for side in sizes(tile)], axis=1)
    return np.stack([skewness, kurtosis, distance], axis=1)


@jax.jit
def _fields(slope, strain):
    # About 1, so that powers keep their digits.
    return jnp.concatenate([slope, jacobian(strain)[..., None] - 1], axis=-1)


@partial(jax.jit, static_argnames="tile")
def _moments(fields, tile: Tile):
    """Means over footprints of the skewness and of the excess kurtosis inside each."""
    skewness, kurtosis = [], []
    powers = filtering.box_means(jnp.concatenate([fields**n for n in (1, 2, 3, 4)], axis=-1), LEAST)
    for side in sizes(tile):
        if side > LEAST:
            powers = filtering.box_means(powers, 2)
        m, m2, m3, m4 = jnp.split(powers, 4, axis=-1)
        variance = m2 - m**2
        third = m3 - 3 * m * m2 + 2 * m**3
        fourth = m4 - 4 * m * m3 + 6 * m**2 * m2 - 3 * m**4
        skewness.append(jnp.mean(third / variance**1.5, axis=(0, 1)))
        kurtosis.append(jnp.mean(fourth / variance**2, axis=(0, 1)) - 3)
    return jnp.stack(skewness), jnp.stack(kurtosis)


def _distance(fields: np.ndarray, side: int) -> np.ndarray:
    """Mean over footprints of the largest difference between the two distribution functions, per quantity."""
    rows, channels = len(fields) // side, fields.shape[-1]
    boxes = fields.reshape(rows, side, rows, side, channels).transpose(4, 0, 2, 1, 3)
    inside = boxes.reshape(channels, rows**2, side**2)
    every = max(1, side**2 // 2**16) | 1  # odd, so that it meets every column
    few = max(1, rows**2 * (side**2 // every) // MOST_SAMPLES)
    inside = np.sort(inside[:, ::few, ::every], axis=-1)
    mean, deviation = inside.mean(axis=-1, keepdims=True), inside.std(axis=-1, keepdims=True)
    normal = np.asarray(ndtr((inside - mean) / deviation))
    count = inside.shape[-1]
    # Between its steps the empirical function is constant: half a step remains, whatever is compared.
    steps = (np.arange(count) + 0.5) / count
    return np.abs(normal - steps).max(axis=-1).mean(axis=-1)
