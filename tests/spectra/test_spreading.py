"""Directional spreading laws."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_derivative_matches
from scipy import integrate
from wavespectra.construct.direction import cartwright

import jaxocean as jo
from jaxocean import spectra as sp
from jaxocean.spectra import WavePeak

LAWS = {
    "constant s": lambda: sp.Cosine2s(7.3),
    "Mitsuyasu": lambda: sp.Mitsuyasu(10.0),
    "Mitsuyasu, old swell": lambda: sp.Mitsuyasu(75.0),
    "Hasselmann": sp.Hasselmann1980,
    "Donelan–Banner": sp.DonelanBanner,
    "Elfouhaily": lambda: sp.ElfouhailySpreading(jo.Wind(10.0)),
}
RATIOS = np.array([0.05, 0.5, 0.8, 0.96, 1.0, 1.3, 1.7, 4.0, 30.0])
ANGLES = np.linspace(-np.pi, np.pi, 20001)
every_law = pytest.mark.parametrize("name", LAWS)


def waves(ratio, peak_speed=12.0):
    """Deep-water waves at `ratio` times the peak frequency."""
    ratio = jnp.asarray(ratio)
    speed = jnp.asarray(peak_speed, ratio.dtype)
    return WavePeak(ratio, 9.81 * (ratio / speed) ** 2, speed)


def density(law, ratio, angles=ANGLES):
    angle, r = jnp.broadcast_arrays(jnp.asarray(angles), jnp.asarray(ratio)[..., None])
    return np.asarray(law.density(angle, waves(r)))


@every_law
def test_all_energy_goes_somewhere(name):
    d = density(LAWS[name](), RATIOS)
    assert np.all(d >= 0)
    # The narrow notch of a nearly isotropic cos²ˢ at θ = π is what limits this sum.
    np.testing.assert_allclose(np.trapezoid(d, ANGLES, axis=1), 1.0, rtol=1e-4)
    np.testing.assert_allclose(np.trapezoid(d[1:7], ANGLES, axis=1), 1.0, rtol=3e-7)


@every_law
def test_harmonics_are_the_cosine_moments_of_the_density(name):
    law = LAWS[name]()
    second, fourth = law.harmonics(waves(RATIOS))
    for i in (2, 6):  # an adaptive rule for two of them

        def integrand(theta, n, ratio=RATIOS[i]):
            return float(density(law, np.array([ratio]), np.array([theta]))[0, 0]) * np.cos(n * theta)

        for n, harmonic in ((2, second), (4, fourth)):
            exact = 2 * integrate.quad(integrand, 0, np.pi, args=(n,), epsabs=1e-9)[0]
            np.testing.assert_allclose(harmonic[i], exact, atol=1e-8)
    d = density(law, RATIOS)
    np.testing.assert_allclose(second, np.trapezoid(d * np.cos(2 * ANGLES), ANGLES, axis=1), atol=1e-4)
    np.testing.assert_allclose(fourth, np.trapezoid(d * np.cos(4 * ANGLES), ANGLES, axis=1), atol=1e-4)


@every_law
def test_the_mean_direction_is_an_axis_of_symmetry_and_turns_are_periods(name):
    law = LAWS[name]()
    angles = np.linspace(0.1, 3.0, 12)
    d = density(law, RATIOS, angles)
    np.testing.assert_allclose(d, density(law, RATIOS, -angles), rtol=1e-12)
    np.testing.assert_allclose(d, density(law, RATIOS, angles + 4 * np.pi), rtol=1e-9)


@every_law
def test_laws_stay_finite_in_float32_with_finite_derivatives(name):
    with jax.enable_x64(False):
        law = LAWS[name]()
        ratio = jnp.asarray([1e-3, 0.1, 1.0, 3.0, 300.0], jnp.float32)[:, None]
        angle = jnp.asarray([0.0, 1.0, np.pi, -np.pi, 7.0], jnp.float32)
        angle, ratio = jnp.broadcast_arrays(angle, ratio)

        def total(law, angle, ratio):
            return jnp.sum(law.density(angle, waves(ratio)))

        value, gradients = jax.jit(jax.value_and_grad(total, argnums=(0, 1, 2)))(law, angle, ratio)
        assert value.dtype == jnp.float32
        assert np.isfinite(float(value))
        assert all(bool(jnp.all(jnp.isfinite(g))) for g in jax.tree.leaves(gradients))
        assert all(bool(jnp.all(jnp.isfinite(h))) for h in law.harmonics(waves(ratio)))


@pytest.mark.parametrize("s", [0.3, 2.0, 15.0, 74.0])
def test_a_beam_of_constant_s_is_the_one_of_an_independent_implementation(s):
    # That of Cartwright takes the spread σ = √(2/(s + 1)) in degrees.
    degrees = np.arange(0.25, 360.0, 0.5)  # 180° itself is a notch where s is small
    expected = cartwright(degrees, 0.0, np.rad2deg(np.sqrt(2 / (s + 1)))).values * (180 / np.pi)
    d = density(sp.Cosine2s(s), np.array([1.0]), np.deg2rad(degrees))[0]
    np.testing.assert_allclose(d, expected, rtol=2e-3, atol=1e-9)


def test_the_beam_is_narrowest_at_the_peak():
    ratios = np.array([0.5, 0.7, 0.9, 1.0, 1.2, 1.6, 2.5])
    second, _ = sp.Mitsuyasu().harmonics(waves(ratios))
    assert list(np.argsort(second))[-1] == 3
    # s = 10 · 0.5⁵ and 10 · 2.5^−2.5 at the ends
    for i, s in ((0, 10 * 0.5**5), (-1, 10 * 2.5**-2.5)):
        np.testing.assert_allclose(second[i], s * (s - 1) / ((s + 1) * (s + 2)), rtol=1e-12)


def test_published_parameters_of_the_measured_laws():
    # Hasselmann 1980: s = 6.97 r^4.06 below the peak, 9.77 r^−2.33 above at U/c_p = 1.17.
    for r, s in ((0.8, 6.97 * 0.8**4.06), (1.5, 9.77 * 1.5**-2.33)):
        expected = density(sp.Cosine2s(s), np.array([1.0]))
        np.testing.assert_allclose(density(sp.Hasselmann1980(), np.array([r])), expected, rtol=1e-9)
    old, young = (sp.Hasselmann1980(age).harmonics(waves(np.array([2.0])))[0] for age in (0.84, 3.0))
    assert float(old[0]) > float(young[0])
    # Donelan–Banner at θ = 0: β/(2 tanh βπ), and its branches meet at 1.6.
    beta = 2.28 * 1.3**-1.3
    value = density(sp.DonelanBanner(), np.array([1.3]), np.array([0.0]))[0, 0]
    np.testing.assert_allclose(value, beta / (2 * np.tanh(beta * np.pi)), rtol=1e-12)
    below, above = density(sp.DonelanBanner(), np.array([1.599999, 1.600001]), np.array([0.0]))[:, 0]
    np.testing.assert_allclose(below, above, rtol=1e-4)


def test_elfouhailys_spreading_is_the_models_own():
    own = sp.Elfouhaily(jo.Wind(9.0, 0.4), 1.1)
    given = sp.Elfouhaily(jo.Wind(9.0, 0.4), 1.1, spreading=sp.ElfouhailySpreading(jo.Wind(9.0)))
    k = jnp.asarray([0.1, 3.0, 370.0])
    phi = jnp.asarray([0.3, 1.4, 2.0])
    np.testing.assert_allclose(given.density(k, phi), own.density(k, phi), rtol=1e-12)
    # Upwind-crosswind ratio at the slowest wave: Δ = tanh(ln2/4 + 4(c_m/c_p)^2.5 + 0.13 u*/c_m).
    _, wave = own._spreading(jnp.asarray([370.0]))
    second, _ = sp.ElfouhailySpreading(jo.Wind(9.0)).harmonics(wave)
    c = np.sqrt(9.81 / 370 * 2)
    friction = float(jo.Wind(9.0).friction_velocity(1.1))
    argument = np.log(2) / 4 + 4 * (c * 1.1 / 9) ** 2.5 + 0.13 * friction / 0.23 * (0.23 / c) ** 2.5
    np.testing.assert_allclose(second[0], 0.5 * np.tanh(argument), rtol=1e-12)


def test_parameters_are_differentiable():
    one = lambda law, r=0.7: law.density(jnp.asarray(0.8), waves(r)) + sum(law.harmonics(waves(r)))
    assert_derivative_matches(lambda s: one(sp.Cosine2s(s)), 4.0)
    assert_derivative_matches(lambda s: one(sp.Mitsuyasu(s)), 12.0)
    assert_derivative_matches(lambda age: one(sp.Hasselmann1980(age), 1.8), 1.3)
    assert_derivative_matches(lambda r: one(sp.DonelanBanner(), r), 1.2)
    assert_derivative_matches(lambda u: one(sp.ElfouhailySpreading(jo.Wind(u)), 40.0), 11.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sp.Cosine2s(-1.0), "`s` must be at least 0, but is -1"),
        (lambda: sp.Mitsuyasu(float("nan")), "`s_max` must be finite"),
        (lambda: sp.Hasselmann1980(0.0), "`inverse_wave_age` must be greater than 0, but is 0"),
    ],
)
def test_impossible_spreadings_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()
