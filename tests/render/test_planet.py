"""The vertical of places on a round planet, and vectors in the frames that go with it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference

from jaxocean.render import EARTH_CURVATURE
from jaxocean.render._planet import to_local, to_world, vertical, wrap

OFFSETS = jnp.asarray([[0.0, 0.0], [3e5, 0.0], [-2e6, 5e6], [4e6, 7e6], [0.0, -1e7]])


@pytest.mark.parametrize("curvature", [0.0, 1e-9, EARTH_CURVATURE])
def test_the_turn_to_the_local_frame_is_that_by_which_the_plane_is_bent(curvature):
    def place(offset):
        flat, level = wrap(offset, jnp.zeros(()), jnp.asarray(curvature))
        return jnp.stack([flat[0], flat[1], level])

    for offset in OFFSETS:
        up = vertical(tuple(place(offset)), jnp.asarray(curvature))
        arc = curvature * float(jnp.hypot(*offset))
        np.testing.assert_allclose(up[2], np.cos(arc), atol=1e-12)
        # Straight away from the point below the camera, on the plane and on the sphere.
        ahead = offset / jnp.maximum(jnp.hypot(*offset), 1e-30) if arc else jnp.array([1.0, 0.0])
        tangent = jax.jvp(place, (offset,), (ahead,))[1]
        local = to_local(tuple(tangent), up)
        np.testing.assert_allclose(local, [*ahead, 0.0], atol=1e-9)
        np.testing.assert_allclose(to_local(up, up), [0, 0, 1], atol=1e-12)


def test_local_vectors_keep_their_angles_and_come_back():
    rng = np.random.default_rng(0)
    up = rng.normal(size=(3, 50))
    up[2] = np.abs(up[2])
    up = tuple(jnp.asarray(up / np.linalg.norm(up, axis=0)))
    a, b = (tuple(jnp.asarray(rng.normal(size=(3, 50)))) for _ in range(2))
    local = np.asarray(to_local(a, up)), np.asarray(to_local(b, up))
    np.testing.assert_allclose(np.sum(local[0] * local[1], 0), sum(x * y for x, y in zip(a, b, strict=True)))
    np.testing.assert_allclose(to_world(to_local(a, up), up), a, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(local[0][2], sum(x * y for x, y in zip(a, up, strict=True)))


@pytest.mark.parametrize("curvature", [0.0, EARTH_CURVATURE])
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (2e5, -1e5, -4e3)])
def test_the_local_frame_has_the_derivatives_of_differences_also_below_the_camera(place, curvature):
    scale = jnp.array([EARTH_CURVATURE, 1e6, 1e6, 1e6])

    def local(x):
        kappa, *where = x * scale
        return jnp.stack(
            to_local((jnp.asarray(0.6), jnp.asarray(0.3), jnp.asarray(-0.7)), vertical(tuple(where), kappa))
        )

    x = jnp.asarray([curvature, *place]) / scale
    found = jax.jacfwd(local)(x)
    np.testing.assert_allclose(jax.jacrev(local)(x), found, atol=1e-12)
    for i, along in enumerate(jnp.eye(4)):
        expected = finite_difference(local, x, along, 1e-3)
        np.testing.assert_allclose(found[:, i], expected, atol=1e-7)
