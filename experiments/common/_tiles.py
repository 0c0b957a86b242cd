"""Squares of sea whose patterns are summed exactly, and the footprints that tile them."""

import itertools
import math
from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import jaxocean as jo
from jaxocean import filtering
from jaxocean.whitecaps import StrainStatistics, footprint_statistics, jacobian, two_channels

MOST = 256
"""Footprints of one size along each side of the tile: where there are more, evenly spaced ones are taken."""


class Tile(NamedTuple):
    """A square of the plane, sampled evenly; its footprints are squares of 1, 2, 4, … samples a side."""

    points: int  # a power of two
    spacing: float  # [m]

    @property
    def sides(self) -> tuple[int, ...]:
        """Sides of the footprints in samples."""
        return tuple(2**level for level in range(int(math.log2(self.points)) + 1))

    @property
    def lengths(self) -> np.ndarray:
        """Sides of the footprints [m]."""
        return np.asarray(self.sides) * self.spacing

    @property
    def along(self) -> np.ndarray:
        """Coordinates [m] of the samples."""
        return np.arange(self.points) * self.spacing

    def stride(self, side: int) -> int:
        """Every so many footprints of a size are looked at."""
        return max(1, self.points // side // MOST)

    def thin(self, boxes: Float[Array, "y x c"], side: int) -> Float[Array, "footprint c"]:
        """Those footprints, in a row."""
        stride = self.stride(side)
        return boxes[::stride, ::stride].reshape(-1, boxes.shape[-1])

    def segments(self) -> list[slice]:
        """Where the footprints of each size lie when those of all sizes follow each other."""
        counts = [(self.points // side // self.stride(side)) ** 2 for side in self.sides]
        ends = np.cumsum([0, *counts])
        return [slice(int(a), int(b)) for a, b in itertools.pairwise(ends)]

    def footprints(self) -> filtering.Footprint:
        """The footprints of all sizes."""
        centres, lengths = [], []
        for side in self.sides:
            first = np.arange(0, self.points // side, self.stride(side)) * side
            middle = (first + 0.5 * (side - 1)) * self.spacing
            centres.append(np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2))
            lengths.append(np.full(len(centres[-1]), side * self.spacing))
        return filtering.Footprint.square(np.concatenate(centres), np.concatenate(lengths))


class Footprints(NamedTuple):
    """What the footprints of all sizes hold, one after the other, by samples on the tile."""

    summed: StrainStatistics  # of the strain of all patterns together
    independent: StrainStatistics  # with the covariances of the patterns added
    channels: Float[Array, "footprint pattern 2"]  # E[k_i] and E[k_i²]
    strain: Float[Array, "y x 3"]  # on the tile


def sample(
    fields: Float[Array, "n y x c"], cascade: jo.surface.Cascade, tile: Tile
) -> Iterator[Float[Array, "y x c"]]:
    """The fields of one pattern after the other on the tile, exactly."""
    for values, size in zip(fields, cascade.sizes, strict=True):
        yield filtering.resample(values, size, tile.along, tile.along)


def gather(strains: Float[Array, "n y x 3"], cascade: jo.surface.Cascade, tile: Tile) -> Footprints:
    """Moments over all footprints of the tile."""
    total, spread, channels = jnp.zeros((), strains.dtype), jnp.zeros((), strains.dtype), []
    for strain in sample(strains, cascade, tile):
        total = total + strain
        mean, products, k = _one_pattern(strain, cascade.count, tile)
        spread = spread + (products - filtering.pair_products(mean))
        channels.append(k)
    mean, products = _means(total, tile), _means(filtering.pair_products(total), tile)
    return Footprints(
        _statistics(mean, products - filtering.pair_products(mean)),
        _statistics(mean, spread),
        jnp.stack(channels, axis=-2),
        total,
    )


def covered(strain: Float[Array, "y x 3"], threshold: float, tile: Tile) -> Float[Array, " footprint"]:
    """The share of each footprint, at rest, that breaks."""
    return _covered(strain, jnp.asarray(threshold, strain.dtype), tile)


@partial(jax.jit, static_argnames="tile")
def _covered(strain, threshold, tile: Tile):
    return _means((jacobian(strain) < threshold).astype(strain.dtype)[..., None], tile)[:, 0]


@partial(jax.jit, static_argnames=("patterns", "tile"))
def _one_pattern(strain, patterns: int, tile: Tile):
    return (
        _means(strain, tile),
        _means(filtering.pair_products(strain), tile),
        _means(two_channels(strain, patterns), tile),
    )


@partial(jax.jit, static_argnames="tile")
def _means(values: Float[Array, "y x c"], tile: Tile) -> Float[Array, "footprint c"]:
    """Means over the footprints of all sizes."""
    found = [tile.thin(values, 1)]
    for side in tile.sides[1:]:
        values = filtering.box_means(values, 2)
        found.append(tile.thin(values, side))
    return jnp.concatenate(found)


@jax.jit
def _statistics(mean: Float[Array, "f 3"], spread: Float[Array, "f 6"]) -> StrainStatistics:
    slope = jnp.zeros((*mean.shape[:-1], 2), mean.dtype)
    flat = jnp.zeros((*slope.shape, 2), mean.dtype)
    return footprint_statistics(filtering.Moments(slope, flat, mean, filtering.symmetric_matrix(spread)))
