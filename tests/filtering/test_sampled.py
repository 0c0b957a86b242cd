"""The generic path: any surface, by quadrature."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import wind_sea

from jaxocean.filtering import Footprint, sampled_moments
from jaxocean.surface import AbstractSurface, Cascade, realise


class Bowl(AbstractSurface):
    """Slopes (x, 2y) and strains (x, y, xy): whose moments over a rectangle are known."""

    depth: jax.Array

    def height(self, p, time):
        return self.depth * (0.5 * p[..., 0] ** 2 + p[..., 1] ** 2)

    def displacement(self, p, time):
        return jnp.zeros_like(jnp.asarray(p))

    def slope(self, p, time):
        p = jnp.asarray(p)
        return self.depth * jnp.stack([p[..., 0], 2 * p[..., 1]], axis=-1)

    def strain(self, p, time):
        p = jnp.asarray(p)
        return self.depth * jnp.stack([p[..., 0], p[..., 1], p[..., 0] * p[..., 1]], axis=-1)

    def height_bound(self):
        return jnp.asarray(jnp.inf)

    def slope_bound(self):
        return jnp.asarray(jnp.inf)


def test_polynomials_are_integrated_exactly():
    bowl = Bowl(jnp.asarray(1.0))
    u, v = 2.0, 6.0  # edges
    footprint = Footprint(np.array([[1.0, -1.0], [0.0, 3.0]]), np.array([[u, 0.0], [0.0, v]]))
    seen = sampled_moments(bowl, footprint, 0.0, nodes=3)
    x, y, vx, vy = np.array([1.0, 0.0]), np.array([-1.0, 3.0]), u**2 / 12, v**2 / 12
    np.testing.assert_allclose(seen.slope_mean, np.stack([x, 2 * y], axis=-1), atol=1e-13)
    np.testing.assert_allclose(seen.strain_mean, np.stack([x, y, x * y], axis=-1), atol=1e-13)
    np.testing.assert_allclose(
        seen.slope_covariance, np.broadcast_to(np.diag([vx, 4 * vy]), (2, 2, 2)), atol=1e-12
    )
    # Var(xy) and Cov(x, xy) of independent x and y.
    np.testing.assert_allclose(seen.strain_covariance[:, 2, 2], vx * vy + x**2 * vy + y**2 * vx, atol=1e-12)
    np.testing.assert_allclose(seen.strain_covariance[:, 0, 2], y * vx, atol=1e-12)
    np.testing.assert_allclose(seen.strain_covariance[:, 0, 1], 0, atol=1e-12)


def test_a_slanted_footprint_is_that_of_its_edges():
    bowl = Bowl(jnp.asarray(1.0))
    edges = np.array([[2.0, 1.0], [0.5, 3.0]])
    seen = sampled_moments(bowl, Footprint(np.zeros(2), edges), 0.0, nodes=2)
    second = edges @ edges.T / 12
    np.testing.assert_allclose(seen.strain_covariance[:2, :2], second, atol=1e-13)


def test_a_sea_is_sampled_alike_from_numpy_and_from_arrays_and_converges():
    sea = realise(wind_sea(), Cascade((60.0, 9.0), 16), key=jax.random.key(0))
    near = np.array([[3.0, 4.0], [10.0, 50.0]])
    footprint = Footprint.square(near, 2.0)
    few, many = (sampled_moments(sea, footprint, 0.0, nodes=n) for n in (10, 20))
    other = sampled_moments(sea, Footprint.square(jnp.asarray(near), 2.0), 0.0, nodes=20)
    np.testing.assert_allclose(few.strain_covariance, many.strain_covariance, atol=1e-8)
    np.testing.assert_allclose(other.strain_covariance, many.strain_covariance, atol=1e-12)


def test_sampled_moments_are_differentiable_in_surface_and_footprint():
    def spread(q):
        seen = sampled_moments(Bowl(q[0]), Footprint(q[1:3], q[3:].reshape(2, 2)), 0.0, nodes=3)
        return jnp.sum(seen.strain_covariance) + jnp.sum(seen.slope_mean)

    assert_derivative_matches(spread, [1.2, 0.3, 0.4, 1.0, 0.2, 0.1, 2.0])


def test_less_than_one_node_is_refused():
    with pytest.raises(ValueError, match="`nodes` must be at least 1, but is 0"):
        sampled_moments(Bowl(jnp.asarray(1.0)), Footprint(np.zeros(2), np.eye(2)), 0.0, nodes=0)
