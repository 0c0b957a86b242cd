"""The one test that every differentiable law takes: its derivative against central finite differences."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float


def finite_difference(f: Callable, x: Float[Array, "*s"], direction: Float[Array, "*s"], step: float):
    """Directional derivative by Richardson-extrapolated central differences (error O(step⁴))."""

    def central(h: float):
        return jax.tree.map(
            lambda up, down: (up - down) / (2 * h), f(x + h * direction), f(x - h * direction)
        )

    return jax.tree.map(lambda fine, coarse: (4 * fine - coarse) / 3, central(step), central(2 * step))


def assert_derivative_matches(
    f: Callable, x: float | Float[Array, "*s"], *, rtol: float = 1e-6, atol: float = 0.0, step: float = 1e-3
) -> None:
    """Check forward and reverse derivatives of a scalar-valued `f` at `x` (float64) against finite differences."""
    x = jnp.asarray(x, jnp.float64)
    direction = jnp.asarray(np.random.default_rng(0).uniform(0.5, 1.0, x.shape), jnp.float64)
    f = jax.jit(f)
    scale = step * max(1.0, float(jnp.max(jnp.abs(x))))
    expected = finite_difference(f, x, direction, scale)
    _, forward = jax.jvp(f, (x,), (direction,))
    reverse = jnp.sum(jax.grad(f)(x) * direction)
    assert np.isfinite(float(forward)), f"derivative is {forward}"
    np.testing.assert_allclose(forward, expected, rtol=rtol, atol=atol)
    np.testing.assert_allclose(reverse, forward, rtol=1e-8, atol=atol + 1e-14 * abs(float(forward)))


def assert_gradient_matches(
    f: Callable, points: list, *, rtol: float = 1e-6, atol: float = 0.0, step: float = 1e-4
):
    """Check every partial derivative of a scalar-valued `f` at several float64 vectors, forward and reverse.

    `f` is compiled three times in all, whatever the number of points and coordinates.
    """
    value, forward, reverse = jax.jit(f), jax.jit(jax.jacfwd(f)), jax.jit(jax.grad(f))
    for point in points:
        x = jnp.asarray(point, jnp.float64)
        expected = [
            finite_difference(value, x, unit, step * max(1.0, abs(float(x[i]))))
            for i, unit in enumerate(jnp.eye(x.size))
        ]
        np.testing.assert_allclose(forward(x), expected, rtol=rtol, atol=atol, err_msg=f"at {x}")
        np.testing.assert_allclose(reverse(x), forward(x), rtol=1e-8, atol=atol + 1e-13, err_msg=f"at {x}")
