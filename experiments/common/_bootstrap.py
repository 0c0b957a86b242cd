"""Intervals of a statistic of records that are alike when they are close in time."""

import warnings
from collections.abc import Callable

import numpy as np


def block_interval(
    statistic: Callable[[np.ndarray], np.ndarray],
    block: np.ndarray,
    *,
    resamples: int,
    confidence: float,
    seed: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Percentile interval by resampling whole blocks of records.

    **Arguments:** `statistic`: from the places of a resample's records to numbers; `block`: of each record, any number
    that is the same for the records of one block.

    **Returns:** lower and upper ends, of the statistic's shape; NaN where there is only one block.
    """
    members = [np.flatnonzero(block == one) for one in np.unique(block)]
    shape = np.shape(statistic(np.arange(block.size)))
    if len(members) < 2:
        return np.full(shape, np.nan), np.full(shape, np.nan)
    rng = np.random.default_rng(seed)
    drawn = np.empty((resamples, *shape))
    for i in range(resamples):
        chosen = rng.integers(0, len(members), len(members))
        drawn[i] = statistic(np.concatenate([members[j] for j in chosen]))
    tail = 0.5 * (1 - confidence)
    with warnings.catch_warnings():
        # A number that no resample has stays unknown, without a word.
        warnings.simplefilter("ignore", RuntimeWarning)
        lower, upper = np.nanquantile(drawn, (tail, 1 - tail), axis=0)
    return lower, upper
