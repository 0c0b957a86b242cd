"""One sky over many places, each with its own vertical."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean.optics.sky import SUN_RADIUS, ConstantSky, HosekWilkie, LocalSky

SKY = HosekWilkie(3.0, sun_elevation=0.5, sun_azimuth=0.2)


def towards(elevation):
    elevation = jnp.asarray(elevation)
    return jnp.stack([jnp.cos(elevation), 0 * elevation, jnp.sin(elevation)], axis=-1)


def test_where_the_sun_stands_as_it_does_at_home_the_sky_is_the_same():
    local = LocalSky(SKY, jnp.broadcast_to(SKY.sun_direction, (4, 3)))
    direction = towards(np.linspace(0.0, 1.5, 4))
    variance = jnp.full(4, 0.02)
    for found, expected in (
        (local.sun_irradiance, SKY.sun_irradiance),
        (local.irradiance(), SKY.irradiance()),
        (local.radiance(direction), SKY.radiance(direction)),
        (local.lobe_radiance(direction, variance), SKY.lobe_radiance(direction, variance)),
    ):
        assert found.shape == (4, 3)
        np.testing.assert_allclose(found, jnp.broadcast_to(expected, (4, 3)), rtol=1e-9)


@pytest.mark.parametrize("at_home", [0.5, -0.15])
def test_beyond_the_terminator_the_beam_is_gone_and_the_dome_darkens_as_in_twilight(at_home):
    sky = HosekWilkie(3.0, sun_elevation=at_home)
    elevation = np.array([1.2, 0.01, 0.0, -0.01, -np.radians(6.0), -0.5])
    local = LocalSky(sky, towards(elevation))
    dome = np.asarray(local.irradiance())[:, 1]
    np.testing.assert_allclose(dome[1:3], dome[0])
    # Seidelmann: 10^2.88 lux at sunset, 10^0.533 at the end of civil twilight.
    np.testing.assert_allclose(dome[4] / dome[2], 10 ** (0.533 - 2.88), rtol=1e-3)
    assert dome[5] < 1e-5 * dome[0]
    beam = np.asarray(local.sun_irradiance)[:, 1]
    if at_home > 0:
        np.testing.assert_allclose(beam[:3] / float(sky.sun_irradiance[1]), [1, 1, 0.5])
    assert np.all(beam[3:] == 0)


def test_light_on_a_round_planet_goes_out_smoothly_with_finite_derivatives():
    water, foam = jo.optics.Water(), jo.optics.Foam()
    home = ConstantSky(1.0, 5.0, sun_elevation=0.3)
    covariance = jnp.eye(2) * 0.01

    @jax.jit
    @jax.value_and_grad
    def light(elevation):
        sky = LocalSky(home, towards(elevation)[None])
        return jnp.sum(
            jo.optics.surface_radiance(
                towards(1.0)[None], jnp.zeros((1, 2)), covariance[None], jnp.full(1, 0.1), sky, water, foam
            ).total
        )

    found = [light(e) for e in (np.pi / 2, 0.5, SUN_RADIUS, 0.0, -SUN_RADIUS, -0.05, -0.5, -np.pi / 2)]
    values, slopes = np.asarray(found).T
    assert np.all(np.isfinite(slopes))
    assert np.all(np.diff(values[1:7]) < 0)
    assert values[6] < 1e-5 * values[1]
    for e, slope in ((0.5, slopes[1]), (-0.05, slopes[5])):
        np.testing.assert_allclose((light(e + 1e-5)[0] - light(e - 1e-5)[0]) / 2e-5, slope, rtol=1e-5)


def test_each_place_has_its_own_light_whatever_others_are_lit_at_once():
    water, foam = jo.optics.Water(), jo.optics.Foam()
    elevations = np.array([0.9, 0.2])
    view = towards(np.array([1.0, 0.4]))
    for at in range(2):
        # The same sun without a local sky, whose dome and beam do not depend on it.
        alone = ConstantSky(1.0, 5.0, sun_elevation=elevations[at])
        args = jnp.zeros((1, 2)), jnp.eye(2)[None] * 0.02, jnp.full(1, 0.3)
        expected = jo.optics.surface_radiance(view[at][None], *args, alone, water, foam)
        local = LocalSky(ConstantSky(1.0, 5.0), towards(elevations))
        slope, covariance, coverage = (jnp.repeat(each, 2, axis=0) for each in args)
        found = jo.optics.surface_radiance(view, slope, covariance, coverage, local, water, foam)
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_allclose(a[at], b[0], rtol=1e-9)
