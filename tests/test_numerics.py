"""Numerical helpers at the places where JAX's own have no derivative."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxocean._numerics import largest


def test_the_largest_moves_as_one_of_the_largest_does():
    values = jnp.asarray([[[1.0, 3.0], [3.0, -1.0]], [[0.0, -2.0], [-5.0, -7.0]]])
    change = jnp.arange(8.0).reshape(2, 2, 2)
    found, moved = jax.jit(lambda v, c: jax.jvp(largest, (v,), (c,)))(values, change)
    np.testing.assert_array_equal(found, [3.0, 0.0])
    np.testing.assert_array_equal(moved, [1.0, 4.0])
    np.testing.assert_array_equal(
        jax.grad(lambda v: jnp.sum(largest(v)))(values), [[[0, 1], [0, 0]], [[1, 0], [0, 0]]]
    )
