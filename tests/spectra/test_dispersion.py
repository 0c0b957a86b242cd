"""The dispersion relation and its inverse."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches

from jaxocean.spectra import Dispersion

RELATIONS = {
    "deep": Dispersion(),
    "capillary": Dispersion(surface_tension=Dispersion.CLEAN_WATER),
    "shallow": Dispersion(2.0),
    "both": Dispersion(0.01, Dispersion.CLEAN_WATER),
}
K = np.geomspace(1e-5, 1e5, 401)

every_relation = pytest.mark.parametrize("name", RELATIONS)


@every_relation
def test_the_inverse_is_exact_at_all_depths_and_lengths(name):
    relation = RELATIONS[name]
    np.testing.assert_allclose(relation.wavenumber(relation.frequency(jnp.asarray(K))), K, rtol=1e-13)


@every_relation
def test_the_inverse_is_as_good_as_float32_allows(name):
    with jax.enable_x64(False):
        depth, tension = RELATIONS[name].depth, float(RELATIONS[name].surface_tension)
        relation = Dispersion(None if depth is None else float(depth), tension)
        k = jnp.asarray(K[80:-80], jnp.float32)
        back = relation.wavenumber(relation.frequency(k))
        assert back.dtype == jnp.float32
        np.testing.assert_allclose(back, k, rtol=2e-6)


@every_relation
def test_the_group_speed_is_the_derivative_of_the_frequency(name):
    relation = RELATIONS[name]
    k = jnp.asarray(K)
    slope = jax.vmap(jax.grad(relation.frequency))(k)
    np.testing.assert_allclose(relation.group_speed(k), slope, rtol=1e-9)


def test_limits_of_the_speed_of_waves():
    k = jnp.asarray([0.05])
    np.testing.assert_allclose(Dispersion().frequency(k) ** 2, 9.81 * k)
    np.testing.assert_allclose(Dispersion(1000.0).frequency(k), Dispersion().frequency(k), rtol=1e-12)
    long_wave = jnp.asarray([1e-5])
    np.testing.assert_allclose(Dispersion(4.0).frequency(long_wave) / long_wave, np.sqrt(9.81 * 4), rtol=1e-6)
    # The slowest wave of clean water: 23 cm/s at 1.7 cm.
    k = jnp.linspace(100.0, 1000.0, 2001)
    speed = Dispersion(surface_tension=Dispersion.CLEAN_WATER).frequency(k) / k
    np.testing.assert_allclose(jnp.min(speed), 0.2308, rtol=1e-3)
    np.testing.assert_allclose(2 * np.pi / k[jnp.argmin(speed)], 0.01707, rtol=2e-3)


def test_the_inverse_is_differentiable_in_frequency_depth_and_tension():
    tension = Dispersion.CLEAN_WATER
    assert_derivative_matches(lambda w: Dispersion(3.0, tension).wavenumber(w), 1.2)
    assert_derivative_matches(lambda d: Dispersion(d, tension).wavenumber(jnp.asarray(1.2)), 3.0)
    assert_derivative_matches(
        lambda t: Dispersion(3.0, t * 1e-5).wavenumber(jnp.asarray(60.0)), 7.0, rtol=1e-6
    )
    # The second derivative of k = ω²/g.
    second = jax.grad(jax.grad(lambda w: Dispersion().wavenumber(w)))(1.5)
    np.testing.assert_allclose(second, 2 / 9.81, rtol=1e-10)


@every_relation
def test_waves_without_frequency_have_no_wavenumber_and_finite_derivatives(name):
    relation = RELATIONS[name]
    for function in (relation.wavenumber, relation.frequency):
        value, slope = jax.value_and_grad(function)(0.0)
        assert float(value) == 0.0
        assert np.isfinite(float(slope))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"depth": 0.0}, "`depth` must be greater than 0 m, but is 0"),
        ({"depth": float("nan")}, "`depth` must be finite"),
        ({"surface_tension": -1.0}, "`surface_tension` must be at least 0"),
    ],
)
def test_impossible_water_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Dispersion(**arguments)
