"""What pyramids weigh, and what rounding them does to the coverage of footprints."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean import filtering
from jaxocean.whitecaps import footprint_statistics

from ..common._tiles import Tile
from ._footprint_errors import exact

PAPER = 8 * 4 * 2 * 256**2 * 4 / 3
"""Bytes of the paper's eight RGBA textures of 256 × 256 at half precision with their levels (5.33 MB there)."""

SIDES = (0.1, 1.0, 10.0, 100.0)
"""Footprints with the sides [m] nearest to these are shown."""


class Stored(NamedTuple):
    """One form of storage: its size, and what it does to W, per side of footprint."""

    name: str
    bytes: int
    change: np.ndarray  # of the mean W, relative
    worst: np.ndarray  # of W in any footprint


def shown(tile: Tile) -> list[int]:
    """Places of the sizes that are shown."""
    near = [int(np.argmin(np.abs(np.log(tile.lengths / side)))) for side in SIDES]
    return sorted(set(near))


def compare(
    fields: jo.surface.Fields, cascade: jo.surface.Cascade, threshold: float, tile: Tile
) -> tuple[Stored, ...]:
    """Pyramids in half precision, as products and as covariances, against the one in single precision."""
    slope, strain = (each.astype(jnp.float32) for each in (fields.slope, fields.strain))
    single = filtering.MomentPyramid.from_samples(slope, strain, cascade.sizes)
    squares, segments = tile.footprints(), [tile.segments()[i] for i in shown(tile)]

    def coverage(pyramid: filtering.MomentPyramid) -> list[np.ndarray]:
        found = exact(footprint_statistics(pyramid(squares, probes=1)), threshold)
        return [found[one] for one in segments]

    best = coverage(single)
    forms = [("products, float32", single.nbytes, single)]
    for dtype, name in ((jnp.float16, "float16"), (jnp.bfloat16, "bfloat16")):
        rounded = single.stored_as(dtype)
        forms.append((f"products, {name}", rounded.nbytes, rounded.stored_as(jnp.float32)))
    for dtype, name in ((jnp.float16, "float16"), (jnp.bfloat16, "bfloat16")):
        compressed = filtering.CompressedMoments.from_pyramid(single, dtype)
        forms.append((f"covariances, {name}", compressed.nbytes, compressed.expand()))
    stored = []
    for name, size, pyramid in forms:
        pairs = list(zip(coverage(pyramid), best, strict=True))
        change = [(f.mean() - b.mean()) / b.mean() if b.mean() > 0 else np.nan for f, b in pairs]
        worst = [np.abs(f - b).max() for f, b in pairs]
        stored.append(Stored(name, size, np.asarray(change), np.asarray(worst)))
    return tuple(stored)
