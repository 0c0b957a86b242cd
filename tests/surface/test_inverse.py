import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import single_wave, wind_sea

from jaxocean.surface import Cascade, realise

CASCADE = Cascade((90.0, 11.0), 64)
TIME = 2.5


@pytest.fixture(scope="module")
def sea():
    return realise(wind_sea(10.0), CASCADE, key=jax.random.key(7))


def jacobian(strain):
    a, b, c = np.moveaxis(np.asarray(strain), -1, 0)
    return (1 + a) * (1 + b) - c * c


def test_a_mildly_choppy_sea_is_inverted_exactly(sea):
    p = jnp.asarray(np.random.default_rng(0).uniform(0, 90, (200, 2)))
    x = p + sea.displacement(p, TIME, 0.8)
    root = sea.rest_point(x, TIME, 0.8)
    assert np.all(root.converged)
    np.testing.assert_allclose(root.point, p, atol=1e-8)
    np.testing.assert_allclose(root.offset, root.point - x, atol=1e-12)
    np.testing.assert_allclose(sea.height_at(x, TIME, 0.8), sea.height(p, TIME), atol=1e-8)


@pytest.mark.parametrize("choppiness", [3.0, 6.0])
def test_a_folded_sea_is_inverted_too_and_the_highest_branch_is_chosen(sea, choppiness):
    p = jnp.asarray(np.random.default_rng(1).uniform(0, 90, (200, 2)))
    folded = jacobian(sea.strain(p, TIME, choppiness)) < 0
    assert folded.sum() >= 2, "the sea must fold for this test to mean anything"
    x = p + sea.displacement(p, TIME, choppiness)
    root = sea.rest_point(x, TIME, choppiness)
    assert np.all(root.converged)
    back = root.point + sea.displacement(root.point, TIME, choppiness)
    np.testing.assert_allclose(back, x, atol=1e-8)
    # A search can miss the highest root, but the one that we happen to know is rarely above it.
    higher = np.asarray(sea.height(p, TIME) - sea.height_at(x, TIME, choppiness)) > 1e-6
    assert higher.mean() < 0.05


def test_a_looping_trochoid_shows_its_crest_from_above():
    wave, h0, kx, _ = single_wave(0, 2, CASCADE)
    choppiness = 3.0 / (2 * abs(h0) * kx)  # λ a k = 3: the crest is a wide loop
    crest = jnp.asarray([-np.angle(h0) / kx, 5.0])
    assert float(jacobian(wave.strain(crest, 0.0, choppiness))) < 0
    root = wave.rest_point(crest, 0.0, choppiness)
    assert bool(root.converged)
    np.testing.assert_allclose(root.point, crest, atol=1e-6)
    np.testing.assert_allclose(wave.height_at(crest, 0.0, choppiness), 2 * abs(h0), rtol=1e-9)


def test_inverse_queries_are_differentiable_in_place_time_choppiness_and_wind(sea):
    # The rest point is inside: the height at a place depends on all of these through it.
    def height(q):
        there = realise(wind_sea(q[4]), CASCADE, noise=sea.noise)
        return there.height_at(q[:2], q[2], q[3])

    assert_derivative_matches(height, [12.0, 34.0, TIME, 0.7, 10.0], step=1e-5, rtol=2e-6)


def test_the_rest_point_moves_with_the_place_by_the_inverse_of_the_displacement_gradient(sea):
    x = jnp.asarray([12.0, 34.0])
    moved = jax.jacfwd(lambda place: sea.rest_point(place, TIME, 0.7).point)(x)
    a, b, c = sea.strain(sea.rest_point(x, TIME, 0.7).point, TIME, 0.7)
    np.testing.assert_allclose(moved @ jnp.asarray([[1 + a, c], [c, 1 + b]]), np.eye(2), atol=1e-9)


def test_a_float32_sea_is_inverted_far_from_the_origin():
    spectrum = jax.tree.map(lambda leaf: leaf.astype(jnp.float32), wind_sea(10.0))
    sea = realise(spectrum, CASCADE, key=jax.random.key(7))
    near = np.random.default_rng(2).uniform(0, 90, (50, 2))
    far = near + CASCADE.period * 1010
    at_home, away = sea.rest_point(near, TIME, 0.8), sea.rest_point(far, TIME, 0.8)
    assert np.all(at_home.converged)
    assert np.all(away.converged)
    np.testing.assert_allclose(away.offset, at_home.offset, atol=1e-4)


def test_inverse_queries_can_be_mapped_over_time(sea):
    x = jnp.asarray([[12.0, 34.0], [1.0, 2.0]])
    times = jnp.asarray([0.0, TIME])
    mapped = jax.vmap(lambda t: sea.height_at(x, t, 0.8))(times)
    np.testing.assert_allclose(mapped[1], sea.height_at(x, TIME, 0.8), atol=1e-9)
