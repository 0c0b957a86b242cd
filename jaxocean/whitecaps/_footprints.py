"""From what a footprint sees of the strain to the statistics that closures take."""

import jax.numpy as jnp

from .._types import FloatLike
from ..filtering import Moments
from ._statistics import StrainStatistics

FLOOR = 1e-7
"""Variance [-] below which float32 moments say nothing: it blurs the threshold of a point by 4e-4."""


def footprint_statistics(moments: Moments, *, floor: FloatLike = FLOOR) -> StrainStatistics:
    """The strain's statistics in footprints, for any closure.

    With the whole plane as footprint they are those of the sea, with a point j itself: the coverage then is the
    indicator of j < ε, smooth over √(2·floor) so that it has a derivative.

    **Arguments:** `moments`: of `jaxocean.filtering`; `floor`: added to the variances of a, b and c [-], so that
    rounded moments of small footprints stay positive definite.

    **Returns:** `StrainStatistics`, batched like the moments.
    """
    covariance = moments.strain_covariance
    least = jnp.asarray(floor, covariance.dtype)
    # Element by element: on the CPU, XLA makes one loop over footprints of what is stacked and taken apart again.
    raised = [[covariance[..., i, j] + (least if i == j else 0.0) for j in range(3)] for i in range(3)]
    rows = [jnp.stack(row, axis=-1) for row in raised]
    return StrainStatistics(moments.strain_mean, jnp.stack(rows, axis=-2))
