"""The ocean: one object whose parts agree with each other, differentiable from wind to coverage."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

import jaxocean as jo

CASCADE = jo.surface.Cascade(sizes=(150.0, 37.0), resolution=64)


def ocean(speed=14.0, choppiness=(1.3, 1.1), threshold=0.5, limit=2.5, *, seed=0):
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed), inverse_wave_age=0.84)
    sea = jo.surface.realise(spectrum, CASCADE, key=jax.random.key(seed))
    return jo.Ocean(sea, choppiness=jnp.asarray(choppiness), threshold=threshold, breaking_wavenumber=limit)


def test_jacobian_at_a_point_is_that_of_the_summed_strain():
    o = ocean()
    p = jnp.array([[3.0, 4.0], [70.0, -20.0]])
    strain = o.sea.strain(p, 1.0, o.choppiness, 2.5)
    np.testing.assert_allclose(o.jacobian(p, 1.0), jo.whitecaps.jacobian(strain), rtol=1e-12)
    np.testing.assert_array_equal(o.whitecaps(p, 1.0), o.jacobian(p, 1.0) < 0.5)


def test_coverage_is_the_mean_of_the_whitecaps_over_many_seas():
    one = jax.jit(
        lambda key: jo.whitecaps.realised_coverage(
            jo.surface.realise(ocean().sea.spectrum, CASCADE, key=key)
            .fields(0.0, jnp.array([1.3, 1.1]), 2.5)
            .strain,
            0.7,
            shifts=4,
        )
    )
    counted = np.asarray(jax.lax.map(one, jax.random.split(jax.random.key(1), 100)))
    expected = float(ocean(threshold=0.7).coverage())
    assert abs(counted.mean() - expected) < 3 * counted.std(ddof=1) / np.sqrt(counted.size)


def test_breaking_wavenumber_defaults_to_what_the_default_cascade_resolves():
    o = jo.Ocean(ocean().sea)
    assert o.breaking_wavenumber is not None
    np.testing.assert_allclose(o.breaking_wavenumber, jo.surface.Cascade().wavenumber_limit)


def test_coverage_is_differentiable_from_the_wind_to_the_whitecaps():
    def coverage(x):
        return ocean(x[0], x[1:3], x[3], x[4]).coverage()

    assert_gradient_matches(coverage, [[14.0, 1.6, 1.4, 0.6, 2.5]], rtol=1e-6, atol=1e-10)


def test_oceans_batch_over_winds():
    speeds = jnp.array([8.0, 12.0, 16.0])
    together = eqx.filter_vmap(lambda u: ocean(u).coverage())(speeds)
    single = jnp.stack([ocean(float(u)).coverage() for u in speeds])
    np.testing.assert_allclose(together, single, rtol=1e-9)


def test_more_choppiness_than_patterns_is_refused():
    with pytest.raises(ValueError, match="one for each of the 2 patterns"):
        ocean(choppiness=(1.0, 1.0, 1.0))


def test_waves_that_no_pattern_holds_may_have_a_spectrum_of_their_own():
    usual = ocean()
    spectrum = usual.sea.spectrum

    def short(factor):
        return jo.Ocean(usual.sea, unresolved=factor * spectrum).unresolved_slopes()

    np.testing.assert_allclose(short(1.0), usual.unresolved_slopes(), rtol=1e-12)
    np.testing.assert_allclose(short(0.25), 0.25 * usual.unresolved_slopes(), rtol=1e-12)
    assert_gradient_matches(lambda x: jnp.sum(short(x[0])), [[0.5]], rtol=1e-6)
    # What the patterns hold, and so foam, does not ask for it.
    np.testing.assert_array_equal(
        jo.Ocean(usual.sea, unresolved=9 * spectrum).coverage(), jo.Ocean(usual.sea).coverage()
    )
