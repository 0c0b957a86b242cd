"""Coverage belongs to the sea and its breaking wavenumber, not to the grid that carries the waves."""

import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean.surface import cell_energy
from jaxocean.whitecaps import ExactClosure, StrainStatistics

LIMIT = 36.0  # rad/m, resolved by all grids below


def lattice_statistics(spectrum, cascade) -> StrainStatistics:
    """Covariance of the strain as the waves of the lattice make it, summed in NumPy."""
    n = cascade.resolution
    covariance = np.zeros((3, 3))
    for size, energy in zip(cascade.sizes, np.asarray(cell_energy(spectrum, cascade)), strict=True):
        along = 2 * np.pi * np.fft.fftfreq(n, 1 / n) / size
        kx, ky = np.meshgrid(along, along)
        k = np.hypot(kx, ky)
        k[0, 0] = 1.0
        low_pass = np.asarray(jo.spectra.breaking_filter(jnp.asarray(k), LIMIT))
        strain = np.stack([kx * kx, ky * ky, kx * ky]) * low_pass / k
        covariance += np.einsum("ayx,byx,yx->ab", strain, strain, energy)
    return StrainStatistics(jnp.zeros(3), jnp.asarray(covariance))


@pytest.fixture(scope="module")
def reference():
    spectrum = jo.spectra.Elfouhaily(jo.Wind(10.0), inverse_wave_age=0.84)
    stats = jo.whitecaps.strain_statistics(spectrum, 1.0, band=(1e-3, 400.0), breaking_wavenumber=LIMIT)
    return spectrum, [float(ExactClosure(measure)(stats, 0.5)) for measure in ("rest", "projected")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sizes", "resolution"),
    [
        ((893.0, 101.0, 21.0, 11.0), 128),
        ((893.0, 101.0, 21.0, 11.0), 256),
        ((893.0, 101.0, 21.0, 11.0), 512),
        ((1024.0, 83.0, 13.0), 256),
    ],
)
def test_coverage_is_the_same_on_every_grid_that_resolves_the_breaking_wavenumber(
    reference, sizes, resolution
):
    spectrum, expected = reference
    stats = lattice_statistics(spectrum, jo.surface.Cascade(sizes=sizes, resolution=resolution))
    found = [float(ExactClosure(measure)(stats, 0.5)) for measure in ("rest", "projected")]
    np.testing.assert_allclose(found, expected, rtol=0.01)
