"""Silhouettes of meshes that are drawn directly on the screen."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean.render._raster import EMPTY, Screen, visible_triangles
from jaxocean.render._silhouettes import find_silhouettes

SIZE = (40, 60)
CENTRE = (30.3, 19.6)
POINTS = 241


def disc(radius, shear) -> Screen:
    """A disc at one depth, of rings whose cells are small and lean over, so that few pixels see its last ring."""
    share = jnp.linspace(0.0, 1.0, 49)[:, None] ** 0.25
    angle = jnp.linspace(0.0, 2 * np.pi, POINTS)[None, :] + shear * share
    x = CENTRE[0] + radius * share * jnp.cos(angle)
    y = CENTRE[1] + radius * share * jnp.sin(angle)
    return Screen(x, y, jnp.full_like(x, 5.0))


def covered(screen: Screen):
    """The share of each pixel that a mesh at one depth covers."""
    held = jax.lax.stop_gradient(screen)
    hit = visible_triangles(held, SIZE, jnp.asarray(1.0)) != EMPTY
    edges = find_silhouettes(screen, jnp.where(hit, 5.0, jnp.inf))
    return edges.blend(hit.astype(screen.x.dtype))


shares = eqx.filter_jit(lambda radius, shear: covered(disc(radius, shear)))


@pytest.mark.parametrize("shear", [0.0, 6.0])
def test_a_disc_covers_its_own_area_of_every_pixel_however_its_cells_lean(shear):
    radius = 14.2
    found = np.asarray(shares(radius, shear))
    fine = (np.arange(SIZE[1] * 16) + 0.5) / 16 - CENTRE[0], (np.arange(SIZE[0] * 16) + 0.5) / 16 - CENTRE[1]
    inside = fine[0][None] ** 2 + fine[1][:, None] ** 2 < radius**2
    exact = inside.reshape(SIZE[0], 16, SIZE[1], 16).mean(axis=(1, 3))
    assert found.sum() == pytest.approx(exact.sum(), rel=1e-3)
    # Exact for edges along the pixels; a slanted one's triangles go to the neighbour, most where its octant ends.
    error = np.abs(found - exact)[(exact > 0) & (exact < 1)]
    assert np.mean(error) < 0.03
    assert np.quantile(error, 0.9) < 0.06
    assert np.max(error) < 0.35


def test_the_area_of_a_disc_grows_with_its_radius_as_its_circumference():
    def area(radius, shear):
        return jnp.sum(shares(radius, shear))

    derivative = jax.jvp(lambda radius: area(radius, 6.0), (14.2,), (1.0,))[1]
    assert float(derivative) == pytest.approx(2 * np.pi * 14.2, rel=5e-3)
    assert float(jax.grad(area)(14.2, 6.0)) == pytest.approx(float(derivative), rel=1e-9)


def test_of_two_silhouettes_in_one_place_the_nearer_one_counts():
    """A wall folds back behind itself and comes out again, a little wider: the sky is not mixed into what is near."""
    x = jnp.broadcast_to(jnp.asarray([0.0, 10.0, 20.3, 5.0, 20.8]), (2, 5))
    y = jnp.broadcast_to(jnp.asarray([[-5.0], [50.0]]), (2, 5))
    screen = Screen(x, y, jnp.broadcast_to(jnp.asarray([2.0, 2.0, 2.0, 4.0, 4.0]), (2, 5)))
    centres = np.arange(SIZE[1]) + 0.5
    ahead = np.where(centres < 20.3, 2.0, np.where(centres < 20.8, 4.0, np.inf))
    edges = find_silhouettes(screen, jnp.broadcast_to(jnp.asarray(ahead), SIZE))
    np.testing.assert_allclose(edges.across[3, 19], 0.3, atol=1e-9)
    np.testing.assert_allclose(edges.across[3, 20], -0.2, atol=1e-9)
    assert np.count_nonzero(edges.across) == 2 * SIZE[0]


def test_hidden_silhouettes_do_not_mix_what_is_in_front_of_them():
    screen = disc(14.2, 0.0)
    edges = find_silhouettes(screen, jnp.full(SIZE, 1.0))
    assert not np.any(edges.across)
    assert not np.any(edges.down)


def test_channels_are_mixed_like_the_image_of_each():
    held = jax.lax.stop_gradient(disc(14.2, 0.0))
    hit = visible_triangles(held, SIZE, jnp.asarray(1.0)) != EMPTY
    edges = find_silhouettes(held, jnp.where(hit, 5.0, jnp.inf))
    channels = jnp.stack([hit.astype(float), jnp.linspace(0.0, 1.0, hit.size).reshape(SIZE)], axis=-1)
    apart = jnp.stack([edges.blend(channels[..., i]) for i in range(2)], axis=-1)
    assert not np.array_equal(apart, channels)
    np.testing.assert_array_equal(edges.blend(channels), apart)
