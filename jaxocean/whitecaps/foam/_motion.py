"""Second moments of the strain at two times, straight from the spectrum."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, leaf_dtype, logarithmic_nodes
from ..._types import PerPattern, ScalarLike
from ...spectra import AbstractSpectrum, Dispersion, Harmonics, band_nodes, breaking_filter
from ...surface import Cascade, pattern_choppiness
from .._statistics import StrainStatistics, strain_covariance

DENSITY = 10.0
"""Panels of 16 nodes per factor e in k, so that cos ωt is integrated for some tens of seconds."""


class StrainMotion(eqx.Module):
    """The strain (a, b, c) of one point of the rest plane as a stationary Gaussian process, choppiness included.

    $$ C(t) = Cov((a, b, c)(0), (a, b, c)(t)) = λ² ∫ G² k^{-2} (k_x², k_y², k_xk_y)(k_x², k_y², k_xk_y)^T
       \\cos(ωt) Ψ \\, d²k $$

    C(t) is symmetric and even in t, so that the strain and its rate of change at one time are independent.

    **Arguments:** made by `strain_motion`: `harmonics` [m³] of the spectrum at the nodes, quadrature `weights`
    [rad/m] that hold λ², k² and the low-pass, and `frequency` ω [rad/s].
    """

    harmonics: Harmonics
    weights: Float[Array, " k"]
    frequency: Float[Array, " k"]

    @property
    def statistics(self) -> StrainStatistics:
        """Mean and covariance of the strain at one time."""
        covariance = strain_covariance(self.harmonics, self.weights)
        return StrainStatistics(jnp.zeros_like(covariance[0]), covariance)

    @property
    def rate_covariance(self) -> Float[Array, "3 3"]:
        """Covariance −C″(0) [1/s²] of the strain's rate of change."""
        return strain_covariance(self.harmonics, self.weights * self.frequency**2)

    def lagged_covariance(self, lag: ScalarLike) -> Float[Array, "3 3"]:
        """C(t) [-] at the lag t [s]."""
        time = as_leaf(lag).astype(self.weights.dtype)
        return strain_covariance(self.harmonics, self.weights * jnp.cos(self.frequency * time))


@eqx.filter_jit
def strain_motion(
    spectrum: AbstractSpectrum,
    choppiness: PerPattern = 1.0,
    *,
    band: tuple[float, float] | None = None,
    cascade: Cascade | None = None,
    breaking_wavenumber: ScalarLike | None = None,
    dispersion: Dispersion | None = None,
) -> StrainMotion:
    """How the strain of a linear Gaussian sea moves.

    **Arguments:** as in `strain_statistics`, and `dispersion`: how fast waves travel, deep water by default (the one
    that the sea is realised with).

    **Returns:** `StrainMotion`.

    **Raises:** `ValueError` if both or neither of band and cascade are given, for a band that is empty, and for more
    values of λ than patterns.
    """
    if (band is None) == (cascade is None):
        given = "neither is" if band is None else "both are"
        raise ValueError(f"Give exactly one of `band` and `cascade`, but {given} given.")
    bands = cascade.bands if cascade is not None else (band,)
    dtype = leaf_dtype(spectrum)
    lam = pattern_choppiness(choppiness, len(bands)).astype(dtype)
    limit = None if breaking_wavenumber is None else as_leaf(breaking_wavenumber).astype(dtype)
    rules = [_dense_nodes(one) for one in bands if one is not None]
    k = jnp.asarray(np.concatenate([nodes for nodes, _ in rules]), dtype)
    weights = jnp.concatenate([lam[i] ** 2 * jnp.asarray(w, dtype) for i, (_, w) in enumerate(rules)])
    weights = weights * (k * breaking_filter(k, limit)) ** 2
    frequency = (Dispersion() if dispersion is None else dispersion).frequency(k).astype(dtype)
    return StrainMotion(spectrum.harmonics(k), weights, frequency)


def _dense_nodes(band: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    band_nodes(band)  # checks it
    lower, upper = band
    return logarithmic_nodes(lower, upper, panels=max(2, int(np.ceil(DENSITY * np.log(upper / lower)))))
