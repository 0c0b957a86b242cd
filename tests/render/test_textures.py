"""Look-ups in textures of 16 bits, beside those that are not rounded."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean._elementary import once
from jaxocean.render._atlas import Atlas

SIZES = (60.0, 7.0)


@pytest.fixture(scope="module")
def atlases() -> tuple[Atlas, Atlas]:
    """Two channels of noise on two patterns, the second channel a thousand times weaker; exact and rounded."""
    noise = np.random.default_rng(5).normal(size=(2, 2, 24, 24)) * np.array([1.0, 1e-3])[:, None, None, None]
    channels = jnp.asarray(noise - noise.mean(axis=(-2, -1), keepdims=True), jnp.float32)
    return Atlas.from_channels(channels, SIZES), Atlas.from_channels(channels, SIZES, rounded=True)


@pytest.fixture(scope="module")
def places() -> tuple[jax.Array, ...]:
    """Points on both sides of the origin, and filters from none to wider than the largest pattern."""
    rng = np.random.default_rng(6)
    x, y = rng.uniform(-200.0, 200.0, (2, 500))
    variance = 10 ** rng.uniform(-3.0, 4.0, 500)
    return tuple(jnp.asarray(each, jnp.float32) for each in (x, y, variance))


CENTRE = jnp.asarray([1e4, -3.0], jnp.float32)
read = eqx.filter_jit(lambda atlas, x, y, variance: jnp.stack(atlas(CENTRE, x, y, variance)))
change = eqx.filter_jit(
    lambda atlas, x, y, variance, way: jax.jvp(
        lambda *p: jnp.stack(atlas(CENTRE, *p)), (x, y, variance), way
    )[1]
)


def test_rounding_errs_by_a_part_in_65_000_of_each_channels_largest_sample(atlases, places):
    exact, rounded = (np.asarray(read(atlas, *places)) for atlas in atlases)
    largest = np.asarray(jnp.max(jnp.abs(atlases[0].level(0, 0)), axis=(-2, -1)))
    largest = largest + np.asarray(jnp.max(jnp.abs(atlases[0].level(0, 1)), axis=(-2, -1)))
    error = np.max(np.abs(rounded - exact), axis=1)
    # Half a step; and the two programs may place a point some 1e-5 samples apart.
    assert np.all(error < largest * (1 / 65_534 + 2e-5))
    assert np.all(np.median(np.abs(rounded - exact), axis=1) < largest / 65_534)
    assert np.all(error > 0), "nothing was rounded"
    assert np.all(np.std(exact, axis=1) > 0.1 * largest / 4)


def test_what_is_rounded_has_the_derivative_of_what_is_not(atlases, places):
    way = tuple(jnp.ones_like(each) for each in places)
    exact, rounded = (change(atlas, *places, way) for atlas in atlases)
    steepest = float(jnp.max(jnp.abs(exact)))
    assert steepest > 0.1
    # In single precision, as the compiler may order the sums of two programs differently.
    np.testing.assert_allclose(rounded, exact, rtol=1e-5, atol=1e-6 * steepest)


def test_a_calm_sea_has_the_derivative_of_its_first_waves(atlases, places):
    waves = jnp.stack([atlases[0].levels[0][:, i] for i in range(len(SIZES))], axis=1)

    def look(size):
        return jnp.stack(Atlas.from_channels(size * waves, SIZES)(CENTRE, *places))

    found, change = jax.jit(lambda s: jax.jvp(look, (s,), (jnp.ones_like(s),)))(jnp.float32(0))
    np.testing.assert_array_equal(found, 0)
    expected = np.asarray(look(jnp.float32(1)))
    # Levels that hold hardly any of a pattern are left out only where there are waves.
    assert np.max(np.abs(change - expected)) < 0.02 * np.max(np.abs(expected))


def test_textures_in_double_precision_are_never_rounded():
    noise = jnp.asarray(np.random.default_rng(5).normal(size=(1, 2, 8, 8)))
    assert Atlas.from_channels(noise, SIZES, rounded=True).pairs is None


def test_a_filter_far_wider_than_all_patterns_leaves_nothing(atlases):
    x = jnp.linspace(-50.0, 50.0, 500, dtype=jnp.float32)
    assert not np.any(read(atlases[1], x, x, jnp.full_like(x, 1e9)))


def test_what_is_computed_once_is_what_it_was_and_so_is_its_derivative():
    x = jnp.asarray([-3.0, 0.0, 1e-30, 1e30, jnp.inf, -jnp.inf, jnp.nan])
    np.testing.assert_array_equal(jax.jit(once)(x), x)
    np.testing.assert_array_equal(
        jax.jit(jax.jvp, static_argnums=0)(once, (x,), (2 * jnp.ones_like(x),))[1][:4], 2.0
    )
    assert float(jax.grad(once)(3.0)) == 1.0
