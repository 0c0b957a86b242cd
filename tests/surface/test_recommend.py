"""What a recommended cascade promises."""

import itertools
import math

import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo

CASES = [
    pytest.param(dict(wind=jo.Wind(speed), smallest_scale=scale, **more), id=f"{speed:g}-{scale:g}-{more}")
    for speed, scale, more in [
        (3.0, 0.086, {}),
        (10.0, 0.086, {}),
        (10.0, 0.01, {}),
        (25.0, 0.5, {"resolution": 128}),
        (12.0, 0.086, {"patterns": 6}),
        (12.0, 0.086, {"patterns": 2, "waves": 4}),
        (12.0, 0.3, {"patterns": 3, "resolution": 512, "waves": 12.0}),
        (5.0, 2.0, {"patterns": 1}),
    ]
]


def peak_wavelength(wind: jo.Wind) -> float:
    return 2 * math.pi * float(wind.speed / wind.inverse_wave_age()) ** 2 / 9.81


@pytest.mark.parametrize("asked", CASES)
def test_it_keeps_its_promises(asked):
    cascade = jo.surface.recommend_cascade(**asked)
    waves, peak = asked.get("waves", 8), peak_wavelength(asked["wind"])
    sizes, n = cascade.sizes, cascade.resolution
    assert list(sizes) == sorted(sizes, reverse=True)
    assert n % 2 == 0
    assert n == asked.get("resolution", n)
    assert len(sizes) == asked.get("patterns", len(sizes))
    assert sizes[0] >= max(2.5, waves) * peak
    # It carries the smallest wave, and hardly more.
    shortest = 2 * math.pi / cascade.wavenumber_limit
    assert 0.75 * asked["smallest_scale"] < shortest <= asked["smallest_scale"] or len(sizes) == 1
    assert shortest <= asked["smallest_scale"]
    # The first wave of each band fits often enough into its pattern.
    for (lower, _), size in zip(cascade.bands[1:], sizes[1:], strict=True):
        assert lower * size / (2 * math.pi) >= waves
    for one, other in itertools.pairwise(sizes):
        assert one / other > 1.4
    # Sizes have at least four digits, and no common factors.
    assert cascade.period >= 900 ** (len(sizes) - 1) * sizes[0]
    if len(sizes) > 2:
        assert cascade.period > 1e8  # two and a half times around the Earth


def test_hardly_any_variance_is_left_out():
    wind = jo.Wind(8.0)
    cascade = jo.surface.recommend_cascade(wind, smallest_scale=0.3, resolution=64)
    spectrum = jo.spectra.Elfouhaily(wind)
    total = jo.spectra.height_variance(spectrum)
    assert float(jnp.sum(jo.surface.cell_energy(spectrum, cascade))) == pytest.approx(float(total), rel=0.01)


@pytest.mark.parametrize(("waves", "count", "error"), [(2.5, 46, 0.08), (4, 102, 0.03), (8, 350, 0.008)])
def test_so_many_waves_know_directions_so_well(waves, count, error):
    """The first octave of a band that starts `waves` steps from the origin."""
    size, n = 100.0, 256
    lower = waves * 2 * math.pi / size
    narrow = jo.spectra.spreading.Cosine2s(20.0)
    period = 2 * math.pi / math.sqrt(9.81 * 0.3 * lower)
    spectrum = jo.spectra.JONSWAP(
        significant_wave_height=1.0, peak_period=period, direction=0.3, spreading=narrow
    )
    cascade = jo.surface.Cascade((size,), n, ((lower, 2 * lower),))
    energy = jo.surface.cell_energy(spectrum, cascade)
    across = float(jo.surface.strain_autocovariance(energy, cascade, np.zeros(1))[0, 0, 1, 1])
    true = float(jo.whitecaps.strain_statistics(spectrum, 1.0, cascade=cascade).covariance[1, 1])
    assert across / true - 1 == pytest.approx(error, rel=0.1)
    assert int(jnp.sum(energy > 0)) // 2 == count


def test_a_peak_says_the_same_as_its_wind_and_fetch_shortens_the_sea():
    wind, young = jo.Wind(10.0), jo.Wind(10.0, fetch=2e4)
    by_wind = jo.surface.recommend_cascade(wind, smallest_scale=0.1)
    peak = jo.spectra.Elfouhaily(wind).peak_wavenumber()
    assert jo.surface.recommend_cascade(peak_wavenumber=peak, smallest_scale=0.1) == by_wind
    assert jo.surface.recommend_cascade(young, smallest_scale=0.1).sizes[0] < 0.5 * by_wind.sizes[0]


def test_the_least_resolution_is_the_least():
    wind = jo.Wind(12.0)
    cascade = jo.surface.recommend_cascade(wind, smallest_scale=0.086, patterns=3)
    fast = [2 * 2**a * 3**b * 5**c for a in range(9) for b in range(6) for c in range(4)]
    assert cascade.resolution in fast
    less = max(n for n in fast if n < cascade.resolution)
    with pytest.raises(
        ValueError, match=f"`resolution` must be at least {cascade.resolution} for 3 patterns"
    ):
        jo.surface.recommend_cascade(wind, smallest_scale=0.086, patterns=3, resolution=less)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"smallest_scale": 0.1}, "exactly one of `wind` and `peak_wavenumber`, but neither"),
        (
            {"wind": jo.Wind(5.0), "peak_wavenumber": 1.0, "smallest_scale": 0.1},
            "exactly one of `wind` and `peak_wavenumber`, but both",
        ),
        ({"wind": jo.Wind(0.0), "smallest_scale": 0.1}, "`wind.speed` must be greater than 0"),
        ({"peak_wavenumber": -1.0, "smallest_scale": 0.1}, "`peak_wavenumber` must be greater than 0"),
        (
            {"peak_wavenumber": 1.0, "smallest_scale": 0.0},
            "`smallest_scale` must be greater than 0 m and less",
        ),
        ({"peak_wavenumber": 1.0, "smallest_scale": 7.0}, "less than the peak's wavelength, 6.28319 m"),
        ({"peak_wavenumber": 1.0, "smallest_scale": 0.1, "waves": 2.0}, "`waves` must be at least 2.5"),
        ({"peak_wavenumber": 1.0, "smallest_scale": 0.1, "resolution": 65}, "must be an even whole number"),
        ({"peak_wavenumber": 1.0, "smallest_scale": 0.1, "patterns": 17}, "`patterns` must be 1 to 16"),
        (
            {"peak_wavenumber": 1e-3, "smallest_scale": 0.01, "patterns": 1},
            "`patterns` must be larger, but is 1",
        ),
        ({"peak_wavenumber": 1e-3, "smallest_scale": 0.01, "resolution": 16}, "`resolution` must be larger"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(asked, says):
    with pytest.raises(ValueError, match=says):
        jo.surface.recommend_cascade(**asked)


@pytest.mark.parametrize("bad", [(10.0, 20.0, 2), (10.0, 0.0, 2), (10.0, 10.0, 2), (10.0, 5.0, 0)])
def test_sizes_that_do_not_fall_are_refused(bad):
    with pytest.raises(ValueError, match="falling sizes"):
        jo.surface.spread_sizes(*bad)
    with pytest.raises(ValueError, match="room between the sizes"):
        jo.surface.spread_sizes(1.0001, 1.0, 5)
