"""The polynomial angles against NumPy's, their derivatives, and the axes and diagonals where formulas slip."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxocean.optics.sky._angles import angle_between, azimuth_of


def test_azimuths_are_numpys_in_all_quarters_and_on_all_axes():
    turn = np.concatenate([np.linspace(-np.pi, np.pi, 4001)[1:], np.pi / 4 * np.arange(-3, 5)])
    x, y = 0.3 * np.cos(turn), 0.3 * np.sin(turn)
    np.testing.assert_allclose(azimuth_of(jnp.asarray(x), jnp.asarray(y)), np.arctan2(y, x), atol=3e-8)
    # Exactly on the axes and diagonals, where cos and sin are not exact.
    x = np.array([1.0, 1.0, 0.0, -1.0, -1.0, -1.0, 0.0, 1.0])
    y = np.array([0.0, 1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0])
    np.testing.assert_allclose(azimuth_of(jnp.asarray(x), jnp.asarray(y)), np.arctan2(y, x), atol=3e-8)
    slope_x, slope_y = jax.jit(jax.vmap(jax.grad(azimuth_of, argnums=(0, 1))))(jnp.asarray(x), jnp.asarray(y))
    np.testing.assert_allclose(slope_x, -y / (x * x + y * y), atol=1e-5)
    np.testing.assert_allclose(slope_y, x / (x * x + y * y), atol=1e-5)
    assert np.all(np.isfinite(jax.grad(azimuth_of, argnums=(0, 1))(0.0, 0.0)))


def test_angles_between_vectors_are_numpys_and_precise_near_zero_in_float32():
    angle = np.concatenate([np.logspace(-6, 0, 200), np.linspace(1.0, np.pi, 200)])
    half = jnp.asarray(2.0 * np.sin(angle / 2) ** 2)
    np.testing.assert_allclose(angle_between(half), angle, atol=3e-8, rtol=3e-8)
    np.testing.assert_allclose(angle_between(half.astype(jnp.float32)), angle, rtol=1e-6, atol=5e-4)
    small = angle < 1.0
    np.testing.assert_allclose(angle_between(half.astype(jnp.float32))[small], angle[small], rtol=1e-6)
    slope = jax.jit(jax.vmap(jax.grad(angle_between)))(half)
    np.testing.assert_allclose(slope[angle < 3.0], 1.0 / np.sin(angle[angle < 3.0]), rtol=1e-5)
    assert np.all(np.isfinite(jax.vmap(jax.grad(angle_between))(jnp.array([0.0, 1.0, 2.0, 2.0000001]))))
