"""Footprint moments of any surface, by asking it at points."""

import jax.numpy as jnp
import numpy as np

from .._types import ScalarLike
from ..surface import AbstractSurface
from ._footprint import Footprint
from ._moments import Moments


def sampled_moments(
    surface: AbstractSurface, footprint: Footprint, time: ScalarLike, *, nodes: int = 8
) -> Moments:
    """Means and covariances of slopes and strain over footprints of any surface that speaks the protocol.

    The product rule of Gauss and Legendre in the footprint: exact for polynomials of degree 2·nodes − 1 along each
    edge, so that it converges fast as soon as a wave has a few nodes; nothing is assumed to be independent.

    **Arguments:** `surface`: FFT sea, trochoids, noise, …; `footprint`: any batch; `time` t [s]; `nodes`: along each
    edge.

    **Returns:** `Moments`, batched like the footprint.

    **Raises:** `ValueError` for less than one node.
    """
    if nodes < 1:
        raise ValueError(f"Argument `nodes` must be at least 1, but is {nodes}.")
    along, weight = np.polynomial.legendre.leggauss(nodes)
    u = 0.5 * np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    centre, axes = footprint.centre, footprint.axes
    if isinstance(centre, np.ndarray) and isinstance(axes, np.ndarray):
        points = centre[..., None, :] + np.einsum("...ij,qj->...qi", axes, u)
    else:
        centre, axes = jnp.asarray(centre), jnp.asarray(axes)
        dtype = jnp.result_type(centre, axes)
        inside = jnp.einsum("...ij,qj->...qi", axes.astype(dtype), jnp.asarray(u, dtype))
        points = centre.astype(dtype)[..., None, :] + inside
    slope, strain = surface.slope(points, time), surface.strain(points, time)
    share = jnp.asarray(0.25 * np.outer(weight, weight).ravel(), slope.dtype)
    slope_mean, slope_covariance = _moments(slope, share)
    strain_mean, strain_covariance = _moments(strain, share)
    return Moments(slope_mean, slope_covariance, strain_mean, strain_covariance)


def _moments(values, share):
    mean = jnp.einsum("...qi,q->...i", values, share)
    apart = values - mean[..., None, :]
    return mean, jnp.einsum("...qi,...qj,q->...ij", apart, apart, share)
