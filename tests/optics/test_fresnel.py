"""Fresnel's equations against a thin-film program and against limits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import tmm
from _derivatives import assert_derivative_matches

from jaxocean.optics import ExactFresnel, SchlickFresnel, fresnel, schlick

ANGLES = np.radians([0.0, 10.0, 33.0, 53.27, 70.0, 85.0, 89.5])


def oracle(index: complex, angle: float, near: float = 1.0) -> float:
    """Power reflectance of unpolarised light by tmm, whose extinction is positive."""
    refracted = tmm.snell(near, index, angle)
    return float(sum(tmm.interface_R(p, near, index, angle, refracted) for p in "sp") / 2)


@pytest.mark.parametrize("index", [1.34, 1.5, 2.4])
def test_a_clear_interface_reflects_what_tmm_says(index):
    expected = [oracle(index, angle) for angle in ANGLES]
    np.testing.assert_allclose(fresnel(jnp.cos(ANGLES), index), expected, rtol=1e-12)


@pytest.mark.parametrize("index", [1.33 + 0.1j, 0.2 + 3.4j, 1.34 + 0.0j])
def test_an_absorbing_interface_reflects_what_tmm_says(index):
    expected = [oracle(index, angle) for angle in ANGLES]
    np.testing.assert_allclose(fresnel(jnp.cos(ANGLES), index), expected, rtol=1e-12)
    np.testing.assert_allclose(fresnel(jnp.cos(ANGLES), np.conj(index)), expected, rtol=1e-12)
    layer = ExactFresnel(index.real, extinction=index.imag)
    np.testing.assert_allclose(layer(jnp.cos(ANGLES)), expected, rtol=1e-12)


def test_from_below_light_is_reflected_totally_beyond_the_critical_angle():
    critical = np.arcsin(1 / 1.34)
    angles = np.array([0.2, 0.95 * critical, 1.01 * critical, 1.3])
    expected = [oracle(1.0, angle, near=1.34) for angle in angles]
    got = fresnel(jnp.cos(angles), 1 / 1.34)
    np.testing.assert_allclose(got, expected, rtol=1e-10)
    np.testing.assert_array_equal(got[2:], 1.0)


def test_sea_water_reflects_two_percent_from_above_and_all_at_grazing_incidence():
    np.testing.assert_allclose(fresnel(jnp.array(1.0), 1.34), (0.34 / 2.34) ** 2, rtol=1e-12)
    np.testing.assert_allclose(fresnel(jnp.array(1.0), 1.34), 0.021, atol=2e-4)
    np.testing.assert_allclose(fresnel(jnp.array(0.0), 1.34), 1.0, rtol=1e-12)


def test_at_brewsters_angle_only_one_polarisation_is_reflected():
    n = 1.34
    np.testing.assert_allclose(
        fresnel(jnp.cos(jnp.arctan(n)), n), 0.5 * ((n * n - 1) / (n * n + 1)) ** 2, rtol=1e-12
    )


def test_a_film_of_air_is_invisible():
    np.testing.assert_allclose(fresnel(jnp.linspace(0.05, 1.0, 9), 1.0), 0.0, atol=1e-15)


def test_single_precision_follows_double():
    cosines = np.linspace(0.0, 1.0, 1001)
    single = fresnel(jnp.asarray(cosines, jnp.float32), 1.34)
    assert single.dtype == jnp.float32
    np.testing.assert_allclose(single, fresnel(jnp.asarray(cosines), 1.34), rtol=3e-5)


def test_reflectance_stays_between_zero_and_one_for_any_index():
    cosines, indices = np.meshgrid(np.linspace(-0.1, 1.1, 61), np.geomspace(0.3, 5.0, 41))
    for index in (indices, indices + 0.7j):
        got = fresnel(jnp.asarray(cosines), jnp.asarray(index))
        assert np.all((got >= 0) & (got <= 1 + 1e-12))


def test_schlick_has_the_ends_of_the_exact_law_and_stays_near_it():
    cosines = jnp.linspace(0.0, 1.0, 101)
    np.testing.assert_allclose(schlick(cosines, 0.02)[jnp.array([0, -1])], [1.0, 0.02], rtol=1e-12)
    np.testing.assert_allclose(SchlickFresnel(0.0211)(cosines), fresnel(cosines, 1.34), atol=0.06)


@pytest.mark.parametrize("cosine", [0.02, 0.4, 0.9])
def test_derivatives_match_differences(cosine):
    assert_derivative_matches(lambda c: fresnel(c, 1.34), cosine)
    assert_derivative_matches(lambda n: fresnel(jnp.array(cosine), n), 1.34)
    assert_derivative_matches(lambda k: ExactFresnel(1.34, extinction=k)(jnp.array(cosine)), 0.3)
    assert_derivative_matches(lambda f: schlick(jnp.array(cosine), f), 0.02)


def test_derivatives_are_finite_at_grazing_and_normal_incidence_and_past_the_critical_angle():
    for cosine in (0.0, 1.0):
        for law in (lambda c: fresnel(c, 1.34), lambda c: fresnel(c, 1 / 1.34), lambda c: schlick(c, 0.02)):
            assert np.isfinite(jax.grad(law)(jnp.array(cosine)))


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: ExactFresnel(0.0), "refractive_index"),
        (lambda: ExactFresnel(1.3, extinction=-1.0), "extinction"),
        (lambda: SchlickFresnel(1.2), "normal_reflectance"),
    ],
)
def test_impossible_interfaces_are_refused(build, words):
    with pytest.raises(ValueError, match=words):
        build()
