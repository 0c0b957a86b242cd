"""Second moments of the strain (a, b, c), straight from the spectrum: no FFT, no sampling."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar, leaf_dtype
from .._types import PerPattern, Scalar, ScalarLike
from ..spectra import AbstractSpectrum, Harmonics, band_quadrature, breaking_filter
from ..surface import Cascade, pattern_choppiness


class StrainStatistics(eqx.Module):
    """Mean and covariance of the strain (a, b, c), choppiness included.

    **Arguments:**

    - `mean`: E(a, b, c) [-], zero on the whole plane, not in a footprint.
    - `covariance`: symmetric, positive semi-definite [-].
    - `patterns`: the same per pattern (leading axis `pattern`), or None where the sea is not split.
    """

    mean: Float[Array, "*b 3"]
    covariance: Float[Array, "*b 3 3"]
    patterns: "StrainStatistics | None" = None

    def jacobian_mean(self) -> Float[Array, "*b"]:
        """E[j] = (1 + E a)(1 + E b) − (E c)² + Cov(a, b) − Var(c); 1 on the whole plane."""
        a, b, c = (self.mean[..., i] for i in range(3))
        return (1 + a) * (1 + b) - c**2 + self.covariance[..., 0, 1] - self.covariance[..., 2, 2]

    def jacobian_variance(self) -> Float[Array, "*b"]:
        """Var(j) for Gaussian strain.

        $$ Var(j) = 2 tr((CM)²) + 4 x^T M C M x, \\quad j = x^T M x, \\; x = (1 + a, 1 + b, c) $$

        On the whole plane that is A + B + 2S + AB + 3S² − 4PQ.
        """
        p, q = 1 + self.mean[..., 0], 1 + self.mean[..., 1]
        c = self.mean[..., 2]
        gradient = jnp.stack([q, p, -2 * c], axis=-1)  # 2Mx
        linear = jnp.einsum("...i,...ij,...j->...", gradient, self.covariance, gradient)
        cm = covariance_times_form(self.covariance)
        return linear + 2 * jnp.einsum("...ij,...ji->...", cm, cm)

    def jacobian_skewness(self) -> Float[Array, "*b"]:
        """Third standardised cumulant of j for Gaussian strain: 0 if j were Gaussian; NaN for a sea without strain.

        $$ γ = \\frac{8 tr((CM)³) + 24 x^T M C M C M x}{Var(j)^{3/2}} $$
        """
        p, q = 1 + self.mean[..., 0], 1 + self.mean[..., 1]
        gradient = jnp.stack([q, p, -2 * self.mean[..., 2]], axis=-1)  # 2Mx
        along = jnp.einsum("...ij,...j->...i", self.covariance, gradient)
        linear = along[..., 0] * along[..., 1] - along[..., 2] ** 2  # its quadratic form M
        cm = covariance_times_form(self.covariance)
        cubic = jnp.einsum("...ij,...jk,...ki->...", cm, cm, cm)
        return (8 * cubic + 6 * linear) / self.jacobian_variance() ** 1.5


def covariance_times_form(covariance: Float[Array, "*b 3 3"]) -> Float[Array, "*b 3 3"]:
    """CM with the matrix M of the quadratic form j = xᵀMx, x = (1 + a, 1 + b, c)."""
    columns = (0.5 * covariance[..., :, 1], 0.5 * covariance[..., :, 0], -covariance[..., :, 2])
    return jnp.stack(columns, axis=-1)


def strain_covariance(harmonics: Harmonics, weights: Float[Array, "*k"]) -> Float[Array, "3 3"]:
    """Covariance of (a, b, c) from angular harmonics [m³] and weights [rad/m] that hold the quadrature and λ².

    $$ A = ∫\\frac{k_x^4}{k²}Ψ, \\; B = ∫\\frac{k_y^4}{k²}Ψ, \\; S = ∫\\frac{k_x²k_y²}{k²}Ψ, \\;
       P = ∫\\frac{k_x³k_y}{k²}Ψ, \\; Q = ∫\\frac{k_xk_y³}{k²}Ψ $$

    **Returns:** [[A, S, P], [S, B, Q], [P, Q, S]] [-].
    """
    mean, cos2, sin2, cos4, sin4 = (jnp.sum(weights * h) for h in harmonics)
    a = (3 * mean + 4 * cos2 + cos4) / 8
    b = (3 * mean - 4 * cos2 + cos4) / 8
    s = (mean - cos4) / 8
    p = (2 * sin2 + sin4) / 8
    q = (2 * sin2 - sin4) / 8
    return jnp.stack([jnp.stack([a, s, p]), jnp.stack([s, b, q]), jnp.stack([p, q, s])])


def strain_statistics(
    spectrum: AbstractSpectrum,
    choppiness: PerPattern = 1.0,
    *,
    band: tuple[float, float] | None = None,
    cascade: Cascade | None = None,
    breaking_wavenumber: ScalarLike | None = None,
) -> StrainStatistics:
    """Mean and covariance of the strain of a linear Gaussian sea, by quadrature over its spectrum.

    $$ C = λ² ∫ G(k)² k^{-2} (k_x², k_y², k_xk_y)(k_x², k_y², k_xk_y)^T Ψ \\, d²k $$

    **Arguments:**

    - `spectrum`: Ψ [m⁴].
    - `choppiness`: λ [-], one number or, with a cascade, one per pattern.
    - `band`: (lower, upper) wavenumber [rad/m] of the waves that count; or
    - `cascade`: the patterns whose bands count. Give exactly one of the two.
    - `breaking_wavenumber`: k_b [rad/m] of the low-pass that foam sees, or None for none.

    **Returns:** `StrainStatistics`; its `patterns` hold one entry per pattern (one for a band).

    **Raises:** `ValueError` if both or neither of band and cascade are given, for a band that is empty, and for
    more values of λ than patterns.
    """
    if (band is None) == (cascade is None):
        given = "neither is" if band is None else "both are"
        raise ValueError(f"Give exactly one of `band` and `cascade`, but {given} given.")
    if cascade is not None:
        bands = cascade.bands
    else:
        assert band is not None
        bands = (band,)
    dtype = leaf_dtype(spectrum)
    lam = pattern_choppiness(choppiness, len(bands)).astype(dtype)
    limit = None if breaking_wavenumber is None else as_leaf(breaking_wavenumber).astype(dtype)
    check_scalar("breaking_wavenumber", limit, "rad/m", positive=True)
    # A fit that strays must not take the mirror image of its way for an answer.
    limit = None if limit is None else jnp.where(limit > 0, limit, jnp.nan)
    return _integrate(spectrum, lam, bands, limit)


@eqx.filter_jit
def _integrate(
    spectrum: AbstractSpectrum,
    choppiness: Float[Array, " n"],
    bands: tuple[tuple[float, float], ...],
    breaking_wavenumber: Scalar | None,
) -> StrainStatistics:
    """All bands at once: their nodes laid end to end."""
    dtype = choppiness.dtype
    rules = [band_quadrature(spectrum, one) for one in bands]
    ends = np.cumsum([0] + [nodes.size for nodes, _ in rules])
    k = jnp.concatenate([nodes for nodes, _ in rules]).astype(dtype)
    weights = jnp.concatenate([w for _, w in rules]).astype(dtype)
    weights = weights * (k * breaking_filter(k, breaking_wavenumber)) ** 2
    harmonics = spectrum.harmonics(k)
    covariances = jnp.stack(
        [
            choppiness[i] ** 2 * strain_covariance(Harmonics(*(h[one] for h in harmonics)), weights[one])
            for i, one in enumerate(map(slice, ends[:-1], ends[1:]))
        ]
    )
    patterns = StrainStatistics(jnp.zeros((len(bands), 3), dtype), covariances)
    return StrainStatistics(jnp.zeros(3, dtype), jnp.sum(covariances, axis=0), patterns)
