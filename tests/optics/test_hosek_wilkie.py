"""The clear sky against mitsuba 3, its limits, and its derivatives.

The reference numbers come from mitsuba 3.9.1, variants `scalar_rgb` and `scalar_spectral`:

    emitter = mi.load_dict({"type": "sunsky", "turbidity": T, "albedo": …, "sun_direction": …, "sun_scale": 0.0})
    interaction = mi.SurfaceInteraction3f(); interaction.wi = -mi.Vector3f(direction)
    interaction.wavelengths = […]  # scalar_spectral only
    emitter.eval(interaction)

with the albedo {"type": "rgb", "value": [a, a, a]} or {"type": "uniform", "value": a}.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

from jaxocean.optics import luminance
from jaxocean.optics.sky import SUN_RADIUS, ConstantSky, HosekWilkie, ImageSky, SpectralHosekWilkie

SUN_AZIMUTH = 0.5

# turbidity, albedo, sun elevation, zenith angle and azimuth of the view; red, green, blue
COLOURS = [
    ((1.0, 0.0, 0.6, 0.2, 1.9), (0.0116303, 0.0259534, 0.0578538)),
    ((1.0, 0.0, 0.6, 1.45, 0.9), (0.10771, 0.170336, 0.23342)),
    ((2.5, 0.06, 0.15, 0.2, 1.9), (0.00782992, 0.015465, 0.0264235)),
    ((2.5, 0.06, 0.15, 1.45, 0.9), (0.192179, 0.180221, 0.122279)),
    ((3.0, 0.3, 1.2, 0.2, 1.9), (0.054837, 0.0765187, 0.128102)),
    ((3.0, 0.3, 1.2, 1.45, 0.9), (0.128671, 0.192684, 0.284613)),
    ((6.4, 0.5, 0.02, 0.2, 1.9), (0.00490213, 0.00672363, 0.0080191)),
    ((6.4, 0.5, 0.02, 1.45, 0.9), (0.086151, 0.0453666, 0.0184519)),
    ((10.0, 1.0, 1.5, 0.2, 1.9), (0.806355, 0.758615, 0.706553)),
    ((10.0, 1.0, 1.5, 1.45, 0.9), (0.305073, 0.303581, 0.310699)),
]
# the same, at 380, 500, 555 and 690 nm
SPECTRA = [
    ((1.0, 0.0, 0.6, 1.45, 0.9), (0.13648, 0.226104, 0.15825, 0.067528)),
    ((2.5, 0.06, 0.15, 0.2, 1.9), (0.0192623, 0.0226057, 0.0142804, 0.00500048)),
    ((6.4, 0.5, 0.02, 1.45, 0.9), (0.00706974, 0.0369604, 0.0491999, 0.0800263)),
]


def towards(zenith: float, azimuth: float) -> jax.Array:
    return jnp.array([np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)])


@jax.jit
def colour(parameters, direction):
    return HosekWilkie(*parameters, SUN_AZIMUTH).radiance(direction)


@jax.jit
def spectrum(parameters, direction):
    sky = SpectralHosekWilkie(*parameters, SUN_AZIMUTH)
    return (
        sky.spectral_radiance(direction, jnp.array([380.0, 500.0, 555.0, 690.0])),
        sky.spectral_sun_irradiance(jnp.array([400.0, 500.0, 680.0])),
    )


@pytest.mark.parametrize(("case", "expected"), COLOURS)
def test_the_dome_has_the_colours_that_mitsuba_gives(case, expected):
    found = colour(jnp.array(case[:3]), towards(*case[3:]))
    np.testing.assert_allclose(found, expected, rtol=2e-5)


@pytest.mark.parametrize(("case", "expected"), SPECTRA)
def test_the_dome_has_the_spectrum_that_mitsuba_gives(case, expected):
    found, _ = spectrum(jnp.array(case[:3]), towards(*case[3:]))
    np.testing.assert_allclose(found, expected, rtol=2e-5)


@pytest.mark.parametrize(
    ("turbidity", "degrees", "expected"),
    [
        (2.0, 20.0, (0.268694, 0.872402, 1.02743)),
        (5.0, 41.0, (0.466357, 1.02791, 1.01827)),
        (9.0, 68.0, (0.485818, 0.924305, 0.885366)),
    ],
)
def test_the_beam_is_that_of_mitsubas_spectral_sun(turbidity, degrees, expected):
    # Mitsuba spreads one mean radiance over the disc, 0.1 to 0.2 % below the exact mean, and interpolates it between
    # elevations 3° apart, of which these are three.
    _, found = spectrum(jnp.array([turbidity, 0.1, np.radians(degrees)]), towards(0.0, 0.0))
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_the_dome_is_mitsubas_over_the_whole_range_of_the_model():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    random = np.random.default_rng(3)
    for turbidity, albedo, elevation in random.uniform([1, 0, 0.01], [10, 1, np.pi / 2], (40, 3)):
        sky = HosekWilkie(turbidity, albedo, elevation, -0.8)
        emitter = mitsuba.load_dict(
            {
                "type": "sunsky",
                "turbidity": turbidity,
                "albedo": {"type": "rgb", "value": [albedo] * 3},
                "sun_direction": np.asarray(sky.sun_direction).tolist(),
                "sun_scale": 0.0,
            }
        )
        directions = random.normal(size=(20, 3))
        directions[:, 2] = np.abs(directions[:, 2])
        directions = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(np.float32)
        expected = []
        for direction in directions.tolist():
            interaction = mitsuba.SurfaceInteraction3f()
            interaction.wi = -mitsuba.Vector3f(*direction)
            expected.append(np.array(emitter.eval(interaction)))
        found = colour(jnp.array([turbidity, albedo, elevation]), jnp.asarray(_turn(directions), jnp.float64))
        np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-7)


def _turn(directions: np.ndarray) -> np.ndarray:
    """From a sun at azimuth −0.8 to the one of `colour`."""
    angle = SUN_AZIMUTH + 0.8
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    return directions.astype(np.float64) @ turn.T


def test_colour_and_spectrum_tell_of_the_same_sky():
    plain, spectral = HosekWilkie(3.0, 0.1, 0.7), SpectralHosekWilkie(3.0, 0.1, 0.7)
    ground, same = (eqx.filter_jit(lambda sky: sky.irradiance())(sky) for sky in (plain, spectral))
    np.testing.assert_allclose(luminance(ground), luminance(same), rtol=0.02)
    np.testing.assert_allclose(ground, same, rtol=0.06)
    np.testing.assert_allclose(plain.sun_irradiance, spectral.sun_irradiance, rtol=1e-12)


def _clear(elevation):
    return HosekWilkie(2.5, 0.1, elevation, 0.4)


def _constant(elevation):
    return ConstantSky(0.1, (1.0, 0.8, 0.5), elevation, 0.4)


def _image(elevation):
    return ImageSky(np.ones((4, 8, 3)), 0.3, 2.0, (1.0, 0.8, 0.5), elevation, 0.4)


@pytest.mark.parametrize("elevation", [0.7, 0.05, 0.002, -0.003])
@pytest.mark.parametrize("kind", [_clear, _constant, _image])
def test_the_beam_is_the_integral_of_the_disc_above_the_horizon(kind, elevation):
    sky = kind(elevation)
    side = np.linspace(-1.0, 1.0, 601) * SUN_RADIUS * 1.01
    up, across = np.meshgrid(side, side, indexing="ij")
    sun = np.asarray(sky.sun_direction)
    right = np.array([-np.sin(0.4), np.cos(0.4), 0.0])
    above = np.cross(sun, right)
    directions = sun + across[..., None] * right + up[..., None] * above
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    brute = np.sum(np.asarray(_disc(sky, jnp.asarray(directions))), axis=(0, 1))
    np.testing.assert_allclose(sky.sun_irradiance, brute * (side[1] - side[0]) ** 2, rtol=2e-3)


@pytest.mark.parametrize("kind", [_clear, _constant, _image])
def test_the_disc_ends_at_its_edge_and_is_dark_below_the_horizon(kind):
    sky = kind(0.3)
    offsets = SUN_RADIUS * np.array([0.0, 0.98, 1.02])
    directions = jnp.stack([towards(np.pi / 2 - 0.3 - offset, 0.4) for offset in offsets])
    inside, edge, beside = _disc(sky, directions)
    assert np.all(inside >= edge)
    assert np.all(edge > 0.0)
    np.testing.assert_array_equal(beside, 0.0)
    np.testing.assert_array_equal(_disc(kind(-0.3), towards(np.pi / 2 + 0.3, 0.4)), 0.0)
    slopes = jax.jit(jax.vmap(jax.jacfwd(sky.sun_radiance)))(jnp.stack([*directions, -directions[0]]))
    assert np.all(np.isfinite(slopes))


def test_the_spectral_sun_darkens_towards_its_limb_by_the_tabulated_law():
    sky = SpectralHosekWilkie(2.5, 0.1, 0.8)
    offsets = SUN_RADIUS * np.array([0.0, 0.6, 0.8])
    sideways = [towards(np.pi / 2 - 0.8, offset / np.cos(0.8)) for offset in offsets]
    found = sky.spectral_sun_radiance(jnp.stack(sideways), jnp.array([480.0]))[:, 0]
    # cos ψ = 1, 0.8 and 0.6; the coefficients are those of Hošek & Wilkie (2013) at 480 nm.
    law = np.polynomial.Polynomial([0.198587, 1.30507, -1.25998, 1.49727, -1.04047, 0.299516])
    np.testing.assert_allclose(found / found[0], law([1.0, 0.8, 0.6]) / law(1.0), rtol=1e-3)


def test_the_full_beam_at_noon_is_of_daylight_strength():
    # 683 lm/W times the integral of the observer's sensitivity; direct sun at sea level is 80 to 110 thousand lux.
    beam = 683.0 * 106.857 * float(luminance(HosekWilkie(2.5, 0.06, 1.3).sun_irradiance))
    assert 8e4 < beam < 1.1e5


def test_the_irradiance_is_the_integral_of_the_radiance():
    for elevation in (0.05, 0.7, 1.4):
        sky = HosekWilkie(4.0, 0.2, elevation, 1.1)
        z, weight = np.polynomial.legendre.leggauss(200)
        z, weight = 0.5 * (z + 1.0), 0.5 * weight
        around = 2.0 * np.pi * np.arange(240) / 240
        flat = np.sqrt(1.0 - z * z)[:, None]
        nodes = np.stack([flat * np.cos(around), flat * np.sin(around), z[:, None] + 0.0 * around], axis=-1)
        radiance = np.asarray(_radiance(sky, jnp.asarray(nodes)))
        expected = np.sum(radiance * (z * weight)[:, None, None], axis=(0, 1)) * 2.0 * np.pi / 240
        np.testing.assert_allclose(_irradiance(sky), expected, rtol=5e-5)


_radiance = eqx.filter_jit(HosekWilkie.radiance)
_irradiance = eqx.filter_jit(HosekWilkie.irradiance)


@eqx.filter_jit
def _disc(sky, direction):
    return sky.sun_radiance(direction)


def test_below_the_horizon_one_sees_the_mirrored_sky():
    sky = HosekWilkie(3.0, 0.1, 0.4, 0.2)
    down = jnp.array([[0.6, 0.0, -0.8], [0.8, 0.6, 0.0], [0.0, 0.0, -1.0]])
    found = _radiance(sky, down)
    np.testing.assert_array_equal(found, _radiance(sky, down * jnp.array([1.0, 1.0, -1.0])))
    assert np.all(np.isfinite(found))


def test_the_sky_turns_with_the_sun():
    direction = towards(0.8, 1.7)
    turned = _radiance(HosekWilkie(3.0, 0.1, 0.4, 2.2), towards(0.8, 1.7 + 2.0))
    np.testing.assert_allclose(turned, _radiance(HosekWilkie(3.0, 0.1, 0.4, 0.2), direction), rtol=1e-9)


def test_after_sunset_the_sky_darkens_steadily_to_night_and_is_never_nan():
    elevations = -np.radians(np.linspace(0.0, 90.0, 361))
    light, beam = _light_and_beam(jnp.asarray(elevations))
    assert np.all(np.diff(light) <= 1e-9 * light[0])
    assert np.all(light > 0)
    np.testing.assert_allclose(light[24] / light[0], 10 ** (0.533 - 2.88), rtol=0.2)
    assert light[-1] < 2e-6 * light[0]
    np.testing.assert_array_equal(beam[2:], 0.0)


@jax.jit
@jax.vmap
def _light_and_beam(elevation):
    sky = HosekWilkie(3.0, 0.06, elevation)
    return luminance(sky.irradiance()), sky.sun_irradiance


def _everything(x):
    """One number that depends on all that a sky answers."""
    sky = HosekWilkie(x[0], x[1], x[2], x[3])
    directions = jnp.stack([towards(0.3, 1.0), towards(1.4, 0.4), towards(1.5, -2.0)])
    light = sky.radiance(directions).sum(0) + sky.sun_irradiance
    return light @ jnp.array([1.0, 0.7, -0.4])


def test_derivatives_in_turbidity_albedo_and_the_suns_place_match_finite_differences():
    points = [[2.3, 0.1, 0.8, 0.3], [7.7, 0.6, 0.21, -1.0], [3.4, 0.3, -0.06, 2.0]]
    assert_gradient_matches(_everything, points, rtol=2e-5, atol=1e-9, step=1e-5)


@pytest.mark.parametrize(
    "elevation", [0.0, 1e-5, 1e-4, SUN_RADIUS, -SUN_RADIUS, -np.radians(18.0), np.pi / 2]
)
@pytest.mark.parametrize("turbidity", [1.0, 4.0, 10.0])
def test_derivatives_are_finite_at_knots_and_at_the_horizon(elevation, turbidity):
    gradient = GRADIENT(jnp.array([turbidity, 0.0, elevation, 0.0]))
    assert np.all(np.isfinite(gradient)), gradient


GRADIENT = jax.jit(jax.grad(_everything))


def test_the_derivative_in_the_direction_is_finite_at_sun_horizon_and_zenith():
    sky = HosekWilkie(3.0, 0.1, 0.6, 0.3)
    special = [sky.sun_direction, -sky.sun_direction, towards(np.pi / 2, 1.0), towards(0.0, 0.0)]
    jacobian = jax.jit(jax.vmap(jax.jacfwd(sky.radiance)))(jnp.stack([*special, jnp.array([1.0, 0.0, 0.0])]))
    assert np.all(np.isfinite(jacobian))


def test_the_dome_keeps_the_precision_of_the_directions():
    sky = HosekWilkie(jnp.float32(3.0), jnp.float32(0.1), jnp.float32(0.6), jnp.float32(0.3))
    direction = towards(1.2, 0.4)
    single = _radiance(sky, direction.astype(jnp.float32))
    assert single.dtype == jnp.float32
    np.testing.assert_allclose(single, _single(direction), rtol=2e-5)
    for answer in eqx.filter_eval_shape(lambda s: (s.irradiance(), s.sun_irradiance, s.sun_direction), sky):
        assert answer.dtype == jnp.float32


def _single(direction):
    sky = HosekWilkie(3.0, 0.1, 0.6, 0.3)
    return _radiance(sky, direction)


def test_skies_are_batched_by_vmap():
    parameters = jnp.array([[3.0, 0.1, 0.1], [3.0, 0.1, 0.5], [2.0, 0.2, 0.9]])
    batch = jax.jit(jax.vmap(colour, in_axes=(0, None)))(parameters, towards(1.0, 0.2))
    for one, found in zip(parameters, batch, strict=True):
        np.testing.assert_allclose(found, colour(one, towards(1.0, 0.2)), rtol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"turbidity": 0.5}, "`turbidity` must be at least 1"),
        ({"turbidity": 11.0}, "`turbidity` must be at most 10"),
        ({"albedo": 1.2}, "`albedo` must lie between 0 and 1"),
        ({"albedo": np.ones(4)}, "`albedo` must be one number or 3"),
        ({"sun_elevation": 2.0}, "`sun_elevation` must be at most"),
        ({"sun_azimuth": np.nan}, "`sun_azimuth` must be finite"),
    ],
)
def test_parameters_outside_of_the_model_are_refused_in_words(wrong, message):
    with pytest.raises(ValueError, match=message):
        HosekWilkie(**wrong)
