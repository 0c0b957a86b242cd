"""All fields of a sea at one time, from one batched inverse FFT."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from ..._types import Scalar
from ...spectra import breaking_filter
from ._apart import compute_apart
from ._cascade import Cascade
from ._cells import lattice_indices
from ._complex import scale, turn
from ._evolve import Waves, height_spectrum
from ._phase import Clock


class Fields(eqx.Module):
    """Height, displacement, slope and strain of every pattern at the samples of its rest plane.

    Indexed [pattern, y, x]. The transform leaves two real fields in each complex plane; the properties unpack
    them, and under `jit` only what is used is unpacked. There are four planes, and two more with a low-pass.
    """

    packed: Complex[Array, "*b pattern plane y x"]

    @property
    def height(self) -> Float[Array, "*b pattern y x"]:
        """Height η [m]."""
        return self._plane(0).real

    @property
    def displacement(self) -> Float[Array, "*b pattern y x 2"]:
        """Horizontal displacement λ(u, v) [m]."""
        return jnp.stack([self._plane(0).imag, self._plane(1).imag], axis=-1)

    @property
    def slope(self) -> Float[Array, "*b pattern y x 2"]:
        """Slope (∂η/∂x, ∂η/∂y) [-] on the rest plane."""
        return jnp.stack([self._plane(2).imag, self._plane(3).imag], axis=-1)

    @property
    def strain(self) -> Float[Array, "*b pattern y x 3"]:
        """Strain (a, b, c) = λ(∂u/∂x, ∂v/∂y, ∂u/∂y) [-], low-passed at the breaking wavenumber."""
        return jnp.stack([self._plane(2).real, self._plane(3).real, self._plane(1).real], axis=-1)

    @property
    def short_strain(self) -> Float[Array, "*b pattern y x 3"] | None:
        """What the low-pass took from the strain [-]: their sum is how the surface itself is deformed.

        None if there was no low-pass.
        """
        if self.packed.shape[-3] == 4:
            return None
        return jnp.stack([self._plane(4).real, self._plane(4).imag, self._plane(5).real], axis=-1)

    def _plane(self, number: int) -> Complex[Array, "*b pattern y x"]:
        return self.packed[..., number, :, :]


class Filters(eqx.Module):
    """What turns the height spectrum ĥ into the spectra of the fields, each a real array over the waves.

    With e^{+ik·x}: D̂ = +i (k/|k|) ĥ, slopes i k ĥ, strains −(kx², ky², kx ky)/|k| ĥ.
    """

    kx: Float[Array, "pattern 1 x"]
    ky: Float[Array, "pattern y 1"]
    inverse: Float[Array, "pattern y x"]  # λ/|k|, 0 at k = 0
    strain: Float[Array, "pattern y x"]  # the same times the low-pass

    def apply(
        self, names: tuple[str, ...], spectrum: Complex[Array, "pattern y x"]
    ) -> Complex[Array, "pattern field y x"]:
        """The spectra of the named real fields, one behind the other."""
        kx, ky = self.kx, self.ky
        odd = {"u": kx * self.inverse, "v": ky * self.inverse, "slope_x": kx, "slope_y": ky}
        even = {
            "height": jnp.ones_like(kx),
            "a": -kx * kx * self.strain,
            "b": -ky * ky * self.strain,
            "c": -kx * ky * self.strain,
        }
        spectra = [scale(turn(spectrum), odd[n]) if n in odd else scale(spectrum, even[n]) for n in names]
        return jnp.stack(spectra, axis=1)


def wave_filters(
    cascade: Cascade, choppiness: Float[Array, " pattern"], breaking_wavenumber: Scalar | None
) -> Filters:
    """The filters of a cascade for choppiness λ_i and a breaking wavenumber k_b [rad/m] or None."""
    dtype = choppiness.dtype
    width = jnp.asarray(2 * np.pi / np.asarray(cascade.sizes), dtype)[:, None, None]
    index = jnp.asarray(lattice_indices(cascade.resolution), dtype)
    kx = index * width
    ky = index[:, None] * width
    square = kx**2 + ky**2
    moves = square > 0
    k = jnp.sqrt(jnp.where(moves, square, 1.0))
    inverse = jnp.where(moves, 1 / k, 0.0) * choppiness[:, None, None]
    strain = inverse if breaking_wavenumber is None else inverse * breaking_filter(k, breaking_wavenumber)
    return Filters(kx, ky, inverse, strain)


def fields_of_waves(
    cascade: Cascade,
    waves: Waves,
    clock: Clock,
    choppiness: Float[Array, " pattern"],
    breaking_wavenumber: Scalar | None,
) -> Fields:
    """All fields at the time of `clock`, for choppiness λ_i and a breaking wavenumber k_b [rad/m] or None.

    Two programs, unless the caller compiles them into one: on the CPU, XLA runs a transform on all cores only
    where it is the first thing that a program does.
    """
    return Fields(_transform(_pack(cascade, waves, clock, choppiness, breaking_wavenumber)))


@partial(jax.jit, static_argnums=0)
def _pack(
    cascade: Cascade,
    waves: Waves,
    clock: Clock,
    choppiness: Float[Array, " pattern"],
    breaking_wavenumber: Scalar | None,
) -> Complex[Array, "pattern plane y x"]:
    """Spectra of pairs of fields, (η, u), (c, v), (a, ∂η/∂x) and (b, ∂η/∂y).

    An even field f and an odd field g share one complex transform of F̂ + iĜ. Since ĝ is i times a real
    factor of ĥ, F̂ + iĜ is ĥ times a real number. With a low-pass (a, b) and c of what it takes away, all even.
    """

    def evolve() -> tuple[Complex[Array, "pattern y x"], Filters]:
        return height_spectrum(waves, clock), wave_filters(cascade, choppiness, breaking_wavenumber)

    spectrum, filters = compute_apart(evolve, jnp.isfinite(clock.seconds))
    kx, ky, inverse, strain = (f[:, None] for f in (filters.kx, filters.ky, filters.inverse, filters.strain))
    # One expression for the four planes, with unit vectors along their axis, is one loop that vectorises:
    # stacked arrays would be four, with a branch at every element. The N² undoes that of the inverse transform.
    height_u, c_v, a_x, b_y = cascade.resolution**2 * jnp.eye(4, dtype=kx.dtype)[..., None, None]
    along_x = inverse * height_u + strain * (kx * a_x + ky * c_v) + a_x
    along_y = inverse * c_v + strain * (ky * b_y) + b_y
    planes = scale(spectrum[:, None], height_u - kx * along_x - ky * along_y)
    if breaking_wavenumber is None:
        return planes
    short = -(cascade.resolution**2) * (inverse - strain)
    factors = jnp.concatenate(
        [jax.lax.complex(kx * kx * short, ky * ky * short), (kx * ky * short).astype(spectrum.dtype)], axis=1
    )
    return jnp.concatenate([planes, spectrum[:, None] * factors], axis=1)


@partial(jax.jit, static_argnums=0)
def strains_of_waves(
    cascade: Cascade,
    waves: Waves,
    clock: Clock | None,
    choppiness: Float[Array, " pattern"],
    breaking_wavenumber: Scalar | None,
) -> Float[Array, "pattern y x 3"]:
    """The strain alone at the time of `clock`, at t = 0 where it is None; in 3/8 of the transforms of all fields.

    Strains are even, so any two of them share a transform of F̂ + iĜ: a and b of one pattern, c of two.
    """
    spectrum = waves.cosine if clock is None else height_spectrum(waves, clock)
    filters = wave_filters(cascade, choppiness, breaking_wavenumber)
    kx, ky, factor = filters.kx, filters.ky, -(cascade.resolution**2) * filters.strain
    a_b = spectrum * jax.lax.complex(kx * kx * factor, ky * ky * factor)
    c = scale(spectrum, kx * ky * factor)
    if odd := cascade.count % 2:
        c = jnp.concatenate([c, jnp.zeros_like(c[:1])])
    planes = jnp.fft.ifft2(jnp.concatenate([a_b, c[0::2] + turn(c[1::2])]))
    a_b, c = planes[: cascade.count], planes[cascade.count :]
    c = jnp.stack([c.real, c.imag], axis=1).reshape(-1, *c.shape[1:])
    return jnp.stack([a_b.real, a_b.imag, c[: c.shape[0] - odd]], axis=-1)


@jax.jit
def _transform(planes: Complex[Array, "pattern plane y x"]) -> Complex[Array, "pattern plane y x"]:
    return jnp.fft.ifft2(planes)
