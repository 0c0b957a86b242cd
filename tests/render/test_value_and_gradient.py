"""Which mode a gradient is taken in, and that both say the same."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean.render import value_and_gradient


class Scene(eqx.Module):
    heights: jax.Array
    angle: jax.Array
    power: float
    count: int


SCENE = Scene(jnp.array([0.3, 1.2, 2.0]), jnp.array(0.7, jnp.float32), 1.5, 3)


def loss(scene, target):
    wave = jnp.sin(scene.heights * scene.angle.astype(float)) ** 2 * scene.count
    return jnp.sum((wave - target) ** 2) ** scene.power


def only_forward(x):
    """x² by a loop that has no reverse mode."""
    return jnp.sum(jax.lax.while_loop(lambda s: s[0] < 1, lambda s: (s[0] + 1, s[1] ** 2), (0, x))[1])


@jax.custom_vjp
def only_reverse(x):
    return jnp.sum(x**2)


only_reverse.defvjp(lambda x: (only_reverse(x), x), lambda x, ct: (2 * x * ct,))


def test_both_modes_give_the_derivative_in_every_floating_point_leaf():
    forward, reverse = (value_and_gradient(loss, forward=mode)(SCENE, 0.4) for mode in (True, False))
    assert float(forward[0]) == pytest.approx(float(loss(SCENE, 0.4)))
    for one, other in zip(jax.tree.leaves(forward), jax.tree.leaves(reverse), strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_allclose(one, other, rtol=1e-6)
    step = 1e-5 * np.array([0, 1, 0])
    ahead, behind = (
        loss(eqx.tree_at(lambda s: s.heights, SCENE, SCENE.heights + s), 0.4) for s in (step, -step)
    )
    np.testing.assert_allclose(forward[1].heights[1], (ahead - behind) / 2e-5, rtol=1e-6)
    assert forward[1].count is None


def test_up_to_four_numbers_go_forward_and_more_in_reverse():
    for count in (1, 4):
        gradient = value_and_gradient(only_forward)(jnp.arange(float(count)))[1]
        np.testing.assert_allclose(gradient, 2 * np.arange(count))
    np.testing.assert_allclose(value_and_gradient(only_reverse)(jnp.arange(9.0))[1], 2 * np.arange(9))
    np.testing.assert_allclose(
        value_and_gradient(only_reverse, forward=False)(jnp.arange(3.0))[1], 2 * np.arange(3)
    )
    with pytest.raises(ValueError, match="Reverse-mode"):
        value_and_gradient(only_forward)(jnp.arange(5.0))
    with pytest.raises(TypeError, match="custom_vjp"):
        value_and_gradient(only_reverse)(jnp.arange(4.0))


def test_an_accelerator_goes_forward_for_more_numbers(monkeypatch):
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    gradient = value_and_gradient(only_forward)(jnp.arange(64.0))[1]
    np.testing.assert_allclose(gradient, 2 * np.arange(64))
    with pytest.raises(ValueError, match="Reverse-mode"):
        value_and_gradient(only_forward)(jnp.arange(65.0))


def test_complex_numbers_go_in_reverse():
    noise = jnp.array([1 + 2j, 0.5j])
    value, gradient = value_and_gradient(lambda z: jnp.sum(jnp.abs(z) ** 2))(noise)
    np.testing.assert_allclose(value, 5.25)
    np.testing.assert_allclose(gradient, 2 * np.conj(noise))
    with pytest.raises(ValueError, match="complex"):
        value_and_gradient(lambda z: jnp.sum(jnp.abs(z) ** 2), forward=True)(noise)


def test_nothing_to_differentiate_is_refused():
    with pytest.raises(ValueError, match="`parameters` must hold floating-point numbers"):
        value_and_gradient(lambda n: jnp.sum(n))(jnp.arange(3))
