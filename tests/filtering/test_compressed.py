"""Half precision: bytes and digits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import wind_sea

from jaxocean.filtering import CompressedMoments, Footprint, MomentPyramid
from jaxocean.surface import Cascade, realise

PAPER = 8 * 4 * 2 * 256**2 * 4 / 3


@pytest.fixture(scope="module")
def pyramid():
    cascade = Cascade((60.0, 9.0), 32)
    fields = realise(wind_sea(), cascade, key=jax.random.key(0)).fields(0.0)
    return MomentPyramid.from_fields(fields, cascade)


def test_nothing_is_lost_without_rounding(pyramid):
    again = CompressedMoments.from_pyramid(pyramid, jnp.float64).expand()
    np.testing.assert_allclose(again.means, pyramid.means, atol=1e-16)
    np.testing.assert_allclose(again.products, pyramid.products, atol=1e-16)


@pytest.mark.parametrize(("dtype", "digits"), [(jnp.float16, 2.0**-11), (jnp.bfloat16, 2.0**-8)])
def test_half_precision_keeps_each_covariance_to_its_own_last_digit(pyramid, dtype, digits):
    compressed = CompressedMoments.from_pyramid(pyramid, dtype)
    expanded = compressed.expand()

    def spread(p):
        return (p.products[..., :3] - p.means[..., :3] ** 2)[:, p.resolution**2 :]

    ratio = np.asarray(spread(expanded) / spread(pyramid))
    assert 0 < np.max(np.abs(ratio - 1)) < 1.01 * digits
    # Rounded products do not: small differences of large numbers.
    rounded = spread(pyramid.stored_as(dtype).stored_as(jnp.float64)) / spread(pyramid)
    assert np.max(np.abs(np.asarray(rounded) - 1)) > 20 * digits


def test_four_patterns_of_256_samples_take_less_than_the_papers_textures():
    sizes = (893.0, 101.0, 21.0, 11.0)
    slope, strain = jnp.zeros((4, 256, 256, 2), jnp.float32), jnp.zeros((4, 256, 256, 3), jnp.float32)
    pyramid = MomentPyramid.from_samples(slope, strain, sizes)
    texels = 4 * (4**9 - 1) // 3
    assert pyramid.nbytes == texels * 14 * 4
    assert pyramid.stored_as(jnp.float16).nbytes == texels * 14 * 2
    compressed = CompressedMoments.from_pyramid(pyramid, jnp.float16)
    assert compressed.nbytes == texels * 5 * 2 + (texels - 4 * 256**2) * 9 * 2 + 4 * 5 * 4
    assert compressed.nbytes < PAPER
    assert round(PAPER / 2**20, 2) == 5.33


def test_a_calm_sea_stays_calm(pyramid):
    calm = MomentPyramid.from_samples(jnp.zeros((1, 8, 8, 2)), jnp.zeros((1, 8, 8, 3)), (10.0,))
    again = CompressedMoments.from_pyramid(calm, jnp.float16).expand()
    seen = again(Footprint.square(np.zeros((1, 2)), np.ones(1)))
    np.testing.assert_array_equal(seen.strain_covariance, 0)
