"""Seas whose waves are known one by one."""

import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean.surface import Cascade, Sea, realise

GRAVITY = 9.81


def wind_sea(speed=8.0, direction=0.4):
    return jo.spectra.Elfouhaily(jo.Wind(speed, direction))


def single_wave(iy: int, ix: int, cascade: Cascade, pattern: int = 0) -> tuple[Sea, complex, float, float]:
    """A sea with one wave, and its h0, kx and ky."""
    noise = np.zeros((cascade.count, cascade.resolution, cascade.resolution), np.complex128)
    noise[pattern, iy, ix] = 0.8 - 0.6j
    sea = realise(wind_sea(), cascade, noise=jnp.asarray(noise))
    width = 2 * np.pi / cascade.sizes[pattern]
    return sea, complex(sea.amplitude[pattern, iy, ix]), ix * width, iy * width


def half_noise(cascade: Cascade) -> jnp.ndarray:
    """Unit amplitudes on one half of the plane: the variance over the grid is then exactly ΣE, not on average."""
    n = cascade.resolution
    index = np.fft.fftfreq(n, 1 / n)
    half = (index[:, None] > 0) | ((index[:, None] == 0) & (index > 0))
    phases = np.random.default_rng(0).uniform(0, 2 * np.pi, (cascade.count, n, n))
    return jnp.asarray(np.sqrt(2) * half * np.exp(1j * phases))


def strain_variances(spectrum, band) -> np.ndarray:
    """Variances of a, b and c by quadrature over a band of wavenumbers, λ = 1."""
    x, w = np.polynomial.legendre.leggauss(40)
    edges = np.linspace(*np.log(band), 13)
    half, middle = 0.5 * np.diff(edges)[:, None], 0.5 * (edges[1:] + edges[:-1])[:, None]
    k = np.exp(middle + half * x).ravel()
    weights = (half * w).ravel() * k
    phi = np.arange(128) * (2 * np.pi / 128)
    kk, angle = np.broadcast_arrays(k[:, None], phi)
    density = np.asarray(spectrum.density(jnp.asarray(kk), jnp.asarray(angle))) * 2 * np.pi / 128
    cos, sin = np.cos(phi), np.sin(phi)
    return np.array(
        [np.sum(weights[:, None] * k[:, None] ** 3 * density * f) for f in (cos**4, sin**4, (cos * sin) ** 2)]
    )
