"""Skies of one colour, panoramas, and skies that are baked into panoramas."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

from jaxocean.optics.sky import SUN_RADIUS, AbstractSky, ConstantSky, HosekWilkie, ImageSky, Mirror, bake
from jaxocean.optics.sky._blur import VARIANCES


def directions(count: int, seed: int = 0) -> np.ndarray:
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def panorama(rows: int, function) -> np.ndarray:
    """The image whose pixels hold `function(x, y, z)` at their centres."""
    zenith = np.pi * (np.arange(rows)[:, None] + 0.5) / rows
    azimuth = 2 * np.pi * (0.75 - (np.arange(2 * rows) + 0.5) / (2 * rows))
    x, y = np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth)
    return np.stack([function(x, y, np.cos(zenith) + 0.0 * x)] * 3, axis=-1)


@eqx.filter_jit
def look(sky: AbstractSky, direction):
    return sky.radiance(direction)


@eqx.filter_jit
def look_wide(sky: AbstractSky, direction, variance):
    return sky.lobe_radiance(direction, variance)


@pytest.mark.parametrize(
    "sky", [ConstantSky((0.1, 0.2, 0.3)), ImageSky(np.full((16, 24, 3), [0.1, 0.2, 0.3]))]
)
def test_a_sky_of_one_colour_is_that_colour_everywhere_and_lights_the_ground_with_pi_times_it(sky):
    around = jnp.asarray(directions(50))
    np.testing.assert_allclose(look(sky, around), np.broadcast_to([0.1, 0.2, 0.3], (50, 3)), rtol=1e-12)
    wide = look_wide(sky, around, jnp.linspace(0.0, 0.5, 50))
    np.testing.assert_allclose(wide, np.broadcast_to([0.1, 0.2, 0.3], (50, 3)), rtol=1e-10)
    np.testing.assert_allclose(sky.irradiance(), np.pi * np.array([0.1, 0.2, 0.3]), rtol=1e-12)
    np.testing.assert_array_equal(sky.sun_irradiance, 0.0)


@pytest.mark.parametrize(
    "kind", [lambda e: ConstantSky(0.1, 2.0, e), lambda e: ImageSky(np.ones((4, 4, 3)), 0.0, 1.0, 2.0, e)]
)
def test_the_given_sun_sets_smoothly_where_its_disc_crosses_the_horizon(kind):
    beam = jax.jit(jax.vmap(lambda e: kind(e).sun_irradiance[0]))
    np.testing.assert_allclose(
        beam(jnp.array([-0.1, -SUN_RADIUS, 0.0, SUN_RADIUS, 0.1])), [0.0, 0.0, 1.0, 2.0, 2.0], atol=1e-12
    )
    # At half a radius the share of a disc above a chord is 1/2 + (asin(1/2) + √3/4)/π.
    share = 0.5 + (np.arcsin(0.5) + np.sqrt(3) / 4) / np.pi
    np.testing.assert_allclose(beam(jnp.array([SUN_RADIUS / 2])), 2.0 * share, rtol=1e-12)
    slope = jax.jit(jax.vmap(jax.grad(lambda e: kind(e).sun_irradiance[0])))
    edges = slope(jnp.array([-SUN_RADIUS, SUN_RADIUS, -0.99999 * SUN_RADIUS]))
    np.testing.assert_allclose(edges, 0.0, atol=4.0)
    assert slope(jnp.array([0.0]))[0] > 100.0


def test_the_sun_stands_where_elevation_and_azimuth_say():
    np.testing.assert_allclose(ConstantSky(0.0, 1.0, 0.0, np.pi / 2).sun_direction, [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(ConstantSky(0.0, 1.0, np.pi / 2).sun_direction, [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(ConstantSky(0.0, 1.0, -np.pi / 6).sun_direction[2], -0.5)


def test_the_middle_of_a_panorama_looks_north_and_its_right_quarter_east():
    image = np.zeros((8, 16, 3))
    image[3, 7:9], image[3, 11:13] = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    image[3, [0, 15]] = (0.0, 0.0, 1.0)
    low = np.array([[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]])
    sides = jnp.asarray(np.concatenate([low, np.full((4, 1), 0.1)], axis=1) / np.sqrt(1.01))
    np.testing.assert_allclose(look(ImageSky(image), sides), [*np.eye(3), np.zeros(3)], atol=1e-12)


def test_pixels_are_read_at_their_centres_and_the_mean_between_them():
    image = np.random.default_rng(1).uniform(size=(12, 20, 3))
    zenith = np.pi * (np.arange(6)[:, None] + 0.5) / 12

    def at(zenith, column):
        azimuth = 2 * np.pi * (0.75 - column / 20)
        flat = np.sin(zenith)
        vector = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.cos(zenith) + 0 * azimuth], -1)
        return look(ImageSky(image), jnp.asarray(vector))

    column = np.arange(20) + 0.5
    np.testing.assert_allclose(at(zenith, column), image[:6], atol=2e-6)
    np.testing.assert_allclose(
        at(zenith, column + 0.5), 0.5 * (image[:6] + np.roll(image[:6], -1, axis=1)), atol=2e-6
    )
    np.testing.assert_allclose(
        at(zenith[:-1] + np.pi / 24, column), 0.5 * (image[:5] + image[1:6]), atol=2e-6
    )


def test_rotation_turns_the_panorama_and_not_the_sun():
    image = np.random.default_rng(2).uniform(size=(16, 32, 3))
    around = directions(40)
    turn = np.array([[np.cos(0.7), -np.sin(0.7), 0], [np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    straight, turned = ImageSky(image), ImageSky(image, rotation=0.7, scale=3.0)
    np.testing.assert_allclose(
        look(turned, jnp.asarray(around @ turn.T)), 3.0 * look(straight, jnp.asarray(around)), rtol=1e-6
    )
    np.testing.assert_array_equal(turned.sun_direction, straight.sun_direction)


def test_the_irradiance_of_a_panorama_weights_its_pixels_by_solid_angle_and_cosine():
    sky = ImageSky(panorama(256, lambda x, y, z: z * z + x))
    # ∫ z² z dΩ = π/2 over the upper half.
    np.testing.assert_allclose(sky.irradiance(), np.pi / 2, rtol=1e-4)


def test_lobes_damp_harmonics_like_diffusion_on_the_sphere():
    sky = ImageSky(panorama(256, lambda x, y, z: 1.0 + x * y + 0.3 * x))
    around = directions(60, seed=4)
    around[:, 2] = np.abs(around[:, 2])
    x, y = around[:, 0], around[:, 1]
    for variance in VARIANCES[[0, 2, 5]]:
        found = look_wide(sky, jnp.asarray(around), jnp.full(60, variance))
        expected = 1.0 + np.exp(-3 * variance) * x * y + 0.3 * np.exp(-variance) * x
        # The mirrored x is no harmonic of degree one only near the horizon, where it has a crease.
        inside = around[:, 2] > 4 * np.sqrt(variance)
        np.testing.assert_allclose(found[inside, 0], expected[inside], atol=4e-3)
    between = look_wide(sky, jnp.asarray(around), jnp.full(60, 0.015))
    ends = [look_wide(sky, jnp.asarray(around), jnp.full(60, v)) for v in (0.01, 0.02)]
    np.testing.assert_allclose(between, 0.5 * (ends[0] + ends[1]), rtol=1e-9)


def test_a_lobe_of_no_width_is_the_radiance_and_the_widest_lobes_stay_finite():
    sky = ImageSky(np.random.default_rng(5).uniform(size=(16, 32, 3)))
    around = jnp.asarray(directions(40))
    # To rounding, as the compiler may order the sums of two programs differently.
    np.testing.assert_allclose(look_wide(sky, around, jnp.zeros(40)), look(sky, around), rtol=1e-14)
    widest = look_wide(sky, around, jnp.full(40, VARIANCES[-1]))
    np.testing.assert_array_equal(look_wide(sky, around, jnp.full(40, 50.0)), widest)


def test_lobes_on_a_clear_sky_are_gaussian_means_of_it():
    sky = HosekWilkie(3.0, 0.1, 0.6, 0.3)
    axes = jnp.asarray(directions(12, seed=6) * [1, 1, 0.5] + [0, 0, 0.9])
    axes = axes / jnp.linalg.norm(axes, axis=-1, keepdims=True)
    variance = 0.01
    # A dense polar rule for the Gaussian: exp(−r²/2s) r dr dφ / (2πs), r along great circles.
    r = 0.5 * (np.polynomial.legendre.leggauss(24)[0] + 1.0)
    weight = 0.5 * np.polynomial.legendre.leggauss(24)[1]
    radius = 4.5 * np.sqrt(variance) * r
    weight = weight * 4.5 * np.sqrt(variance) * radius * np.exp(-(radius**2) / (2 * variance)) / variance / 16
    expected = np.zeros((12, 3))
    for turn in 2 * np.pi * np.arange(16) / 16:
        side = np.cross(axes, [0.3, -0.5, 0.8])
        side /= np.linalg.norm(side, axis=-1, keepdims=True)
        tangent = np.cos(turn) * side + np.sin(turn) * np.cross(axes, side)
        rays = np.cos(radius)[:, None, None] * np.asarray(axes) + np.sin(radius)[:, None, None] * tangent
        expected += np.tensordot(weight, np.asarray(look(sky, jnp.asarray(rays))), 1)
    direct = look_wide(sky, axes, jnp.full(12, variance))
    np.testing.assert_allclose(direct, expected, rtol=0.02)
    baked = look_wide(bake(sky, 128), axes, jnp.full(12, variance))
    np.testing.assert_allclose(baked, expected, rtol=0.02)


def test_a_baked_sky_is_the_sky():
    sky = HosekWilkie(3.0, 0.1, 0.6, 0.3)
    baked = bake(sky, 256)
    around = directions(500)
    around = jnp.asarray(around[np.abs(around[:, 2]) > 0.02])
    np.testing.assert_allclose(look(baked, around), look(sky, around), rtol=0.02)
    np.testing.assert_allclose(
        np.median(np.abs(look(baked, around) / look(sky, around) - 1.0)), 0.0, atol=2e-4
    )
    np.testing.assert_allclose(baked.irradiance(), sky.irradiance(), rtol=1e-4)


@pytest.mark.parametrize("elevation", [1.0, 0.002, -0.001, -0.2, np.pi / 2])
def test_a_baked_sky_keeps_its_sun_also_while_it_sets(elevation):
    sky = HosekWilkie(3.0, 0.1, elevation, 0.4)
    baked = eqx.filter_jit(bake)(sky, 8)
    np.testing.assert_allclose(baked.sun_irradiance, sky.sun_irradiance, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(baked.sun_direction, sky.sun_direction, atol=1e-12)


def _seen(x):
    """One number from a panorama whose pixels, rotation, scale and lobe hang on `x`."""
    pixels = jnp.sin(jnp.arange(8 * 16 * 3.0)).reshape(8, 16, 3) * x[0] + 2.0
    sky = ImageSky(pixels, rotation=x[1], scale=x[2])
    around = jnp.asarray(directions(5, seed=8))
    lobe = sky.lobe_radiance(around, x[3] * jnp.array([1.0, 3.0, 6.0, 20.0, 70.0]))
    return (sky.radiance(around) + lobe).sum(0) @ jnp.array([1.0, 0.7, -0.4]) + sky.irradiance().sum()


def test_derivatives_of_a_panorama_match_finite_differences():
    assert_gradient_matches(_seen, [[0.7, 0.31, 1.2, 0.0031]], rtol=1e-6, atol=1e-8, step=1e-5)


def test_derivatives_of_a_panorama_are_finite_at_zenith_and_horizon():
    sky = ImageSky(np.random.default_rng(9).uniform(size=(8, 16, 3)))
    special = jnp.array(
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]
    )
    jacobian = jax.jit(jax.vmap(jax.jacfwd(lambda d, v: sky.lobe_radiance(d, v), argnums=(0, 1))))
    for part in jacobian(special, jnp.array([0.0, 0.005, 0.3, 1.0, 0.02])):
        assert np.all(np.isfinite(part))


def test_baked_skies_are_differentiable_in_the_clear_sky():
    around = jnp.asarray(directions(6))
    value = jax.jit(lambda x: bake(HosekWilkie(x, 0.1, 0.6), 16).radiance(around).sum())
    slope = jax.jit(jax.jacfwd(lambda x: bake(HosekWilkie(x, 0.1, 0.6), 16).radiance(around).sum()))
    np.testing.assert_allclose(slope(2.4), (value(2.401) - value(2.399)) / 0.002, rtol=1e-6)


def test_lobes_of_a_clear_sky_are_differentiable_in_the_suns_elevation():
    around, variance = jnp.asarray(directions(6)), jnp.full(6, 0.02)
    value = jax.jit(lambda e: HosekWilkie(3.0, 0.1, e).lobe_radiance(around, variance).sum())
    slope = jax.jit(jax.jacfwd(lambda e: HosekWilkie(3.0, 0.1, e).lobe_radiance(around, variance).sum()))
    np.testing.assert_allclose(slope(0.6), (value(0.6001) - value(0.5999)) / 0.0002, rtol=1e-5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ConstantSky(-0.1), "`dome` must be finite with a luminance of at least 0"),
        (lambda: ConstantSky(np.ones(2)), "`dome` must be one number or three"),
        (lambda: ConstantSky(0.1, np.nan), "`sun` must be finite"),
        (lambda: ConstantSky(0.1, 1.0, 2.0), "`sun_elevation` must be at most"),
        (lambda: ImageSky(np.ones((3, 8, 3))), "`image` must have the shape .* even height"),
        (lambda: ImageSky(np.ones((4, 8))), "`image` must have the shape"),
        (lambda: ImageSky(np.ones((4, 8, 4))), "`image` must have the shape"),
        (lambda: ImageSky(np.full((4, 8, 3), np.inf)), "`image` must be finite everywhere"),
        (lambda: ImageSky(np.ones((4, 8, 3)), scale=-1.0), "`scale` must be at least 0"),
        (lambda: bake(ConstantSky(1.0), 5), "`rows` must be even"),
    ],
)
def test_skies_that_cannot_be_are_refused_in_words(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_mirror_answers_as_its_panorama_does():
    image = np.random.default_rng(3).uniform(0.1, 1.0, (16, 32, 3))
    sky = ImageSky(image, 0.4, 1.7, 2.0, 0.5, 1.0)
    mirror = Mirror.of_sky(sky)
    around, variance = jnp.asarray(directions(60)), jnp.asarray(np.geomspace(1e-4, 1.0, 60))
    np.testing.assert_allclose(look(mirror, around), look(sky, around), rtol=1e-12)
    np.testing.assert_allclose(
        look_wide(mirror, around, variance), look_wide(sky, around, variance), rtol=1e-12
    )
    np.testing.assert_allclose(mirror.irradiance(), sky.irradiance(), rtol=1e-12)
    np.testing.assert_array_equal(mirror.sun_direction, sky.sun_direction)
    np.testing.assert_array_equal(mirror.sun_irradiance, sky.sun_irradiance)
    toward = sky.sun_direction[None]
    assert float(mirror.sun_radiance(toward)[0, 0]) > 0
    np.testing.assert_array_equal(mirror.sun_radiance(toward), sky.sun_radiance(toward))
