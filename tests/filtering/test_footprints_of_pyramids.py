"""Look-ups of moments: limits, known waves, sampled footprints, derivatives."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from _waves import half_noise, single_wave, strain_variances, wind_sea
from scipy.ndimage import map_coordinates

from jaxocean.filtering import Footprint, MeanPyramid, MomentPyramid, sampled_moments
from jaxocean.surface import AbstractSurface, Cascade, Sea, realise

CASCADE = Cascade((60.0, 9.0), 32)
TIME, LAMBDA = 0.8, (0.7, 1.2)
PLACES = np.random.default_rng(5).uniform(0, 60, (300, 2))


class Choppy(AbstractSurface):
    """The sea as it is seen: its strain with λ."""

    sea: Sea

    def height(self, p, time):
        return self.sea.height(p, time)

    def displacement(self, p, time):
        return self.sea.displacement(p, time, LAMBDA)

    def slope(self, p, time):
        return self.sea.slope(p, time)

    def strain(self, p, time):
        return self.sea.strain(p, time, LAMBDA)

    def height_bound(self):
        return self.sea.height_bound()

    def slope_bound(self):
        return self.sea.slope_bound()


@pytest.fixture(scope="module")
def sea():
    return realise(wind_sea(12.0), CASCADE, key=jax.random.key(1))


@pytest.fixture(scope="module")
def fields(sea):
    return sea.fields(TIME, LAMBDA)


@pytest.fixture(scope="module")
def pyramid(fields):
    return MomentPyramid.from_fields(fields, CASCADE)


@pytest.fixture(scope="module")
def refined(fields):
    return MomentPyramid.from_fields(fields, CASCADE, refinement=4)


def squares(side) -> Footprint:
    return Footprint.square(PLACES, np.full(len(PLACES), side))


def test_a_point_is_the_bilinear_surface_without_any_spread(pyramid, fields):
    seen = pyramid(squares(0.0))
    expected = 0.0
    for i, spacing in enumerate(CASCADE.spacings):
        x, y = PLACES.T / spacing
        strain = np.asarray(fields.strain[i])
        channels = [map_coordinates(strain[..., c], [y, x], order=1, mode="grid-wrap") for c in range(3)]
        expected = expected + np.stack(channels, axis=-1)
    np.testing.assert_allclose(seen.strain_mean, expected, atol=1e-12)
    np.testing.assert_array_equal(seen.strain_covariance, 0)
    np.testing.assert_array_equal(seen.slope_covariance, 0)


def test_a_footprint_larger_than_all_patterns_sees_their_constants(pyramid, fields):
    seen = pyramid(squares(500.0))
    strain, slope = (np.asarray(f).reshape(2, -1, f.shape[-1]) for f in (fields.strain, fields.slope))
    np.testing.assert_allclose(seen.strain_mean, 0, atol=1e-12)
    for got, values in ((seen.strain_covariance, strain), (seen.slope_covariance, slope)):
        expected = sum(np.cov(each, rowvar=False, bias=True) for each in values)
        np.testing.assert_allclose(got, np.broadcast_to(expected, got.shape), atol=1e-12)


def test_the_largest_footprint_has_the_variances_of_the_spectrum():
    sea = realise(wind_sea(), CASCADE, noise=half_noise(CASCADE))
    whole = MomentPyramid.from_fields(sea.fields(0.0), CASCADE)(squares(500.0))
    variances = np.diagonal(whole.strain_covariance[0])
    expected = strain_variances(wind_sea(), CASCADE.band)
    np.testing.assert_allclose(variances, expected, rtol=0.06)  # the lattice has corners and coarse cells


def test_each_pattern_collapses_at_its_own_size(pyramid):
    # √3 times the small pattern: it is all inside, the large one is hardly begun.
    seen = pyramid.patterns(squares(1.75 * 9.0))
    small, large = np.asarray(seen.strain_covariance[:, 1]), np.asarray(seen.strain_covariance[:, 0])
    np.testing.assert_allclose(small, np.broadcast_to(small[0], small.shape), atol=1e-12)
    assert np.std(large[:, 0, 0]) > 0.1 * np.mean(large[:, 0, 0])


def test_on_a_texel_of_a_level_the_footprint_is_its_box(pyramid, fields):
    # Second level of the large pattern: 4 × 4 samples; there the bilinear weights are one.
    spacing, span, texel = CASCADE.spacings[0], 4, (2, 5)
    centre = (np.asarray(texel) * span + 0.5 * (span - 1)) * spacing
    side = np.sqrt(3) * span * spacing  # whose variance is that of the level
    seen = pyramid.patterns(Footprint.square(centre[None], np.asarray([side])), probes=1)
    x, y = texel[0] * span, texel[1] * span
    box = np.asarray(fields.strain[0, y : y + span, x : x + span]).reshape(-1, 3)
    np.testing.assert_allclose(seen.strain_mean[0, 0], box.mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(seen.strain_covariance[0, 0], np.cov(box, rowvar=False, bias=True), atol=1e-12)


def test_mean_and_spread_together_keep_the_variance_of_the_sea(pyramid, fields):
    total = np.mean(np.sum(np.asarray(fields.strain) ** 2, axis=0), axis=(0, 1))
    rng = np.random.default_rng(0)
    places = rng.uniform(0, 180, (20000, 2))  # the period
    for side in (3.5, 8.0, 40.0):  # above √3 samples of the large pattern
        seen = pyramid.patterns(Footprint.square(places, np.full(len(places), side)), probes=1)
        inside = np.asarray(seen.strain_mean) ** 2 + np.diagonal(seen.strain_covariance, axis1=-2, axis2=-1)
        np.testing.assert_allclose(inside.sum(axis=1).mean(axis=0), total, rtol=0.02)


@pytest.mark.parametrize(("side", "tolerance"), [(0.3, 0.05), (1.5, 0.2), (6.0, 0.3), (20.0, 0.4)])
def test_isotropic_footprints_are_close_to_sampled_ones(sea, refined, fields, side, tolerance):
    """Tolerances: RMS errors relative to the sea's own deviation and variance."""
    few = Footprint.square(PLACES[:60], np.full(60, side))
    seen = refined(few, probes=1)
    true = sampled_moments(Choppy(sea), few, TIME, nodes=24)
    variance = float(np.mean(np.sum(np.asarray(fields.strain[..., 0]) ** 2, axis=0)))
    mean_error = np.std(np.asarray(seen.strain_mean - true.strain_mean)[:, 0])
    spread_error = np.asarray(seen.strain_covariance - true.strain_covariance)[:, 0, 0]
    assert mean_error < tolerance * np.sqrt(variance)
    assert np.std(spread_error) < tolerance * variance
    assert abs(np.mean(spread_error)) < 0.25 * tolerance * variance
    slope_error = np.asarray(seen.slope_mean - true.slope_mean)
    assert np.std(slope_error) < tolerance * float(np.std(np.asarray(sea.slope(PLACES, TIME))))


