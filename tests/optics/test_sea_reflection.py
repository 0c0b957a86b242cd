"""Glitter and mirrored sky against one another, against drawn facets, and against the limits of a flat sea."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

from jaxocean.optics import (
    AzimuthCorrelatedMasking,
    BrunetonReflection,
    ExactFresnel,
    FacetReflection,
    HeightCorrelatedMasking,
    IndependentMasking,
    LobeReflection,
    SchlickFresnel,
    SlopeQuadrature,
    fresnel,
    mean_fresnel,
    sun_glitter,
)
from jaxocean.optics.sky import SUN_RADIUS, AbstractSky, ConstantSky


class SlantedSky(AbstractSky):
    """Brighter towards the horizon and towards the east; a lobe is four directions."""

    @property
    def sun_direction(self):
        return jnp.array([0.0, 0.0, 1.0])

    @property
    def sun_irradiance(self):
        return jnp.zeros(3)

    def radiance(self, direction):
        shape = jnp.exp(-2.0 * jnp.abs(direction[..., 2])) * (1.0 + 0.4 * direction[..., 0])
        return shape[..., None] * jnp.array([1.0, 2.0, 3.0], direction.dtype)

    def sun_radiance(self, direction):
        return jnp.zeros_like(direction)

    def lobe_radiance(self, direction, variance):
        up = jnp.array([0.0, 0.6, 0.8], direction.dtype)
        one = jnp.cross(direction, up)
        one = one / jnp.linalg.norm(one)
        step = jnp.sqrt(2.0 * variance + 1e-30)
        ends = [
            direction + sign * step * axis
            for axis in (one, jnp.cross(direction, one))
            for sign in (1.0, -1.0)
        ]
        return sum(self.radiance(end / jnp.linalg.norm(end)) for end in ends) / 4.0

    def irradiance(self):
        return jnp.ones(3)


def direction(zenith, azimuth=0.0):
    return jnp.stack(
        [
            jnp.sin(zenith) * jnp.cos(azimuth),
            jnp.sin(zenith) * jnp.sin(azimuth),
            jnp.cos(zenith) + 0.0 * azimuth,
        ]
    )


@pytest.fixture(scope="module")
def furnace():
    """(view, deviations, law, masking) → what a rough sea reflects of a sky of radiance 1, summed over suns.

    The suns are those that facets on a grid of slopes mirror: dΩ_L = 4 (V·H) H_z³ dζ.
    """
    axis = jnp.linspace(-6.0, 6.0, 141)
    grid = jnp.stack(jnp.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)

    def reflected(view, deviations, law, masking):
        def facet(slope):
            normal = jnp.stack([-slope[0], -slope[1], 1.0]) * jax.lax.rsqrt(1 + slope @ slope)
            cosine = view @ normal
            sun = 2 * cosine * normal - view
            glitter = sun_glitter(view, sun, jnp.zeros(2), jnp.diag(deviations**2), law, masking)
            return jnp.where((cosine > 0) & (sun[2] > 0), glitter * 4 * cosine * normal[2] ** 3, 0.0)

        area = jnp.prod(deviations) * (axis[1] - axis[0]) ** 2
        return jnp.sum(jax.vmap(facet)(grid * deviations)) * area

    compiled = {}

    def of(zenith, along, across, law, masking):
        key = (type(law), type(masking))
        compiled.setdefault(key, jax.jit(lambda v, d: reflected(v, d, law, masking)))
        return float(compiled[key](direction(jnp.array(zenith)), jnp.array([along, across])))

    return of


@pytest.mark.parametrize(
    "masking", [HeightCorrelatedMasking(), AzimuthCorrelatedMasking(), IndependentMasking()]
)
def test_no_sea_reflects_more_than_it_gets_even_if_every_facet_is_a_mirror(furnace, masking):
    for zenith in (0.0, 0.6, 1.1, 1.4, 1.5, 1.56):
        for along, across in ((0.07, 0.07), (0.15, 0.1), (0.1, 0.25), (0.3, 0.3)):
            assert 0.05 < furnace(zenith, along, across, SchlickFresnel(1.0), masking) <= 1.002


def test_mirrors_of_a_gentle_sea_return_all_light_to_a_high_viewer(furnace):
    for zenith in (0.0, 0.5):
        got = furnace(zenith, 0.08, 0.06, SchlickFresnel(1.0), HeightCorrelatedMasking())
        np.testing.assert_allclose(got, 1.0, rtol=1e-4)


def test_glitter_of_a_white_sky_is_the_mean_reflectance_of_the_sky_term(furnace):
    """Two formulas, one sea: summed over the sun's directions the glitter is what the sky term averages."""
    for zenith, along, across in ((0.0, 0.1, 0.1), (0.7, 0.15, 0.1), (1.0, 0.1, 0.2)):
        view, covariance = direction(jnp.array(zenith)), jnp.diag(jnp.array([along**2, across**2]))
        got = furnace(zenith, along, across, ExactFresnel(), HeightCorrelatedMasking())
        expected = mean_fresnel(view, jnp.zeros(2), covariance, visible=SlopeQuadrature(12, 3))
        np.testing.assert_allclose(got, expected, rtol=0.015)


