"""Box means, levels, and more samples of the same waves."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _waves import wind_sea

from jaxocean.filtering import box_means, refine, resample
from jaxocean.filtering._boxes import Levels
from jaxocean.surface import Cascade, realise

CASCADE = Cascade((60.0, 9.0), 16)
LAMBDA = (0.7, 1.2)


@pytest.fixture(scope="module")
def sea():
    return realise(wind_sea(), CASCADE, key=jax.random.key(3))


@pytest.mark.parametrize("count", [16, 24])
def test_each_level_holds_the_exact_means_of_its_boxes(count):
    values = np.random.default_rng(0).normal(size=(2, count, count, 3))
    levels = Levels(count)
    flat = np.asarray(levels.build(jnp.asarray(values)))
    assert flat.shape[1] == levels.offsets[-1] == sum(c * c for c in levels.counts)
    assert levels.counts[-1] == 1
    for level, n in enumerate(levels.counts):
        side = count // n
        texels = flat[:, levels.offsets[level] : levels.offsets[level + 1]].reshape(2, n, n, 3)
        for y, x in {(0, 0), (n - 1, n // 2)}:
            box = values[:, y * side : (y + 1) * side, x * side : (x + 1) * side]
            np.testing.assert_allclose(texels[:, y, x], box.mean(axis=(1, 2)), atol=1e-15)


def test_boxes_must_tile_the_field():
    with pytest.raises(ValueError, match="`side` must divide 6 and 8 samples, but is 4"):
        box_means(jnp.zeros((6, 8, 1)), 4)


@pytest.mark.parametrize("factor", [1, 2, 3])
def test_a_refined_field_is_the_sea_between_its_samples(sea, factor):
    alone = realise(wind_sea(), Cascade((60.0,), 16, bands=CASCADE.bands[:1]), noise=sea.noise[:1])
    fine = refine(sea.fields(0.5, LAMBDA).strain, factor)[0]
    along = np.arange(16 * factor) * 60.0 / (16 * factor)
    points = np.stack(np.meshgrid(along, along), axis=-1)
    np.testing.assert_allclose(fine, alone.strain(points, 0.5, LAMBDA[0]), atol=1e-13)


def test_patterns_on_a_lattice_add_up_to_the_sea_at_its_points(sea):
    x, y = np.linspace(-20, 1e5, 7), np.linspace(3, 40, 5)
    fields = sea.fields(0.5, LAMBDA)
    total = sum(resample(fields.strain[i], size, x, y) for i, size in enumerate(CASCADE.sizes))
    points = np.stack(np.meshgrid(x, y), axis=-1)
    np.testing.assert_allclose(total, sea.strain(points, 0.5, LAMBDA), atol=1e-11)


def test_a_factor_of_refinement_below_one_is_refused(sea):
    with pytest.raises(ValueError, match="`factor` must be at least 1, but is 0"):
        refine(sea.noise.real[..., None], 0)
