"""Where the surface breaks in the space of strains, seen along rays from the state of rest.

In whitened coordinates z, with (s, d, c) = (1, 0, 0) + L z, s = 1 + (a + b)/2, d = (a − b)/2, the Jacobian
j = s² − d² − c² is a quadratic along each ray z = ρn, so that its breaking stretch is known in closed form. Nothing
is divided by a standard deviation: a sea whose strain is nearly one-dimensional is no special case.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from ..._numerics import safe_sqrt
from ..._types import Scalar

FARTHEST = 100.0
"""Distance in standard deviations beyond which nothing happens."""

TO_SDC = np.array([[0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [0.0, 0.0, 1.0]])
"""From (a, b, c) to ((a + b)/2, (a − b)/2, c)."""


class Rays(NamedTuple):
    """Directions of the unit sphere and the distances at which j passes ε along them."""

    direction: Float[Array, "ray 3"]
    solid_angle: Float[Array, " ray"]
    along: Float[Array, "ray 3"]
    """What one unit of distance adds to (s, d, c)."""
    enter: Float[Array, " ray"]
    leave: Float[Array, " ray"]
    breaks: Bool[Array, " ray"]
    """Whether the ray enters the breaking region."""
    folds: Bool[Array, " ray"]
    """Whether it leaves it again, on the far side of a fold."""
    slope: Float[Array, " ray"]
    """|dj/dρ| where it passes ε."""


def to_sdc(covariance: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    """A covariance of (a, b, c) as one of (s, d, c)."""
    turn = jnp.asarray(TO_SDC, covariance.dtype)
    return turn @ covariance @ turn.T


def factor(covariance: Float[Array, "n n"]) -> Float[Array, "n n"]:
    """A lower-triangular L with LLᵀ = C, whose eigenvalues are lifted by rounding's share of the trace."""
    finfo = jnp.finfo(covariance.dtype)
    floor = 8 * finfo.eps * jnp.trace(covariance) + finfo.tiny**0.5
    return jnp.linalg.cholesky(covariance + floor * jnp.eye(covariance.shape[0], dtype=covariance.dtype))


def cast_rays(covariance: Float[Array, "3 3"], threshold: Scalar, latitudes: int, longitudes: int) -> Rays:
    """Rays in all directions for a strain of mean 0 and a threshold ε < 1 (none breaks otherwise).

    **Arguments:** `covariance` of (a, b, c); `latitudes` Gauss–Legendre nodes times `longitudes` equal angles.
    """
    dtype = covariance.dtype
    direction, solid_angle = (jnp.asarray(x, dtype) for x in _sphere(latitudes, longitudes))
    along = direction @ factor(to_sdc(covariance)).T
    square = along[:, 0] ** 2 - along[:, 1] ** 2 - along[:, 2] ** 2
    linear = 2 * along[:, 0]
    gap = 1 - threshold.astype(dtype)
    discriminant = linear**2 - 4 * square * gap
    slope = safe_sqrt(discriminant)
    nearest = gap * (2 / FARTHEST)
    met = (discriminant > 0) & (gap > 0)

    def distance(rise: Float[Array, " ray"]) -> tuple[Float[Array, " ray"], Bool[Array, " ray"]]:
        reached = met & (rise > nearest)
        return 2 * gap / jnp.where(reached, rise, 1.0), reached

    enter, breaks = distance(slope - linear)
    leave, folds = distance(-slope - linear)
    return Rays(direction, solid_angle, along, enter, leave, breaks, breaks & folds, slope)


def _sphere(latitudes: int, longitudes: int) -> tuple[np.ndarray, np.ndarray]:
    height, weight = np.polynomial.legendre.leggauss(latitudes)
    angle = (np.arange(longitudes) + 0.5) * (2 * np.pi / longitudes)
    radius = np.sqrt(1 - height**2)
    direction = np.stack(
        [
            np.repeat(height, longitudes),
            np.outer(radius, np.cos(angle)).ravel(),
            np.outer(radius, np.sin(angle)).ravel(),
        ],
        axis=-1,
    )
    return direction, np.repeat(weight, longitudes) * (2 * np.pi / longitudes)