def test_glitter_is_what_drawn_facets_send_from_a_small_sun():
    rng = np.random.default_rng(0)
    mean, covariance = np.array([0.1, -0.05]), np.array([[0.02, 0.004], [0.004, 0.01]])
    view, tilt = np.asarray(direction(0.7, 0.3)), mean + np.array([0.14, 0.03])
    normal = np.array([*-tilt, 1.0]) / np.sqrt(1 + tilt @ tilt)
    sun = 2 * (view @ normal) * normal - view
    slopes = rng.multivariate_normal(mean, covariance, 2_000_000)
    q = np.maximum(view[2] - slopes @ view[:2], 0)
    square = 1 + np.sum(slopes**2, axis=1)
    towards = 2 * (q / square)[:, None] * np.concatenate([-slopes, np.ones((len(slopes), 1))], axis=1) - view
    radius = 0.03
    hit = towards @ sun > np.cos(radius)
    solid = 2 * np.pi * (1 - np.cos(radius))
    reflected = np.asarray(fresnel(jnp.asarray(q[hit] / np.sqrt(square[hit])), 1.34))
    expected = np.sum(q[hit] * reflected) / len(slopes) / (view[2] - mean @ view[:2]) / solid
    got = sun_glitter(*(jnp.asarray(each) for each in (view, sun, mean, covariance)))
    np.testing.assert_allclose(got, expected, rtol=0.02)


@pytest.mark.parametrize("zenith", [0.0, 0.6, 1.3])
def test_a_flat_sea_shows_the_sun_where_it_is_mirrored_and_nowhere_else(zenith):
    flat = jnp.zeros(2), jnp.zeros((2, 2))
    sun = direction(zenith, 0.0)
    centre = sun_glitter(direction(zenith, np.pi), sun, *flat)
    # The disc's radiance is E/(π r²); a Gaussian of its variance r²/4 peaks at twice that.
    disc = fresnel(jnp.cos(zenith), 1.34) / (np.pi * SUN_RADIUS**2)
    np.testing.assert_allclose(centre, 2 * disc, rtol=0.01)
    # One radius off, along the view and across it, it falls by e^(-2).
    for aside in (
        direction(zenith + SUN_RADIUS, np.pi),
        direction(zenith, np.pi + SUN_RADIUS / np.sin(zenith + 1e-9)),
    ):
        if zenith > 0:
            np.testing.assert_allclose(sun_glitter(aside, sun, *flat) / centre, np.exp(-2), rtol=0.1)
    assert sun_glitter(direction(zenith + 0.05, np.pi), sun, *flat) < 1e-9 * centre


@pytest.mark.parametrize("reflection", [LobeReflection(), FacetReflection()])
def test_a_flat_sea_mirrors_the_sky_exactly(reflection):
    sky, law = SlantedSky(), ExactFresnel()
    for zenith, azimuth in ((0.0, 0.0), (0.9, 2.0), (1.5, 0.4)):
        view = direction(zenith, azimuth)
        got = reflection(view, jnp.zeros(2), jnp.zeros((2, 2)), sky, law)
        mirror = view * jnp.array([-1.0, -1.0, 1.0])
        np.testing.assert_allclose(got.radiance, fresnel(view[2], 1.34) * sky.radiance(mirror), rtol=1e-8)


def test_a_tilted_flat_facet_mirrors_the_sky_about_its_own_normal():
    view, slope = direction(0.8, 0.3), jnp.array([0.1, -0.2])
    normal = np.array([-0.1, 0.2, 1.0]) / np.sqrt(1.05)
    cosine = float(np.asarray(view) @ normal)
    mirror = 2 * cosine * normal - np.asarray(view)
    got = LobeReflection()(view, slope, jnp.zeros((2, 2)), SlantedSky(), ExactFresnel())
    expected = fresnel(jnp.array(cosine), 1.34) * SlantedSky().radiance(jnp.asarray(mirror))
    np.testing.assert_allclose(got.radiance, expected, rtol=1e-8)


