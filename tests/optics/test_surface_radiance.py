"""The sum of sun, sky, water and foam: energy, limits, night, derivatives."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxocean.optics import (
    AdditiveMixing,
    AgeingFoam,
    AzimuthCorrelatedMasking,
    BrunetonReflection,
    ConstantWater,
    CrestFoam,
    FacetReflection,
    FlatFoam,
    Foam,
    IndependentMasking,
    SchlickFresnel,
    Shading,
    SlopeQuadrature,
    Water,
    fresnel,
    surface_radiance,
)
from jaxocean.optics.sky import ConstantSky


@pytest.fixture(scope="module")
def points():
    """Footprints of all roughness under all views, slopes that face the viewer or not: (view, slope, covariance, W)."""
    rng = np.random.default_rng(0)
    count = 2000
    cosine, azimuth = rng.uniform(-0.05, 1, count), rng.uniform(0, 2 * np.pi, count)
    sine = np.sqrt(1 - cosine**2)
    view = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=-1)
    slope = rng.normal(0, 0.15, (count, 2))
    root = rng.normal(0, 0.1, (count, 2, 2)) * (rng.random((count, 1, 1)) < 0.8)
    covariance = root @ np.swapaxes(root, 1, 2)
    coverage = np.clip(rng.uniform(-0.2, 1.2, count), 0, 1)
    return tuple(jnp.asarray(each) for each in (view, slope, covariance, coverage))


@pytest.fixture(scope="module")
def shade():
    return eqx.filter_jit(surface_radiance)


def test_the_total_is_the_sum_of_its_parts_and_never_negative(points, shade):
    for sky in (ConstantSky(1.0, sun=3.0), ConstantSky((0.2, 0.3, 0.5), sun=5.0, sun_elevation=0.02)):
        got = shade(*points, sky, ConstantWater(), Foam())
        np.testing.assert_allclose(got.total, got.sun + got.sky + got.water + got.foam, rtol=1e-12)
        for part in got:
            assert part.shape == (2000, 3)
            assert np.all(np.isfinite(part))
            assert np.all(part >= 0)


def test_a_white_furnace_without_sun_is_nowhere_brighter_than_its_sky(points, shade):
    """Water and foam that return everything, facets that reflect what they do: at most the sky's own radiance."""
    white = ConstantSky(1.0), ConstantWater(1.0), Foam(brightness=1.0)
    got = shade(*points, *white).total
    np.testing.assert_allclose(got, 1.0, rtol=1e-6)
    dim = shade(*points, ConstantSky(1.0), Water(), Foam()).total
    assert np.all(dim <= 1)
    additive = shade(*points, *white, shading=Shading(mixing=AdditiveMixing())).total
    np.testing.assert_allclose(additive, 1 + np.asarray(points[3])[:, None] * np.ones(3), rtol=1e-6)


def test_the_ends_of_coverage_are_bare_water_and_bare_foam(points, shade):
    view, slope, covariance, coverage = points
    sky = ConstantSky(0.7, sun=3.0, sun_elevation=0.8)
    bare = shade(view, slope, covariance, 0 * coverage, sky, Water(), Foam())
    np.testing.assert_array_equal(bare.foam, 0.0)
    covered = shade(view, slope, covariance, 0 * coverage + 1, sky, Water(), Foam())
    np.testing.assert_array_equal(covered.total, covered.foam)
    half = shade(view, slope, covariance, 0 * coverage + 0.5, sky, Water(), Foam())
    np.testing.assert_allclose(half.total, 0.5 * (bare.total + covered.total), rtol=1e-9)


def test_foam_is_a_lambertian_plane_in_sun_and_sky(shade):
    sky = ConstantSky(0.5, sun=2.0, sun_elevation=0.6)
    one = jnp.ones(1)
    flat = jnp.array([[0.3, 0.4, math.sqrt(0.75)]]), jnp.zeros((1, 2)), jnp.zeros((1, 2, 2)), one
    expected = 0.22 / np.pi * (2.0 * np.sin(0.6) + np.pi * 0.5)
    np.testing.assert_allclose(shade(*flat, sky, Water(), Foam()).total, expected, rtol=1e-6)
    away = flat[0], jnp.array([[math.tan(1.2), 0.0]]), *flat[2:]
    np.testing.assert_allclose(shade(*away, sky, Water(), Foam()).total, 0.22 * 0.5, rtol=1e-6)


def test_a_flat_sea_is_a_mirror_over_its_water(shade):
    view = jnp.array([[0.6, 0.0, 0.8]])
    flat = view, jnp.zeros((1, 2)), jnp.zeros((1, 2, 2)), jnp.zeros(1)
    got = shade(*flat, ConstantSky(1.0), ConstantWater(), Foam())
    reflected = float(fresnel(jnp.array(0.8), 1.34))
    np.testing.assert_allclose(got.sky[0], reflected, rtol=1e-9)
    np.testing.assert_allclose(got.water[0], (1 - reflected) * ConstantWater().colour, rtol=1e-9)


def test_at_night_the_sea_is_black_and_everything_is_finite(points, shade):
    for elevation in (-0.0047, -0.1, -1.5):
        sky = ConstantSky(0.0, sun=5.0, sun_elevation=elevation)
        for part in shade(*points, sky, Water(), Foam()):
            np.testing.assert_allclose(part, 0.0, atol=1e-6)


