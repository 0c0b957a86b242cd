"""What closures make of the footprints of one tile, and how far that is from what breaks in them."""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import jaxocean as jo
from jaxocean import filtering
from jaxocean.whitecaps import (
    ExactClosure,
    GaussianClosure,
    PrintedTwoChannelClosure,
    ProgramTwoChannelClosure,
    StrainStatistics,
    footprint_statistics,
)

from ..common._tiles import Footprints, Tile, covered

CLOSURES = (
    "exact",
    "gaussian",
    "program",
    "printed",
    "exact_independent",
    "exact_pyramid",
    "exact_refined_pyramid",
)
"""The first four on moments of the footprint itself; the others are the exact closure on covariances that are added
over the patterns: in the footprint, and as pyramids give them."""

NEGLIGIBLE = 6.0
"""Where the mean of j lies so many deviations above ε, W is below 1e-6 and is not worth an exact closure."""

CHUNK = 8192


class Errors(NamedTuple):
    """Of one sea: closure minus truth, per closure, threshold and size of the footprint."""

    truth: np.ndarray  # (threshold,): what breaks of the tile
    bias: np.ndarray  # (closure, threshold, size): mean error, where the closure is defined
    squared: np.ndarray  # (closure, threshold, size): mean squared error
    defined: np.ndarray  # (closure, size): share of the footprints


def measure(
    footprints: Footprints, fields: jo.surface.Fields, cascade: jo.surface.Cascade, tile: Tile, thresholds
) -> Errors:
    """The errors of all closures on one tile."""
    squares = tile.footprints()
    looked = [
        footprint_statistics(
            filtering.MomentPyramid.from_fields(fields, cascade, refinement=n)(squares, probes=1)
        )
        for n in (1, 2)
    ]
    shape = (len(CLOSURES), len(thresholds), len(tile.sides))
    errors = Errors(
        np.zeros(len(thresholds)), np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape[::2])
    )
    for t, threshold in enumerate(thresholds):
        true = np.asarray(covered(footprints.strain, threshold, tile), np.float64)
        errors.truth[t] = true[-1]
        for c, estimate in enumerate(_estimates(footprints, looked, threshold)):
            difference = np.asarray(estimate, np.float64) - true
            for s, part in enumerate(tile.segments()):
                known = difference[part][~np.isnan(difference[part])]
                errors.defined[c, s] = known.size / (part.stop - part.start)
                if known.size:
                    errors.bias[c, t, s], errors.squared[c, t, s] = known.mean(), np.mean(known**2)
    return errors


def _estimates(footprints: Footprints, looked: list[StrainStatistics], threshold: float) -> tuple[Any, ...]:
    """W of every footprint, at rest, in the order of `CLOSURES`."""
    levels = jnp.full(len(footprints.channels), threshold, footprints.strain.dtype)
    return (
        exact(footprints.summed, threshold),
        _apply(GaussianClosure("rest"), footprints.summed, levels),
        _apply(ProgramTwoChannelClosure(), footprints.channels, threshold),
        _apply(PrintedTwoChannelClosure(), footprints.channels, threshold),
        exact(footprints.independent, threshold),
        *(exact(each, threshold) for each in looked),
    )


def exact(stats: StrainStatistics, threshold: float) -> Float[np.ndarray, " footprint"]:
    """W at rest by the exact closure, evaluated where it is not negligible."""
    chosen = np.flatnonzero(
        np.asarray(_distance(stats, jnp.asarray(threshold, stats.mean.dtype))) < NEGLIGIBLE
    )
    coverage = np.zeros(len(stats.mean))
    for start in range(0, chosen.size, CHUNK):
        # The last chunk is filled up: another length would be another program.
        which = np.resize(chosen[start : start + CHUNK], CHUNK)
        part = StrainStatistics(stats.mean[which], stats.covariance[which])
        coverage[which] = np.asarray(_apply(ExactClosure("rest"), part, threshold))
    return coverage


@eqx.filter_jit
def _apply(closure, moments, threshold) -> Float[Array, " footprint"]:
    return closure(moments, threshold)


@jax.jit
def _distance(stats: StrainStatistics, threshold: Float[Array, ""]) -> Float[Array, " footprint"]:
    """Of the mean of j from ε, in deviations."""
    return (stats.jacobian_mean() - threshold) / jnp.sqrt(stats.jacobian_variance())
