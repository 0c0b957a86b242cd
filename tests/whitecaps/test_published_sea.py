"""The sea of Dupuy & Bruneton's program: against their numbers, its own statistics, and ours."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from tests._derivatives import assert_derivative_matches

SIZES, CHOPPINESS, THRESHOLD = (893.0, 101.0, 21.0, 11.0), (2.3, 2.1, 1.3, 0.9), 0.2


def elfouhaily(logarithm=np.log):
    """Scene 1, with the logarithm that the program takes in the peak enhancement or with the right one."""
    gamma = 1.7 + 6 * logarithm(2.0)
    return 2.0 * jo.spectra.Elfouhaily(jo.Wind(12.0), 2.0, peak_enhancement=gamma)


@pytest.fixture(scope="module")
def scene():
    return jo.whitecaps.PublishedSea(elfouhaily(), SIZES, CHOPPINESS)


@eqx.filter_jit
def small(key, even, speed=12.0):
    """A sea of two coarse patterns: its strain, and its statistics."""
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed), 2.0)
    sea = jo.whitecaps.PublishedSea(spectrum, (101.0, 17.0), (2.0, 1.0), 32)
    return sea.strain(key, even=even), sea.statistics(even=even), sea.wave_energy()


def test_peak_enhancement_of_the_spectrum_is_the_published_one_unless_given():
    usual, given = jo.spectra.Elfouhaily(jo.Wind(12.0), 2.0), elfouhaily(np.log10)
    k, phi = jnp.asarray([0.1, 0.27, 3.0]), jnp.zeros(3)
    np.testing.assert_allclose(given.density(k, phi), 2 * usual.density(k, phi), rtol=1e-14)
    natural = elfouhaily().density(k, phi) / (2 * usual.density(k, phi))
    assert float(natural[1]) > 1.5
    assert float(natural[2]) == pytest.approx(1, abs=1e-3)
    with pytest.raises(ValueError, match="`peak_enhancement` must be greater than 0"):
        jo.spectra.Elfouhaily(jo.Wind(12.0), 2.0, peak_enhancement=0.0)


def test_the_known_figures_of_the_first_scene_come_out(scene):
    program = jo.whitecaps.PublishedClosure()
    even, whole = scene.statistics(even=True), scene.statistics()
    assert float(program.moments(even)[1]) == pytest.approx(-0.54, abs=0.005)
    assert not bool(program.defined(even))
    # Their program sums the patterns' variances.
    for stats, gaussian, counted in ((even, 0.041, 0.019), (whole, 0.111, 0.089)):
        deviation = float(jnp.sum(stats.patterns.jacobian_variance())) ** 0.5
        below = 0.5 * float(jax.scipy.special.erfc((1 - THRESHOLD) / deviation / 2**0.5))
        assert below == pytest.approx(gaussian, abs=0.0006)
        exact = float(jo.whitecaps.ExactClosure("rest")(stats, THRESHOLD))
        assert exact == pytest.approx(counted, abs=0.0007)


def test_seas_have_the_variance_of_the_statistics_and_the_even_part_half_of_it():
    key = jax.random.key(3)
    for even in (False, True):
        strain, stats, _ = small(key, even)
        counted = jnp.einsum("pyxi,pyxj->pij", strain, strain) / 32**2
        # Amplitudes are not random: neither is the variance of the whole, in any one sea.
        rtol = 1e-9 if not even else 0.1
        np.testing.assert_allclose(counted, stats.patterns.covariance, rtol=rtol, atol=1e-2 * rtol)
        np.testing.assert_allclose(jnp.mean(strain, (1, 2)), 0, atol=1e-14)
        np.testing.assert_allclose(stats.covariance, jnp.sum(stats.patterns.covariance, 0))
    np.testing.assert_allclose(small(key, True)[1].covariance, 0.5 * small(key, False)[1].covariance)


def test_the_even_part_is_the_mean_of_the_strain_and_its_mirror_image():
    key = jax.random.key(4)
    whole, even = small(key, False)[0], small(key, True)[0]
    mirrored = jnp.roll(jnp.flip(whole, (1, 2)), 1, (1, 2))
    np.testing.assert_allclose(even, 0.5 * (whole + mirrored), atol=1e-14)
    j, foam = (jo.whitecaps.jacobian(jnp.sum(s, 0)).ravel() for s in (whole, even))
    assert float(jnp.corrcoef(j, foam)[0, 1]) == pytest.approx(0.71, abs=0.06)


def test_waves_outside_the_square_of_the_larger_pattern_are_all_there_once():
    big, little = (np.asarray(e) for e in small(jax.random.key(0), False)[2])
    index = np.abs(np.fft.fftfreq(32, 1 / 32))
    square = np.maximum(index, index[:, None])
    edge = 16 * 17 / 101  # the larger pattern's Nyquist wave number on the smaller one's lattice
    across = index > 0  # across the wind there are no long waves
    assert np.all((little > 0) == ((square >= edge) & (square < 16)))
    assert np.all((big > 0)[:, across] == ((square >= 1) & (square < 16))[:, across])


def test_ours_from_the_same_spectrum_is_close_once_the_extra_factor_is_gone(scene):
    plain = eqx.tree_at(lambda s: s.variance_factor, scene, jnp.asarray(1.0))
    stats = plain.statistics()
    cascade = jo.surface.Cascade(SIZES, 256)
    ours = jo.whitecaps.strain_statistics(elfouhaily(), CHOPPINESS, cascade=cascade)
    # Squares reach √2 farther into the corners than annuli, and λ differs on the two sides of each border.
    np.testing.assert_allclose(stats.covariance, ours.covariance, rtol=0.06, atol=1e-9)
    assert float(jnp.trace(stats.covariance)) > float(jnp.trace(ours.covariance))
    np.testing.assert_allclose(scene.statistics().covariance, 2 * stats.covariance)


def test_statistics_and_strains_are_differentiable_in_the_wind():
    @jax.jit
    def both(speed):
        strain, stats, _ = small(jax.random.key(1), True, speed)
        return jnp.trace(stats.covariance) + jnp.sum(strain**3)

    assert_derivative_matches(both, 11.0)
    calm, slope = jax.jvp(both, (jnp.asarray(0.0),), (jnp.asarray(1.0),))
    assert float(calm) == 0
    assert bool(jnp.isfinite(slope))


@pytest.mark.parametrize(
    ("sizes", "choppiness", "says"),
    [
        ((11.0, 101.0), (1.0, 1.0), "`sizes` must decrease"),
        ((101.0, 11.0), (1.0,), "must hold one number for each of `sizes`"),
        ((101.0, -1.0), (1.0, 1.0), "must hold finite sizes greater than 0"),
    ],
)
def test_what_makes_no_sense_is_refused(sizes, choppiness, says):
    with pytest.raises(ValueError, match=says):
        jo.whitecaps.PublishedSea(elfouhaily(), sizes, choppiness)
