"""Writing a spectrum as a file in wavespectra's netCDF convention."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import leaf_dtype
from ..spectra import AbstractSpectrum, Dispersion

if TYPE_CHECKING:
    import xarray

FREQUENCIES = tuple(0.03 * 1.06**i for i in range(50))
"""Default frequencies [Hz], 0.03 to 0.52: what a buoy reports."""


def write_spectrum(
    spectrum: AbstractSpectrum,
    path: str | os.PathLike,
    *,
    frequency: tuple[float, ...] | np.ndarray = FREQUENCIES,
    directions: int = 36,
    dispersion: Dispersion | None = None,
) -> Path:
    """Write any spectrum as netCDF in wavespectra's convention, so that it can be read like a measured one.

    The file appears whole or not at all.

    **Arguments:** as `dataset_from_spectrum`.

    **Returns:** the path.

    **Raises:** `ValueError` as `dataset_from_spectrum`; `OSError` if the file cannot be written.
    """
    target = Path(path)
    dataset = dataset_from_spectrum(
        spectrum, frequency=frequency, directions=directions, dispersion=dispersion
    )
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    try:
        dataset.to_netcdf(partial, engine="netcdf4")
        os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)
    return target


def dataset_from_spectrum(
    spectrum: AbstractSpectrum,
    *,
    frequency: tuple[float, ...] | np.ndarray = FREQUENCIES,
    directions: int = 36,
    dispersion: Dispersion | None = None,
) -> "xarray.Dataset":
    """Any spectrum as a dataset `efth(time, freq, dir)` [m²/(Hz degree)], directions coming from.

    **Arguments:** `frequency` [Hz], increasing; `directions`: how many over the circle; `dispersion` relates
    f and k (deep water by default) and its depth is stored as `dpt`.

    **Raises:** `ValueError` for frequencies that do not increase from above 0 or fewer than 5 directions.
    """
    import xarray

    f = np.asarray(frequency, np.float64)
    if f.ndim != 1 or f.size < 2 or f[0] <= 0 or not (np.diff(f) > 0).all():
        raise ValueError("Argument `frequency` must be increasing numbers greater than 0 Hz, but is not.")
    if directions < 5:
        raise ValueError(f"Argument `directions` must be at least 5, but is {directions}.")
    relation = Dispersion() if dispersion is None else dispersion
    degrees = np.arange(directions) * (360 / directions)
    dtype = leaf_dtype(spectrum, relation)
    towards = jnp.asarray(np.deg2rad(270 - degrees), dtype)
    per_radian = np.asarray(_energy(spectrum, relation, jnp.asarray(f, dtype), towards), np.float64)
    dataset = xarray.Dataset(
        {"efth": (("time", "freq", "dir"), per_radian[None] * (np.pi / 180))},
        coords={"time": np.array(["2000-01-01"], "datetime64[ns]"), "freq": f, "dir": degrees},
        attrs={"title": f"Directional wave spectrum of {type(spectrum).__name__}", "Conventions": "CF-1.8"},
    )
    dataset["efth"].attrs = {
        "standard_name": "sea_surface_wave_directional_variance_spectral_density",
        "units": "m2 s degree-1",
    }
    dataset["freq"].attrs = {"standard_name": "sea_surface_wave_frequency", "units": "Hz"}
    dataset["dir"].attrs = {"standard_name": "sea_surface_wave_from_direction", "units": "degree"}
    if relation.depth is not None:
        dataset["dpt"] = (("time",), np.asarray([float(relation.depth)]), {"units": "m"})
    return dataset


@eqx.filter_jit
def _energy(
    spectrum: AbstractSpectrum, relation: Dispersion, frequency: Float[Array, " f"], angle: Float[Array, " d"]
) -> Float[Array, "f d"]:
    """E(f, φ) [m²/(Hz rad)] on the grid of frequencies [Hz] and angles [rad]."""
    k = relation.wavenumber(2 * jnp.pi * frequency)
    density = spectrum.density(*jnp.broadcast_arrays(k[:, None], angle))
    return density * (2 * jnp.pi * k / relation.group_speed(k))[:, None]
