"""The sea as the program published with the whitecap paper draws it, kept for comparison."""

from collections.abc import Sequence

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float, PRNGKeyArray, UInt32

from .._numerics import as_leaf, check_scalar, is_concrete, leaf_dtype, safe_divide, safe_sqrt
from .._types import PerPattern, Scalar
from ..spectra import AbstractSpectrum
from ..surface import Cascade
from ._statistics import StrainStatistics


def _row(values: PerPattern) -> Float[Array, "..."]:
    return as_leaf(np.asarray(values, float) if isinstance(values, Sequence) else values)


class PublishedSea(eqx.Module):
    """The strain of the sea that Dupuy & Bruneton's program computes, and of its foam.

    It differs from `jaxocean.surface.realise` in four ways:

    - the waves of a pattern are those inside its square of wave numbers and outside that of the next larger
      pattern, max(|kx|, |ky|) ≥ πN/L_{i−1}, where ours are annuli;
    - each wave has the spectrum's density at its own place, E = f Ψ(k) Δk², where ours integrate over its cell;
    - only the phases are random;
    - f = 2, from an extra √2 in its amplitudes.

    Only the real parts of the spectra of its strains reach the transform, so that foam sees the **even part** of
    the strain of each pattern, ½[a(x) + a(−x)]: half of the variance.

    The Nyquist row is left out.

    **Arguments:**

    - `spectrum`: Ψ [m⁴].
    - `sizes`: L_i [m] of the patterns, from the largest to the smallest.
    - `choppiness`: λ_i [-], one per pattern.
    - `resolution`: N; static.
    - `variance_factor`: f [-].

    **Raises:** `ValueError` for sizes that do not decrease, or a choppiness that does not fit them.

    **Source:** Dupuy & Bruneton 2012, the program published with the paper.
    """

    spectrum: AbstractSpectrum
    sizes: Float[Array, " pattern"] = eqx.field(converter=_row)
    choppiness: Float[Array, " pattern"] = eqx.field(converter=_row)
    resolution: int = eqx.field(static=True, default=256)
    variance_factor: Scalar = eqx.field(converter=as_leaf, default=2.0)

    def __check_init__(self) -> None:
        check_scalar("variance_factor", self.variance_factor, "", minimum=0.0)
        if self.sizes.ndim != 1 or self.choppiness.shape != self.sizes.shape:
            raise ValueError(
                "Argument `choppiness` must hold one number for each of `sizes`, but their shapes are "
                f"{self.choppiness.shape} and {self.sizes.shape}."
            )
        if is_concrete(self.sizes):
            sizes = tuple(float(size) for size in np.asarray(self.sizes))
            Cascade(sizes, self.resolution)  # refuses sizes and resolutions that make no sense
            if sorted(sizes, reverse=True) != list(sizes):
                raise ValueError(f"Argument `sizes` must decrease, but is {sizes}.")

    def wave_energy(self) -> Float[Array, "pattern y x"]:
        """Height variance [m²] that each wave (ky, kx) of each pattern carries, in the order of the FFT."""
        kx, ky, _ = self._waves()
        n, width = self.resolution, 2 * np.pi / self.sizes
        larger = jnp.concatenate([self.sizes[:1] * n, self.sizes[:-1]])
        lowest = (np.pi * n / larger)[:, None, None]
        # Within rounding of the border a wave belongs to the smaller pattern.
        kept = jnp.maximum(jnp.abs(kx), jnp.abs(ky)) >= lowest * (1 - 1e-6)
        both = 0.5 * (self.spectrum(kx, ky) + self.spectrum(-kx, -ky))
        energy = self.variance_factor.astype(both.dtype) * both * width[:, None, None] ** 2
        return jnp.where(kept & ~self._nyquist(), energy, 0.0)

    def statistics(self, *, even: bool = False) -> StrainStatistics:
        """Mean and covariance of the strain over the plane, by pattern.

        **Arguments:** `even`: of the even part, which their foam sees.
        """
        share = 0.5 if even else 1.0
        weighted = share * self.wave_energy()[:, None, None] * self._strain_of_height()[:, :, None]
        covariances = jnp.sum(weighted * self._strain_of_height()[:, None], axis=(-2, -1))
        mean = jnp.zeros(3, covariances.dtype)
        patterns = StrainStatistics(jnp.zeros((self.sizes.size, 3), covariances.dtype), covariances)
        return StrainStatistics(mean, jnp.sum(covariances, axis=0), patterns)

    def strain(
        self, key: PRNGKeyArray | UInt32[Array, "2"], *, even: bool = False
    ) -> Float[Array, "pattern y x 3"]:
        """Strain (a, b, c) [-] of every pattern at its samples, choppiness included, for random phases.

        **Arguments:** `key`: from `jax.random.key`; `even`: the even part, which their foam sees.
        """
        n = self.resolution
        dtype = leaf_dtype(self.spectrum)
        # The transform of real noise has the symmetry of a real field's, and phases that are all alike.
        noise = jnp.fft.fft2(jax.random.normal(key, (self.sizes.size, n, n), dtype))
        size = jnp.abs(noise)
        phases = jax.lax.complex(safe_divide(noise.real, size), safe_divide(noise.imag, size))
        height = jnp.stack([phases.real, phases.imag]) * safe_sqrt(self.wave_energy())
        imaginary = jnp.zeros_like(height[0]) if even else height[1]
        spectra = self._strain_of_height() * n**2
        planes: Complex[Array, "pattern field y x"] = jax.lax.complex(
            spectra * height[0][:, None], spectra * imaginary[:, None]
        )
        return jnp.moveaxis(jnp.fft.ifft2(planes).real, 1, -1)

    def _waves(self) -> tuple[Float[Array, "pattern y x"], ...]:
        """kx, ky and 1/|k|, which is 0 at k = 0."""
        dtype = leaf_dtype(self.spectrum)
        index = jnp.asarray(np.fft.fftfreq(self.resolution, 1 / self.resolution), dtype)
        width = (2 * np.pi / self.sizes).astype(dtype)[:, None, None]
        shape = (self.sizes.size, self.resolution, self.resolution)
        kx, ky = jnp.broadcast_to(index * width, shape), jnp.broadcast_to(index[:, None] * width, shape)
        return kx, ky, safe_divide(jnp.ones_like(kx), safe_sqrt(kx**2 + ky**2))

    def _strain_of_height(self) -> Float[Array, "pattern 3 y x"]:
        """What turns the spectrum of the height into those of a, b and c: −λ(kx², ky², kx ky)/|k|."""
        kx, ky, inverse = self._waves()
        factor = -self.choppiness.astype(kx.dtype)[:, None, None] * inverse
        return jnp.stack([factor * kx * kx, factor * ky * ky, factor * kx * ky], axis=1)

    def _nyquist(self) -> np.ndarray:
        edge = np.arange(self.resolution) == self.resolution // 2
        return edge[:, None] | edge
