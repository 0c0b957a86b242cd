"""The colour of the sea against what satellites take it for, and its limits."""

import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from scipy.integrate import quad

from jaxocean.optics import ConstantWater, ExactFresnel, SchlickFresnel, Water, fresnel
from jaxocean.optics._sea_water import WAVELENGTHS
from jaxocean.optics._water import diffuse_reflectance
from jaxocean.optics.sky import ConstantSky


def remote_sensing_reflectance(water: Water) -> np.ndarray:
    """Water-leaving radiance per irradiance above the surface [1/sr], seen from the zenith."""
    return np.asarray(water.spectral_reflectance()) * (1 - 0.0211) * 0.96


@pytest.mark.parametrize("chlorophyll", [0.05, 0.2, 0.8, 3.0])
def test_satellites_would_find_the_chlorophyll_that_was_put_in(chlorophyll):
    """OC4v4 (O'Reilly et al. 2000), an empirical law from ship data, reads our spectrum within a factor of 1.6."""
    bands = dict(zip(WAVELENGTHS, remote_sensing_reflectance(Water(chlorophyll)), strict=True))
    green = np.interp(555.0, list(bands), list(bands.values()))
    ratio = np.log10(max(bands[440.0], bands[490.0], bands[510.0]) / green)
    found = 10 ** (0.366 - 3.067 * ratio + 1.930 * ratio**2 + 0.649 * ratio**3 - 1.532 * ratio**4)
    assert 1 / 1.6 < found / chlorophyll < 1.6


def test_clear_water_is_blue_and_rich_water_is_green():
    clear, rich = (np.asarray(Water(c).radiance_reflectance()) for c in (0.03, 5.0))
    assert clear[2] > 2 * clear[1] > clear[0]
    assert rich[1] > 1.1 * rich[2]
    assert rich[1] > 1.5 * rich[0]
    # Clear ocean reflects a few per cent of the irradiance in the blue (Morel & Maritorena 2001: about 5 %).
    blue = np.pi * Water(0.03).spectral_reflectance()[4]
    assert 0.02 < blue < 0.08


def test_half_of_what_goes_in_comes_out_at_most():
    for chlorophyll in (0.01, 1.0, 30.0, 300.0):
        spectrum = Water(chlorophyll).spectral_reflectance()
        assert np.all((spectrum > 0) & (np.pi * spectrum < 0.5))


def test_what_a_flat_sea_reflects_of_a_uniform_sky_is_the_integral_of_fresnels_law():
    expected = quad(lambda c: 2 * c * float(fresnel(jnp.array(c), 1.34)), 0, 1, epsabs=1e-9)[0]
    got = diffuse_reflectance(ExactFresnel(), jnp.dtype(jnp.float64))
    np.testing.assert_allclose(got, expected, rtol=1e-6)
    np.testing.assert_allclose(
        diffuse_reflectance(SchlickFresnel(0.02), got.dtype), 0.02 + 0.98 / 21, rtol=1e-9
    )


def test_water_glows_with_what_the_surface_lets_through():
    water, law = Water(0.3), ExactFresnel()
    dome = ConstantSky(1.0)
    got = water.radiance(dome, law)
    through = 1 - diffuse_reflectance(law, jnp.dtype(jnp.float64))
    np.testing.assert_allclose(got, water.radiance_reflectance() * np.pi * through, rtol=1e-10)
    sun = ConstantSky(0.0, sun=2.0, sun_elevation=0.5)
    expected = 2 * np.sin(0.5) * (1 - fresnel(jnp.sin(0.5), 1.34)) * water.radiance_reflectance()
    np.testing.assert_allclose(water.radiance(sun, law), expected, rtol=1e-10)


def test_the_papers_water_is_a_paint():
    got = ConstantWater().radiance(ConstantSky(1.0), ExactFresnel())
    np.testing.assert_allclose(got, np.array([11, 121, 49]) / 255 * 140 / 255, rtol=1e-6)


def test_paint_is_lit_by_the_sun_unless_it_is_said_not_to_be():
    dusk, sunny = ConstantSky(1.0), ConstantSky(1.0, sun=3.0, sun_elevation=0.5)
    lit, papers = ConstantWater(0.4), ConstantWater(0.4, sunlit=False)
    np.testing.assert_allclose(
        lit.radiance(sunny, ExactFresnel()), 0.4 + 0.4 * 3 * np.sin(0.5) / np.pi, rtol=1e-6
    )
    np.testing.assert_allclose(
        papers.radiance(sunny, ExactFresnel()), papers.radiance(dusk, ExactFresnel()), rtol=1e-6
    )


@pytest.mark.parametrize("kind", [Water(), ConstantWater()])
def test_water_is_dark_when_the_sun_is_down(kind):
    night = ConstantSky(0.0, sun=5.0, sun_elevation=-0.2)
    np.testing.assert_array_equal(kind.radiance(night, ExactFresnel()), 0.0)


def test_derivatives_match_differences():
    weights = jnp.array([1.0, -0.4, 0.3])
    assert_derivative_matches(lambda c: Water(c).radiance_reflectance() @ weights, 0.3)
    assert_derivative_matches(
        lambda n: Water(0.3, refractive_index=n).radiance(ConstantSky(1.0), ExactFresnel(n)) @ weights, 1.34
    )


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Water(0.0), "chlorophyll"),
        (lambda: Water(refractive_index=0.9), "refractive_index"),
        (lambda: ConstantWater((0.1, 0.2)), "colour"),
    ],
)
def test_impossible_water_is_refused(build, words):
    with pytest.raises(ValueError, match=words):
        build()