@pytest.mark.parametrize(
    "shading",
    [
        Shading(fresnel=SchlickFresnel()),
        Shading(sky_reflection=BrunetonReflection()),
        Shading(sky_reflection=FacetReflection(SlopeQuadrature(4, 2))),
        Shading(masking=AzimuthCorrelatedMasking()),
        Shading(masking=IndependentMasking()),
        Shading(foam_view=CrestFoam(3.0)),
        Shading(foam_view=FlatFoam()),
    ],
)
def test_every_choice_changes_the_picture_a_little_and_breaks_nothing(points, shade, shading):
    sky = ConstantSky(0.5, sun=3.0, sun_elevation=0.3)
    default = shade(*points, sky, Water(), Foam()).total
    got = shade(*points, sky, Water(), Foam(), shading=shading).total
    assert np.all(np.isfinite(got))
    difference = np.mean(np.abs(got - default)) / np.mean(default)
    assert 1e-5 < difference < 0.2


def test_old_foam_is_darker(points, shade):
    view, slope, covariance, coverage = points
    arguments = view, slope, covariance, coverage, ConstantSky(1.0), Water(), AgeingFoam()
    fresh, old = (shade(*arguments, foam_age=age + 0 * coverage).foam for age in (0.0, 5.0))
    np.testing.assert_allclose(old, fresh * math.exp(-5.0 / (3.53 * 0.4 / 0.6)), rtol=1e-6)


def test_single_precision_follows_double(points, shade):
    sky = ConstantSky(0.5, sun=3.0, sun_elevation=0.3)
    wide = shade(*points, sky, Water(), Foam()).total
    narrow = jax.tree.map(lambda x: x.astype(jnp.float32), (*points, sky, Water(), Foam()))
    got = shade(*narrow, shading=jax.tree.map(lambda x: x.astype(jnp.float32), Shading())).total
    assert got.dtype == jnp.float32
    got, wide = np.asarray(got, np.float64), np.asarray(wide)
    error = np.abs(got - wide) / (np.abs(wide) + 1e-3)
    assert np.max(error) < 0.02
    assert np.mean(error) < 1e-4


def test_a_mapped_batch_and_the_batch_itself_agree(points, shade):
    scene = ConstantSky(0.5, sun=3.0), Water(), Foam()
    mapped = jax.jit(jax.vmap(lambda *a: surface_radiance(*a, *scene).total))(*points)
    np.testing.assert_allclose(mapped, shade(*points, *scene).total, rtol=1e-9, atol=1e-15)


def test_derivatives_match_differences_in_every_argument(points):
    """A directional derivative in all arguments and parameters at once, in a generic scene."""
    view, slope, covariance, coverage = (each[50:60] for each in points)
    view = jnp.where(view[:, 2:] < 0.1, jnp.array([0.6, 0.0, 0.8]), view)
    covariance = covariance + 0.01 * jnp.eye(2)
    coverage = jnp.clip(coverage, 0.1, 0.9)
    scene = (
        view,
        slope,
        covariance,
        coverage,
        ConstantSky(0.5, sun=3.0, sun_elevation=0.6),
        Water(0.3),
        Foam(),
    )
    rng = np.random.default_rng(1)
    step = jax.tree.map(lambda x: jnp.asarray(rng.normal(0, 1, x.shape)) * 0.1, scene)
    weights = jnp.asarray(rng.normal(0, 1, (10, 3)))

    @jax.jit
    def brightness(h):
        moved = jax.tree.map(lambda x, d: x + h * d, scene, step)
        return jnp.sum(weights * surface_radiance(*moved).total)

    h = 1e-4
    fine = (brightness(h) - brightness(-h)) / (2 * h)
    coarse = (brightness(2 * h) - brightness(-2 * h)) / (4 * h)
    # Forward mode has its tests with each term.
    np.testing.assert_allclose(jax.grad(brightness)(0.0), (4 * fine - coarse) / 3, rtol=1e-6)


def test_derivatives_are_finite_at_grazing_views_flat_seas_sunsets_and_both_ends_of_coverage():
    views = jnp.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-0.6, 0.0, 0.8], [0.999, 0.0, -0.0447]])
    cases = [(v, c, w) for v in range(4) for c in (0.0, 0.03) for w in (0.0, 1.0)]
    view = views[jnp.array([v for v, _, _ in cases])]
    covariance = jnp.array([c for _, c, _ in cases])[:, None, None] * jnp.eye(2)
    coverage = jnp.array([w for _, _, w in cases])

    @jax.jit
    def gradient(sky):
        def brightness(scene):
            return jnp.sum(surface_radiance(*scene, Water(), Foam()).total)

        return jax.grad(brightness)((view, jnp.zeros((16, 2)), covariance, coverage, sky))

    for elevation in (-0.2, 0.0, 0.7, np.pi / 2):
        for leaf in jax.tree.leaves(gradient(ConstantSky(0.5, sun=3.0, sun_elevation=elevation))):
            assert np.all(np.isfinite(leaf))


@pytest.mark.parametrize("wrong", [-0.1, 1.5, np.nan])
def test_a_coverage_that_is_no_share_is_refused(points, wrong):
    view, slope, covariance, coverage = points
    with pytest.raises(ValueError, match="coverage"):
        surface_radiance(
            view, slope, covariance, coverage.at[3].set(wrong), ConstantSky(1.0), Water(), Foam()
        )