def wave_along_x():
    """Twelve metres long, sixteen samples to the wave after refinement."""
    cascade = Cascade((60.0,), 32)
    sea, h0, kx, _ = single_wave(0, 5, cascade)
    return MomentPyramid.from_fields(sea.fields(0.0), cascade, refinement=4), 2 * abs(h0), kx


def test_footprints_along_the_crests_see_no_spread_and_those_across_all_of_it():
    wave, amplitude, kx = wave_along_x()
    places = jnp.asarray(PLACES[:40])

    def spread(edges):
        seen = wave(Footprint(places, jnp.broadcast_to(jnp.asarray(edges), (40, 2, 2))), probes=16)
        return np.asarray(seen.slope_covariance)[:, 0, 0]

    variance = 0.5 * (amplitude * kx) ** 2
    along = spread([[1.0, 0.0], [0.0, 24.0]])
    across = spread([[24.0, 0.0], [0.0, 1.0]])
    assert np.max(along) < 0.15 * variance
    np.testing.assert_allclose(across, variance, rtol=0.03)
    # The edges may be given in any order, and need not be at right angles to the axes.
    np.testing.assert_allclose(spread([[0.0, 24.0], [1.0, 0.0]]), across, rtol=1e-9)
    turned = spread([[24 / np.sqrt(2), -1 / np.sqrt(2)], [24 / np.sqrt(2), 1 / np.sqrt(2)]])
    assert np.all(turned > 0.8 * variance)


def test_more_probes_come_closer_to_a_long_footprint(sea, refined):
    angle = 0.5
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    axes = np.broadcast_to(turn @ np.diag([12.0, 1.5]), (60, 2, 2))
    long = Footprint(PLACES[:60], axes)
    true = sampled_moments(Choppy(sea), long, TIME, nodes=32)
    errors = []
    for probes in (1, 4, 8):
        seen = refined(long, probes=probes)
        errors.append(np.std(np.asarray(seen.strain_mean - true.strain_mean)))
    assert errors[2] < 0.7 * errors[1] < 0.7 * errors[0]


def test_the_sum_over_patterns_is_the_sum_of_patterns(pyramid):
    one, other = pyramid(squares(2.0)), pyramid.patterns(squares(2.0)).sum_patterns()
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-13), one, other)


def test_far_from_the_origin_numpy_coordinates_lose_nothing_in_a_float32_pyramid(fields):
    single = MomentPyramid.from_samples(
        fields.slope.astype(jnp.float32), fields.strain.astype(jnp.float32), CASCADE.sizes
    )
    near, far = PLACES, PLACES + 180.0 * 5556
    side = np.full(len(near), 0.5)
    expected, seen = single(Footprint.square(near, side)), single(Footprint.square(far, side))
    np.testing.assert_allclose(seen.slope_mean, expected.slope_mean, atol=2e-5)
    assert seen.slope_mean.dtype == jnp.float32


