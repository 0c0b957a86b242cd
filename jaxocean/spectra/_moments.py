"""Integral parameters of a sea state by quadrature over wavenumber."""

import jax.numpy as jnp
import numpy as np

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
    nodes, weights = band_nodes(band)
    k = jnp.asarray(nodes, leaf_dtype(spectrum))
    h = spectrum.harmonics(k)
    w = jnp.asarray(weights, k.dtype) * k**2
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


def _moment(spectrum: AbstractSpectrum, band: tuple[float, float], *, power: int) -> Scalar:
    nodes, weights = band_nodes(band)
    k = jnp.asarray(nodes, leaf_dtype(spectrum))
    return jnp.sum(jnp.asarray(weights, k.dtype) * k**power * spectrum.harmonics(k).mean)
