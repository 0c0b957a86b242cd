"""The brightness of foam and how much of it is seen."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches

from jaxocean.optics import (
    AgeingFoam,
    CrestFoam,
    EvenFoam,
    FlatFoam,
    Foam,
    frouin_colour,
    smith_lambda,
)
from jaxocean.optics._colour import reflectance_to_srgb


def test_the_two_reflectances_go_by_their_names():
    np.testing.assert_allclose(Foam().reflectance(), 0.22, rtol=1e-6)
    np.testing.assert_allclose(Foam.premoze().reflectance(), 0.4, rtol=1e-6)


def test_frouins_foam_loses_red_and_nothing_else():
    red, green, blue = np.asarray(frouin_colour())
    # The sRGB red lies near 610 nm, where the factor is 0.947.
    assert 0.91 < red < 0.97
    assert 0.98 < green < 1.01
    np.testing.assert_allclose(blue, 1.0, atol=0.01)
    fine = np.arange(400.0, 781.0, 5.0)
    factors = np.interp(fine, [555.0, 670.0, 765.0, 865.0], [1.0, 0.889, 0.760, 0.645])
    np.testing.assert_allclose([red, green, blue], reflectance_to_srgb(fine, jnp.asarray(factors)), atol=1e-3)


def test_ageing_foam_has_koepkes_factor_on_average_over_its_ages():
    foam = AgeingFoam()
    ages = np.random.default_rng(0).exponential(3.53, 400_000)
    mean = np.mean(np.asarray(foam.reflectance(jnp.asarray(ages))), axis=0)
    np.testing.assert_allclose(mean, 0.4 * 0.55, rtol=0.005)
    np.testing.assert_allclose(foam.reflectance(), 0.22, rtol=1e-6)
    np.testing.assert_allclose(foam.reflectance(jnp.array([0.0]))[0], 0.55, rtol=1e-6)


def test_all_foam_may_have_one_age():
    np.testing.assert_allclose(AgeingFoam(age=2.353).reflectance(), 0.55 / np.e, rtol=1e-3)
    np.testing.assert_allclose(AgeingFoam(age=9.0).reflectance(jnp.array([0.0]))[0], 0.55, rtol=1e-6)
    with pytest.raises(ValueError, match="`age` must be at least 0 s"):
        AgeingFoam(age=-1.0)


@pytest.mark.parametrize("preference", [0.3, 1.0, 4.0])
def test_foam_on_crests_is_seen_as_often_as_the_height_dependent_masking_says(preference):
    """Facets at relative height χ are seen with the chance χ^Λ: draws of heights, foam's and the rest's."""
    rng = np.random.default_rng(1)
    hidden = float(smith_lambda(jnp.array(0.06), jnp.array(0.03)))
    assert hidden > 0.5
    foam, sea = rng.random(400_000) ** (1 / preference), rng.random(400_000)
    gain = np.mean(foam**hidden) / np.mean(sea**hidden)
    small = 1e-4
    got = CrestFoam(preference)(jnp.array(small), jnp.array(hidden))
    np.testing.assert_allclose(got / small, gain, rtol=0.01)


def test_every_view_of_foam_keeps_the_bounds_and_the_coverage_without_masking():
    coverage = jnp.linspace(0.0, 1.0, 11)
    for view in (EvenFoam(), CrestFoam(5.0), CrestFoam(0.2), FlatFoam()):
        np.testing.assert_allclose(view(coverage, jnp.zeros(11)), coverage, rtol=1e-12)
        for hidden in (0.5, 50.0):
            seen = view(coverage, jnp.full(11, hidden))
            assert np.all((seen >= 0) & (seen <= 1))
            assert np.all(np.diff(seen) > 0)


def test_flat_foam_fades_by_the_masking_function_and_foam_on_crests_grows():
    coverage, hidden = jnp.array(0.1), jnp.array(3.0)
    np.testing.assert_allclose(FlatFoam()(coverage, hidden), 0.1 / 4)
    np.testing.assert_allclose(EvenFoam()(coverage, hidden), CrestFoam(1.0)(coverage, hidden), rtol=1e-6)
    assert CrestFoam(4.0)(coverage, hidden) > 0.1 > CrestFoam(0.5)(coverage, hidden)


def test_derivatives_match_differences_and_are_finite_at_the_ends():
    def seen(preference):
        return CrestFoam(preference)(jnp.array(0.2), jnp.array(0.8))

    assert_derivative_matches(seen, 2.0)
    assert_derivative_matches(lambda w: CrestFoam(2.0)(w, jnp.array(0.8)), 0.2)
    assert_derivative_matches(lambda h: FlatFoam()(jnp.array(0.2), h), 0.8)
    assert_derivative_matches(lambda t: AgeingFoam().reflectance(jnp.reshape(t, (1,)))[0, 0], 2.0)
    assert_derivative_matches(lambda t: AgeingFoam(fading_time=t).reflectance()[0], 2.0)
    for view in (CrestFoam(2.0), FlatFoam()):
        for coverage in (0.0, 1.0):
            assert np.isfinite(jax.grad(lambda w, v=view: v(w, jnp.array(2.0)))(jnp.array(coverage)))


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Foam(1.2), "brightness"),
        (lambda: Foam(colour=(1.0, -1.0, 0.0)), "colour"),
        (lambda: AgeingFoam(fading_time=0.0), "fading_time"),
        (lambda: CrestFoam(0.0), "preference"),
    ],
)
def test_impossible_foam_is_refused(build, words):
    with pytest.raises(ValueError, match=words):
        build()