@pytest.mark.parametrize("zenith", [0.2, 1.0, 1.35, 1.5])
def test_the_quadrature_of_facets_is_what_drawn_facets_reflect_of_the_sky(zenith):
    sky, view = SlantedSky(), direction(zenith, 0.4)
    covariance = np.array([[0.03, 0.006], [0.006, 0.015]])
    slopes = np.random.default_rng(2).multivariate_normal([0.05, 0.0], covariance, 300_000)
    v = np.asarray(view)
    q = np.maximum(v[2] - slopes @ v[:2], 0)
    square = 1 + np.sum(slopes**2, axis=1)
    towards = 2 * (q / square)[:, None] * np.concatenate([-slopes, np.ones((len(slopes), 1))], axis=1) - v
    each = q * np.asarray(fresnel(jnp.asarray(q / np.sqrt(square)), 1.34))
    expected = each @ np.asarray(sky.radiance(jnp.asarray(towards))) / np.sum(q)
    arguments = view, jnp.array([0.05, 0.0]), jnp.asarray(covariance), sky, ExactFresnel()
    np.testing.assert_allclose(FacetReflection()(*arguments).radiance, expected, rtol=0.01)
    # One round lobe instead of the true one, in a sky that doubles within it.
    np.testing.assert_allclose(LobeReflection()(*arguments).radiance, expected, rtol=0.08)


def test_every_reflection_sees_a_white_sky_alike():
    for reflection, tolerance in ((LobeReflection(), 0.01), (BrunetonReflection(), 0.25)):
        arguments = direction(1.2), jnp.zeros(2), 0.02 * jnp.eye(2), ConstantSky(1.0), ExactFresnel()
        expected = FacetReflection()(*arguments)
        np.testing.assert_allclose(reflection(*arguments).radiance, expected.radiance, rtol=tolerance)
        np.testing.assert_allclose(
            reflection(*arguments).radiance, reflection(*arguments).reflectance * jnp.ones(3)
        )


def test_no_glitter_is_brighter_than_the_sun_however_flat_the_sea_and_low_the_sun():
    """The disc's radiance at its middle, per irradiance, is that of its Gaussian: 1/(2π variance)."""
    disc = 1 / (2 * np.pi * SUN_RADIUS**2 / 4)
    low = 10.0 ** -np.arange(0.2, 3.2, 0.25)
    view = jnp.stack([direction(np.pi / 2 - each, 0.0) for each in low])
    for height in low:
        sun = direction(np.pi / 2 - height, np.pi + 0.001)
        for variance in (0.0, 1e-6, 1e-3, 0.04):
            found = sun_glitter(
                view, sun, jnp.zeros((low.size, 2)), jnp.full(low.size, variance)[:, None, None] * jnp.eye(2)
            )
            assert np.all(np.asarray(found) < 1.06 * disc)


def test_a_sun_that_is_down_sends_no_glitter():
    for elevation in (-0.3, -1.2):
        sun = direction(np.pi / 2 - elevation, 0.2)
        assert sun_glitter(direction(1.3, np.pi), sun, jnp.zeros(2), 0.04 * jnp.eye(2)) == 0.0


def test_glitter_has_derivatives_that_match_differences_and_are_finite_at_singular_points():
    def glitter(p):
        covariance = jnp.stack([p[4], p[5], p[5], p[6]]).reshape(2, 2)
        return sun_glitter(direction(p[0], p[1]), direction(p[7], p[8]), p[2:4], covariance)

    points = [[1.2, 0.4, 0.05, -0.1, 0.03, 0.008, 0.012, 1.0, 3.0]]
    assert_gradient_matches(glitter, points, rtol=1e-5, atol=1e-8, step=1e-5)
    gradient = jax.jit(jax.grad(glitter))
    for view in (0.0, 1.0, math.pi / 2):
        for sun in (0.0, 1.0, math.pi / 2, 2.0):
            for variance in (0.0, 0.04):
                point = jnp.array([view, 0.0, 0.0, 0.0, variance, 0.0, variance, sun, math.pi])
                assert np.all(np.isfinite(gradient(point)))


@pytest.mark.parametrize(
    "reflection", [LobeReflection(), FacetReflection(SlopeQuadrature(2, 2)), BrunetonReflection()]
)
def test_the_mirrored_sky_has_derivatives_that_match_differences(reflection):
    def mirrored(p):
        covariance = jnp.stack([p[4], p[5], p[5], p[6]]).reshape(2, 2)
        found = reflection(direction(p[0], p[1]), p[2:4], covariance, SlantedSky(), ExactFresnel())
        return jnp.sum(found.radiance * jnp.array([1.0, 0.3, -0.7]))

    points = [[1.2, 0.4, 0.05, -0.1, 0.03, 0.008, 0.012]]
    assert_gradient_matches(mirrored, points, rtol=1e-5, atol=1e-9, step=1e-5)
    gradient = jax.jit(jax.grad(mirrored))
    for view in (0.0, 1.0, math.pi / 2):
        for variance in (0.0, 0.04):
            assert np.all(np.isfinite(gradient(jnp.array([view, 0.0, 0.0, 0.0, variance, 0.0, variance]))))
