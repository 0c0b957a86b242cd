import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import single_wave, wind_sea

from jaxocean.surface import AbstractSurface, Cascade, realise

CASCADE = Cascade((60.0, 9.0), 32)
TIME = 1.7
LAMBDA = (0.6, 1.3)


@pytest.fixture(scope="module")
def sea():
    return realise(wind_sea(), CASCADE, key=jax.random.key(2))


def test_a_sea_speaks_the_surface_protocol(sea):
    assert isinstance(sea, AbstractSurface)


def test_queries_at_the_samples_of_a_single_pattern_are_its_fields(sea):
    cascade = Cascade((60.0,), 32)
    alone = realise(wind_sea(), cascade, noise=sea.noise[:1])
    fields = alone.fields(TIME, 1.3, 4.0)
    p = cascade.points(0)
    np.testing.assert_allclose(alone.height(p, TIME), fields.height[0], atol=1e-13)
    np.testing.assert_allclose(alone.displacement(p, TIME, 1.3), fields.displacement[0], atol=1e-13)
    np.testing.assert_allclose(alone.slope(p, TIME), fields.slope[0], atol=1e-13)
    np.testing.assert_allclose(alone.strain(p, TIME, 1.3, 4.0), fields.strain[0], atol=1e-13)


def test_patterns_are_summed(sea):
    p = jnp.asarray(np.random.default_rng(0).uniform(0, 60, (5, 2)))
    total = sea.height(p, TIME)
    bands = CASCADE.bands
    parts = [
        realise(wind_sea(), Cascade((size,), 32, bands=[band]), noise=sea.noise[i : i + 1]).height(p, TIME)
        for i, (size, band) in enumerate(zip(CASCADE.sizes, bands, strict=True))
    ]
    np.testing.assert_allclose(total, parts[0] + parts[1], atol=1e-13)


def test_slope_and_strain_are_the_gradients_of_height_and_displacement(sea):
    p = jnp.asarray([[1.1, 2.2], [33.0, -7.0], [0.0, 0.0]])
    slope = jax.vmap(jax.grad(lambda q: sea.height(q, TIME)))(p)
    np.testing.assert_allclose(sea.slope(p, TIME), slope, atol=1e-12)
    jacobian = jax.vmap(jax.jacfwd(lambda q: sea.displacement(q, TIME, LAMBDA)))(p)
    a, b, c = np.moveaxis(np.asarray(sea.strain(p, TIME, LAMBDA)), -1, 0)
    np.testing.assert_allclose(jacobian[:, 0, 0], a, atol=1e-12)
    np.testing.assert_allclose(jacobian[:, 1, 1], b, atol=1e-12)
    np.testing.assert_allclose(jacobian[:, 0, 1], c, atol=1e-12)
    np.testing.assert_allclose(jacobian[:, 1, 0], c, atol=1e-12)


def test_each_pattern_repeats_after_its_size_and_their_sum_after_the_period(sea):
    p = np.random.default_rng(1).uniform(0, 60, (4, 2))
    east, north = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    period = CASCADE.period
    assert period == 180.0
    np.testing.assert_allclose(sea.height(p + period * north, TIME), sea.height(p, TIME), atol=1e-12)
    np.testing.assert_allclose(sea.height(p - 5 * period * east, TIME), sea.height(p, TIME), atol=1e-12)
    assert np.max(np.abs(sea.height(p + 60 * east, TIME) - sea.height(p, TIME))) > 1e-3


def test_far_from_the_origin_numpy_coordinates_lose_nothing_in_a_float32_sea():
    spectrum = jax.tree.map(lambda leaf: leaf.astype(jnp.float32), wind_sea())
    single = realise(spectrum, CASCADE, key=jax.random.key(2))
    near = np.random.default_rng(2).uniform(0, 60, (20, 2))
    far = near + 180.0 * 5556  # 1 000 080 m
    expected = np.asarray(single.slope(near, TIME))
    np.testing.assert_allclose(single.slope(far, TIME), expected, atol=2e-5)
    # Rounded to float32 first, the same places are centimetres off: the difference is visible.
    rounded = single.slope(jnp.asarray(far, jnp.float32), TIME)
    assert np.max(np.abs(rounded - expected)) > 1e-3


def test_many_points_are_summed_in_chunks_with_the_same_result(sea):
    p = jnp.asarray(np.random.default_rng(3).uniform(0, 60, (1100, 2)))
    many = sea.slope(p.reshape(50, 22, 2), TIME)
    assert many.shape == (50, 22, 2)
    few = jnp.concatenate([sea.slope(p[:500], TIME), sea.slope(p[500:1000], TIME), sea.slope(p[1000:], TIME)])
    np.testing.assert_allclose(many.reshape(-1, 2), few, atol=1e-12)
    gradient = jax.grad(lambda q: jnp.sum(sea.height(q, TIME)))(p)
    np.testing.assert_allclose(gradient, few, atol=1e-12)


def test_one_point_and_empty_batches_have_their_shapes(sea):
    assert sea.height(jnp.zeros(2), TIME).shape == ()
    assert sea.strain(jnp.zeros((0, 2)), TIME).shape == (0, 3)


def test_queries_are_differentiable_in_point_time_and_wind(sea):
    def stretching(q):
        there = realise(wind_sea(q[3]), CASCADE, noise=sea.noise)
        return jnp.sum(there.strain(q[:2], q[2], LAMBDA) ** 2)

    assert_derivative_matches(stretching, [3.0, 4.0, 1.5, 8.0], step=1e-5)


def test_third_derivatives_are_smooth(sea):
    def third(q):
        return jax.grad(jax.grad(jax.grad(lambda x: sea.height(jnp.stack([x, 4.0 * x]), TIME))))(q)

    assert_derivative_matches(third, 2.0, step=1e-5, rtol=1e-5)


def test_bounds_hold_and_are_reached_by_a_single_wave(sea):
    fields = sea.fields(TIME)
    assert float(jnp.sum(jnp.max(jnp.abs(fields.height), axis=(1, 2)))) <= float(sea.height_bound())
    steepness = jnp.sum(jnp.max(jnp.hypot(*jnp.moveaxis(fields.slope, -1, 0)), axis=(1, 2)))
    assert float(steepness) <= float(sea.slope_bound())
    wave, h0, kx, _ = single_wave(0, 1, CASCADE)
    crest = jnp.max(wave.fields(0.0).height)
    assert float(wave.height_bound()) == pytest.approx(2 * abs(h0), rel=1e-9)
    assert float(crest) == pytest.approx(2 * abs(h0), rel=0.01)
    assert float(wave.slope_bound()) == pytest.approx(2 * abs(h0) * kx, rel=1e-9)
