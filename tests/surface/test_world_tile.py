"""The world tile: the sum of the patterns on one lattice is the sea itself, and it repeats."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from tests._derivatives import assert_derivative_matches

CASCADE = jo.surface.Cascade(sizes=(60.0, 20.0, 12.0), resolution=16)
WAVES = 60  # the shortest has 7 waves on 12 m, which repeats five times


def sea(cascade=CASCADE, speed=10.0, **options):
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed, 0.4))
    return jo.surface.realise(spectrum, cascade, key=jax.random.key(2), **options)


@pytest.fixture(scope="module")
def tile():
    return jo.surface.WorldTile(sea(), 2 * WAVES)


def test_the_lattice_holds_what_fourier_sums_give_at_its_points(tile):
    points = tile.points()[::7, ::5]
    choppiness = (1.0, 0.8, 1.3)
    strain = tile.strain(12.5, choppiness, 2.0)[::7, ::5]
    np.testing.assert_allclose(strain, tile.sea.strain(points, 12.5, choppiness, 2.0), atol=1e-12)
    moved = tile.displacement(12.5, choppiness)[::7, ::5]
    np.testing.assert_allclose(moved, tile.sea.displacement(points, 12.5, choppiness), atol=1e-12)
    np.testing.assert_allclose(tile.height(12.5)[::7, ::5], tile.sea.height(points, 12.5), atol=1e-12)


def test_the_sea_repeats_beyond_the_tile(tile):
    points = np.array([[3.1, 8.2], [41.0, 59.9]])
    there = tile.sea.strain(points + np.array([tile.size, -2 * tile.size]), 3.0)
    np.testing.assert_allclose(there, tile.sea.strain(points, 3.0), atol=1e-12)


def test_a_coarse_lattice_holds_the_same_breaking_as_a_fine_one():
    whole = sea()
    coarse, fine = (jo.surface.WorldTile(whole, n).strain(4.0, 1.0, 1.0) for n in (20, 60))
    np.testing.assert_allclose(coarse, fine[::3, ::3], atol=1e-12)
    assert float(jnp.std(coarse)) > 0.03


def test_single_precision_is_the_same_tile(tile):
    single = jo.surface.realise(
        jax.tree.map(lambda x: x.astype(jnp.float32), tile.sea.spectrum), CASCADE, key=jax.random.key(2)
    )
    strain = jo.surface.WorldTile(single, 2 * WAVES).strain(12.5)
    assert strain.dtype == jnp.float32
    np.testing.assert_allclose(strain, tile.strain(12.5), atol=2e-4)


def test_the_tile_is_differentiable_in_the_wind_and_can_be_vmapped_over_time(tile):
    def energy(speed):
        world = jo.surface.WorldTile(sea(jo.surface.Cascade((12.0,), 8), speed=speed), 8)
        return jnp.mean(world.strain(1.0) ** 2)

    assert_derivative_matches(energy, 10.0)
    times = jnp.array([0.0, 12.5])
    batch = eqx.filter_vmap(lambda world, time: world.strain(time), in_axes=(None, 0))(tile, times)
    np.testing.assert_allclose(batch[1], tile.strain(12.5), atol=1e-12)


def test_sizes_are_rounded_to_fractions_of_the_tile():
    cascade = jo.surface.tiling_cascade(jo.surface.Cascade(resolution=32), 893.0)
    repeats = [893.0 / size for size in cascade.sizes]
    np.testing.assert_allclose(repeats, [1, 9, 43, 81])
    # 893/43 is no finite decimal: the tile's size, not the period in decimals, decides.
    world = jo.surface.WorldTile(sea(cascade), 16, 893.0)
    assert world.repeats == (1, 9, 43, 81)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: jo.surface.WorldTile(sea(), 64, 90.0), "whole multiple of every size"),
        (lambda: jo.surface.WorldTile(sea(), 64, 30.0), "whole multiple of every size"),
        (lambda: jo.surface.WorldTile(sea(), 64, 0.0), "greater than 0 m"),
        (lambda: jo.surface.WorldTile(sea(), 63), "even whole number"),
        (lambda: jo.surface.tiling_cascade(CASCADE, 12.0), "leave the patterns apart"),
        (lambda: jo.surface.tiling_cascade(CASCADE, float("nan")), "greater than 0 m"),
    ],
)
def test_what_makes_no_tile_is_refused(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


def test_a_lattice_too_coarse_for_the_waves_that_foam_sees_is_refused_with_the_one_that_suits():
    with pytest.raises(ValueError, match="at least 72"):
        jo.surface.WorldTile(sea(), 40).strain(0.0)
    jo.surface.WorldTile(sea(), 72).strain(0.0)
    with pytest.raises(ValueError, match="greater than 0 rad/m"):
        jo.surface.WorldTile(sea(), 72).strain(0.0, 1.0, -1.0)