def test_float32_covariances_are_right_to_a_hundred_millionth(pyramid, fields):
    single = MomentPyramid.from_samples(
        fields.slope.astype(jnp.float32), fields.strain.astype(jnp.float32), CASCADE.sizes
    )
    for side in (0.3, 3.0, 30.0):
        double, rounded = pyramid(squares(side)), single(squares(side))
        # Beside rounding of the products there is that of the place, a few millionths of a sample.
        np.testing.assert_allclose(rounded.strain_covariance, double.strain_covariance, atol=2e-7)


def test_channels_have_their_own_means(fields):
    channels = jnp.concatenate([fields.strain, fields.strain**2], axis=-1)
    means = MeanPyramid.from_channels(channels, CASCADE.sizes)(squares(500.0))
    assert means.shape == (300, 2, 6)
    expected = np.mean(np.asarray(channels), axis=(1, 2))
    np.testing.assert_allclose(means, np.broadcast_to(expected, means.shape), atol=1e-12)
    rounded = MeanPyramid.from_channels(channels, CASCADE.sizes).stored_as(jnp.float16)
    assert rounded.texture.dtype == jnp.float16


def test_resolutions_that_are_no_power_of_two_work_alike():
    cascade = Cascade((60.0,), 24)
    fields = realise(wind_sea(), cascade, key=jax.random.key(0)).fields(0.0)
    odd = MomentPyramid.from_fields(fields, cascade)
    whole = odd(squares(500.0))
    expected = np.cov(np.asarray(fields.strain).reshape(-1, 3), rowvar=False, bias=True)
    np.testing.assert_allclose(whole.strain_covariance[0], expected, atol=1e-12)
    point = odd(Footprint.square(np.asarray([[57.5, 0.0], [-2.5, 60.0]]), np.zeros(2)))
    np.testing.assert_allclose(
        point.strain_mean, np.asarray(fields.strain)[0, 0, 23][None].repeat(2, 0), atol=1e-9
    )


def test_batches_and_vmap_agree(pyramid):
    centres, axes = jnp.asarray(PLACES[:6]), jnp.broadcast_to(2.0 * jnp.eye(2), (6, 2, 2))
    together = pyramid(Footprint(centres, axes))
    one_by_one = eqx.filter_vmap(lambda c, a: pyramid(Footprint(c, a)))(centres, axes)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-13), together, one_by_one)
    grid = pyramid(Footprint(centres.reshape(2, 3, 2), jnp.eye(2)))
    assert grid.strain_covariance.shape == (2, 3, 3, 3)
    assert pyramid(Footprint(jnp.zeros((0, 2)), jnp.eye(2))).strain_mean.shape == (0, 3)


def test_moments_are_differentiable_in_choppiness_and_in_the_fields(fields):
    footprint = Footprint(jnp.asarray([[3.0, 4.0], [20.0, 30.0]]), jnp.asarray([[5.0, 0.3], [0.0, 1.0]]))
    other = jnp.roll(fields.slope, 3, axis=1)

    def spread(q):
        strain = q[0] * fields.strain  # strain is proportional to λ
        seen = MomentPyramid.from_samples(fields.slope + q[1] * other, strain, CASCADE.sizes)(
            footprint, probes=1
        )
        return jnp.sum(seen.strain_mean**2) + jnp.sum(seen.strain_covariance) + jnp.sum(seen.slope_covariance)

    assert_derivative_matches(spread, [1.1, 0.3], step=1e-4)


def test_moments_are_differentiable_in_the_footprint_off_the_edges_of_texels(pyramid):
    def spread(q):
        seen = pyramid(Footprint(q[:2], q[2:].reshape(2, 2)), probes=2)
        return jnp.sum(seen.strain_mean) + jnp.sum(seen.strain_covariance) + jnp.sum(seen.slope_covariance)

    assert_derivative_matches(spread, [3.1, 4.2, 5.0, 0.3, 0.4, 1.1], step=1e-6, rtol=1e-5)
    gradient = jax.jit(jax.grad(spread))
    for edges in (jnp.zeros(4), jnp.asarray([2.0, 0.0, 0.0, 2.0])):
        slopes = gradient(jnp.concatenate([jnp.asarray([3.1, 4.2]), edges]))
        assert np.all(np.isfinite(slopes))


def test_a_number_of_probes_that_makes_no_sense_is_refused(pyramid):
    with pytest.raises(ValueError, match="`probes` must be 1 to 64, but is 0"):
        pyramid(squares(1.0), probes=0)
