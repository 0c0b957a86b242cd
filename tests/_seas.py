"""One sea of each kind, off the kinks of their formulas: every general test of spectra runs on them."""

import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean import spectra as sp

CLEAN = sp.Dispersion.CLEAN_WATER


def table(frequencies: int = 12, directions: int = 24) -> sp.MeasuredSpectrum:
    """A smooth made-up measurement with a swell and a wind sea."""
    f = 0.05 * 1.2 ** np.arange(frequencies)
    phi = np.arange(directions) * (2 * np.pi / directions)
    swell = np.exp(-(((f - 0.08) / 0.02) ** 2))[:, None] * np.cos(0.5 * (phi - 1.0)) ** 8
    wind_sea = (f / 0.15) ** -5 * np.exp(-1.25 * (0.15 / f) ** 4)
    energy = swell + wind_sea[:, None] * np.cos(0.5 * (phi - 2.5)) ** 4
    return sp.MeasuredSpectrum(energy, f, 0.2, dispersion=sp.Dispersion(30.0, CLEAN))


def wind(speed=10.0, direction=0.3):
    return jo.Wind(speed, direction)


SEAS = {
    "Elfouhaily": lambda: sp.Elfouhaily(wind(), 1.3),
    "Elfouhaily, Hasselmann spreading, half-plane": lambda: sp.Elfouhaily(
        wind(), spreading=sp.Hasselmann1980(), half_plane=True
    ),
    "Pierson–Moskowitz": lambda: sp.PiersonMoskowitz.from_wind(
        wind(), dispersion=sp.Dispersion(surface_tension=CLEAN)
    ),
    "JONSWAP, sech² spreading, 20 m deep, capillary": lambda: sp.JONSWAP(
        significant_wave_height=2.0,
        peak_period=8.0,
        direction=0.3,
        spreading=sp.DonelanBanner(),
        dispersion=sp.Dispersion(20.0, CLEAN),
    ),
    "TMA, Elfouhaily spreading": lambda: sp.TMA(
        significant_wave_height=2.0,
        peak_period=8.0,
        direction=0.3,
        spreading=sp.ElfouhailySpreading(wind()),
        dispersion=sp.Dispersion(8.0, CLEAN),
    ),
    "Phillips": lambda: sp.Phillips(wind(), 0.01, smallest_wave=0.05, opposing=0.25, exponent=4.0),
    "measured": table,
    "JONSWAP and a measured swell": lambda: (
        0.5
        * sp.JONSWAP(
            significant_wave_height=2.0,
            peak_period=6.0,
            spreading=sp.Cosine2s(8.0),
            dispersion=sp.Dispersion(30.0, CLEAN),
        )
        + table()
    ),
}
"""Makers, so that nothing is built when tests are collected."""

WAVENUMBERS = np.geomspace(1e-4, 1e4, 161)


def directions(k: jnp.ndarray) -> jnp.ndarray:
    """An angle for each wavenumber, none of them special."""
    return jnp.linspace(-3.0, 3.1, k.size, dtype=k.dtype)
