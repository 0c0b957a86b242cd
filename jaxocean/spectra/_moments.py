"""Integral parameters of a sea state by quadrature over wavenumber."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import leaf_dtype, logarithmic_nodes, safe_sqrt
from .._types import Scalar
from ._spectrum import AbstractSpectrum

BAND = (1e-3, 400.0)
"""Default band of wavenumbers [rad/m]."""


def height_variance(spectrum: AbstractSpectrum, *, band: tuple[float, float] = BAND) -> Scalar:
    """Var(η) = ∬Ψ dkx dky [m²] of the waves with k in `band` [rad/m]."""
    return _moment(spectrum, band, power=0)


def significant_wave_height(spectrum: AbstractSpectrum, *, band: tuple[float, float] = BAND) -> Scalar:
    """Hs = 4 √Var(η) [m] of the waves with k in `band` [rad/m]; 0 with gradient 0 for a calm sea."""
    return 4 * safe_sqrt(height_variance(spectrum, band=band))


def mean_square_slope(spectrum: AbstractSpectrum, *, band: tuple[float, float] = BAND) -> Scalar:
    """mss = ∬k²Ψ dkx dky [-] of the waves with k in `band` [rad/m], both directions together."""
    return _moment(spectrum, band, power=2)


def slope_variance(
    spectrum: AbstractSpectrum, *, band: tuple[float, float] = BAND
) -> tuple[Scalar, Scalar, Scalar]:
    """(Var ∂η/∂x, Var ∂η/∂y, their covariance) [-] of the waves with k in `band` [rad/m]."""
    k, weights = band_quadrature(spectrum, band)
    h = spectrum.harmonics(k)
    w = weights * k**2
    return (
        jnp.sum(w * 0.5 * (h.mean + h.cos2)),
        jnp.sum(w * 0.5 * (h.mean - h.cos2)),
        jnp.sum(w * 0.5 * h.sin2),
    )


def band_nodes(band: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Quadrature nodes and weights [rad/m] for a band of wavenumbers, after checking it."""
    lower, upper = band
    if not 0 < lower < upper < float("inf"):
        raise ValueError(
            "Argument `band` must be (lower, upper) with 0 < lower < upper in rad/m, "
            f"but is ({lower:g}, {upper:g})."
        )
    return logarithmic_nodes(lower, upper)


def band_quadrature(
    spectrum: AbstractSpectrum, band: tuple[float, float]
) -> tuple[Float[Array, " k"], Float[Array, " k"]]:
    """Quadrature nodes and weights [rad/m] for one spectrum over a band, in the type of its leaves.

    Panels end at the spectrum's `kinks`, so that a table is integrated as exactly as a smooth model.
    """
    nodes, weights = band_nodes(band)
    dtype = leaf_dtype(spectrum)
    kinks = spectrum.kinks()
    if kinks.size == 0:
        return jnp.asarray(nodes, dtype), jnp.asarray(weights, dtype)
    lower, upper = band
    smooth = np.linspace(np.log(lower), np.log(upper), int(np.ceil(2 * np.log(upper / lower))) + 1)
    edges = jnp.concatenate([jnp.asarray(smooth, dtype), jnp.log(jnp.clip(kinks, lower, upper))])
    edges = jnp.sort(edges)[:, None]
    x, w = (jnp.asarray(one, dtype) for one in np.polynomial.legendre.leggauss(10))
    half = 0.5 * (edges[1:] - edges[:-1])
    k = jnp.exp(0.5 * (edges[1:] + edges[:-1]) + half * x).ravel()
    return k, (half * w).ravel() * k


def _moment(spectrum: AbstractSpectrum, band: tuple[float, float], *, power: int) -> Scalar:
    k, weights = band_quadrature(spectrum, band)
    return jnp.sum(weights * k**power * spectrum.harmonics(k).mean)
