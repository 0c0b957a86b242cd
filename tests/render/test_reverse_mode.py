"""What pixels do not see must not spoil a gradient in reverse: nothing times infinity is no number."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean._elementary import take_together
from jaxocean.render._atlas import Atlas
from jaxocean.render._hits import Corner, _interpolate
from jaxocean.render._mesh import _sharpness
from jaxocean.render._raster import Screen

SIZES = (60.0, 7.0)
F32 = jnp.float32


def numbers(seed: int, *shape: int) -> jax.Array:
    return jnp.asarray(np.random.default_rng(seed).normal(size=shape), F32)


def test_vertices_beside_the_pinhole_or_beyond_the_horizon_have_finite_derivatives():
    row, column = (each.astype(F32) for each in jnp.meshgrid(jnp.arange(8.0), jnp.arange(9.0), indexing="ij"))
    offset = (10.0**row, column - 4.0 + 0.1 * row)

    def of_seen(scale):
        # The first row lies at the pinhole, the last ones in one point of the horizon.
        x = jnp.where(row == 0, 1e13 * (column - 4), jnp.where(row > 4, 20.0, 4 * column * scale))
        y = jnp.where(row == 0, -1e13, jnp.where(row > 4, 3.0, -4 * row * scale))
        return jnp.sum(_sharpness(offset, Screen(x, y, row + 0.1))[2:4])

    value, slope = jax.value_and_grad(of_seen)(F32(1.0))
    assert np.isfinite(value)
    assert value > 0
    ahead, behind = (float(of_seen(F32(1 + step))) for step in (1e-2, -1e-2))
    np.testing.assert_allclose(slope, (ahead - behind) / 2e-2, rtol=1e-2)


def test_footprints_as_wide_as_they_can_be_have_finite_derivatives():
    hit = jnp.array([[True, True, False]])

    def variance_of_seen(sharpness):
        shape = hit.shape
        corners = tuple(
            Corner(
                jnp.full(shape, x, F32),
                jnp.full(shape, y, F32),
                jnp.ones(shape, F32),
                jnp.zeros(shape, F32),
                jnp.zeros(shape, F32),
                sharpness,
                jnp.ones(shape, F32),
            )
            for x, y in ((-1.0, -1.0), (2.0, -1.0), (-1.0, 2.0))
        )
        return jnp.log(_interpolate(hit, corners).variance)[0, 0]

    slope = jax.grad(variance_of_seen)(jnp.array([[0.5, 1e-6, 0.0]], F32))
    np.testing.assert_allclose(slope, [[-4 / 0.5, 0.0, 0.0]], rtol=1e-5)


@pytest.mark.parametrize("rounded", [False, True])
def test_look_ups_go_back_to_places_filters_and_texels(rounded):
    channels = numbers(5, 2, 2, 24, 24)
    channels = channels - channels.mean(axis=(-2, -1), keepdims=True)
    x, y = 100 * numbers(6, 2, 50)
    variance = 10 ** (2 * numbers(7, 50))
    weight = numbers(8, 2, 50)

    def total(channels, centre, x, y, variance):
        atlas = Atlas.from_channels(channels, SIZES, rounded=rounded)
        return jnp.sum(weight * jnp.stack(atlas(centre, x, y, variance)))

    given = channels, jnp.asarray([3.0, -2.0], F32), x, y, variance
    ways = tuple(numbers(9 + i, *each.shape) * (each if i == 4 else 1.0) for i, each in enumerate(given))
    gradient = jax.jit(jax.grad(total, argnums=range(5)))(*given)
    back = [float(jnp.vdot(g, way)) for g, way in zip(gradient, ways, strict=True)]
    zeros = [jnp.zeros_like(each) for each in given]
    along = jax.jit(lambda *ways: jax.jvp(total, given, ways)[1])
    forth = [float(along(*zeros[:i], way, *zeros[i + 1 :])) for i, way in enumerate(ways)]
    np.testing.assert_allclose(back, forth, rtol=1e-3)
    assert np.all(np.abs(back) > 0.1)


def test_the_derivative_of_a_look_up_is_that_of_differences():
    channels = jnp.asarray(np.random.default_rng(5).normal(size=(1, 2, 16, 16)))
    atlas = Atlas.from_channels(channels - channels.mean(axis=(-2, -1), keepdims=True), SIZES)
    given = (jnp.array([3.0, -2.0]), jnp.array([1.3, 20.7]), jnp.array([0.4, -9.1]), jnp.array([0.8, 0.05]))
    for number, each in enumerate(given):
        way = np.zeros(each.shape)
        way[0] = 1.0
        ways = tuple(jnp.asarray(way) if i == number else jnp.zeros_like(g) for i, g in enumerate(given))

        def read(step, ways=ways):
            return atlas(*(g + step * way for g, way in zip(given, ways, strict=True)))[0]

        found = jax.jvp(read, (0.0,), (1.0,))[1]
        assert np.any(np.abs(found) > 1e-3)
        np.testing.assert_allclose(found, (read(1e-6) - read(-1e-6)) / 2e-6, rtol=1e-6, atol=1e-8)


def test_tables_that_are_read_together_have_the_derivative_of_each():
    tables = tuple(numbers(i, 7) for i in range(3))
    index = jnp.asarray([[0, 6, 3], [3, 3, 1]])

    def apart(tables):
        return jnp.stack([table[index] for table in tables])

    found, back = jax.vjp(lambda tables: jnp.stack(take_together(tables, index)), tables)
    expected, back_apart = jax.vjp(apart, tables)
    np.testing.assert_array_equal(found, expected)
    cotangent = numbers(4, *found.shape)
    for one, other in zip(back(cotangent)[0], back_apart(cotangent)[0], strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6)
