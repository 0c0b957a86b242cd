"""Autocovariances in closed form: against averages over realised seas, and against what a period means."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo

CASCADE = jo.surface.Cascade((60.0, 13.0), 32)
SPECTRUM = jo.spectra.Elfouhaily(jo.Wind(7.0, 0.4), 2.0)


@pytest.fixture(scope="module")
def sea():
    return jo.surface.realise(SPECTRUM, CASCADE, key=jax.random.key(2))


@pytest.fixture(scope="module")
def energy():
    return jo.surface.cell_energy(SPECTRUM, CASCADE)


def averaged(field, steps: int, axis: int) -> np.ndarray:
    """⟨f(x) f(x + r)⟩ over a periodic pattern, r a number of samples along x (axis 0) or y."""
    moved = np.roll(np.asarray(field), -steps, axis=2 if axis == 0 else 1)
    return np.einsum("pyx...i,pyx...j->pij", field, moved) / field.shape[1] ** 2


@pytest.mark.parametrize("axis", [0, 1])
def test_the_average_over_one_realised_sea_is_the_sum_over_its_waves(sea, axis):
    power = jnp.abs(sea.waves.cosine) ** 2
    fields = sea.fields(0.0, (1.5, 0.7), 6.0)
    for steps in (0, 1, 5, 17):
        lengths = steps * np.asarray(CASCADE.spacings)
        exact = jo.surface.autocovariance(power, CASCADE, lengths, axis=axis)
        strains = jo.surface.strain_autocovariance(
            power, CASCADE, lengths, choppiness=(1.5, 0.7), breaking_wavenumber=6.0, axis=axis
        )
        heights = averaged(fields.height[..., None], steps, axis)
        for i in range(2):
            np.testing.assert_allclose(exact[i, i], heights[i, 0, 0], rtol=1e-10, atol=1e-14)
            np.testing.assert_allclose(
                strains[i, i], averaged(fields.strain, steps, axis)[i], rtol=1e-9, atol=1e-13
            )


def test_at_no_distance_it_is_the_variance_and_a_pattern_returns_after_its_size(energy):
    distance = np.array([0.0, 60.0, 13.0, 7.77 * 60, 60e6])
    both = jo.surface.autocovariance(energy, CASCADE, distance)
    np.testing.assert_allclose(both[:, 0], jnp.sum(energy, (1, 2)), rtol=1e-12)
    np.testing.assert_allclose(both[0, 1], both[0, 0], rtol=1e-12)
    np.testing.assert_allclose(both[1, 2], both[1, 0], rtol=1e-12)
    # A million periods away the phases are still known.
    np.testing.assert_allclose(both[0, 4], both[0, 0], rtol=1e-9)
    assert float(jnp.abs(both[0, 3])) < 0.5 * float(both[0, 0])
    period = jo.surface.autocovariance(energy, CASCADE, np.array([CASCADE.period]))
    np.testing.assert_allclose(jnp.sum(period), jnp.sum(energy), rtol=1e-10)


def test_the_covariance_at_no_distance_is_that_of_the_statistics(energy):
    stats = jo.whitecaps.strain_statistics(SPECTRUM, 1.3, cascade=CASCADE, breaking_wavenumber=6.0)
    here = jo.surface.strain_autocovariance(
        energy, CASCADE, np.zeros(1), choppiness=1.3, breaking_wavenumber=6.0
    )
    # The lattice knows directions up to a cell.
    np.testing.assert_allclose(jnp.sum(here[:, 0], 0), stats.covariance, rtol=0.03, atol=1e-4)


def test_the_jacobians_autocovariance_follows_exactly(energy):
    strain = jo.surface.strain_autocovariance(energy, CASCADE, np.array([0.0, 0.3]), choppiness=5.0)
    here, there = jnp.sum(strain, 0)
    joint = jnp.block([[here, there], [there, here]])
    values, vectors = jnp.linalg.eigh(joint)
    root = vectors * jnp.sqrt(jnp.maximum(values, 0))
    draws = jax.random.normal(jax.random.key(0), (1_000_000, 6)) @ root.T
    j = jo.whitecaps.jacobian(draws.reshape(-1, 2, 3))
    counted = jnp.mean((j[:, 0] - 1) * (j[:, 1] - 1))
    closed = jo.whitecaps.StrainStatistics(jnp.zeros(3), there).jacobian_variance()
    error = float(jnp.std((j[:, 0] - 1) * (j[:, 1] - 1))) / 1000
    assert abs(float(counted - closed)) < 4 * error
    linear = float(there[0, 0] + there[1, 1] + 2 * there[0, 1])
    assert abs(float(closed) - linear) > 6 * error  # the draws can tell


def test_many_distances_are_the_same_as_few_and_derivatives_pass():
    distance = np.linspace(0.0, 500.0, 4097)

    @eqx.filter_jit
    def along(speed):
        spectrum = jo.spectra.Elfouhaily(jo.Wind(speed), 2.0)
        return jo.surface.autocovariance(jo.surface.cell_energy(spectrum, CASCADE), CASCADE, distance)

    many, slope = jax.jvp(along, (jnp.asarray(7.0),), (jnp.asarray(1.0),))
    few = jo.surface.autocovariance(
        jo.surface.cell_energy(jo.spectra.Elfouhaily(jo.Wind(7.0), 2.0), CASCADE), CASCADE, distance[-1:]
    )
    np.testing.assert_allclose(many[:, -1:], few, rtol=1e-12)
    rise = (along(jnp.asarray(7.001)) - along(jnp.asarray(6.999))) / 0.002
    np.testing.assert_allclose(slope, rise, atol=1e-5 * float(jnp.max(jnp.abs(rise))))


def test_another_axis_is_refused(energy):
    with pytest.raises(ValueError, match="`axis` must be 0"):
        jo.surface.autocovariance(energy, CASCADE, np.zeros(1), axis=2)
