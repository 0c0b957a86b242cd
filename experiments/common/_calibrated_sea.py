"""A sea whose ε and λ are fitted: from a config to the model, its free numbers and its winds."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp

import fitting
import jaxocean as jo

from ..schema import CalibratedSeaConfig
from . import _build
from ._words import low_pass


def model(config: CalibratedSeaConfig) -> fitting.SpectralModel:
    """The sea at the start of a fit."""
    return fitting.SpectralModel(
        config.threshold,
        config.choppiness_prior.mean,
        spectrum=_build.ConfiguredSea(config.spectrum),
        breaking_wavenumber=config.breaking_wavenumber,
        closure=jo.whitecaps.ExactClosure(config.measure),
        band=config.band,
        cascade=_build.cascade(config.cascade) if config.band is None else None,
    )


def free(config: CalibratedSeaConfig, deviation: float) -> list[Callable | fitting.Parameter]:
    """ε, and λ with a prior of this deviation."""
    prior = fitting.Normal(config.choppiness_prior.mean, deviation)
    return [lambda m: m.threshold, fitting.Parameter(lambda m: m.choppiness, prior=prior)]


def winds(config: CalibratedSeaConfig) -> jo.Wind:
    """The winds, stacked."""
    return eqx.filter_vmap(lambda u: _build.wind(config.wind, speed=u))(jnp.asarray(config.wind.speed))


def named(config: CalibratedSeaConfig) -> str:
    """Which area and which waves the numbers belong to."""
    lower, upper = config.band or _build.cascade(config.cascade).band
    limit = low_pass(config.breaking_wavenumber)
    return f"{config.measure} area, k = {lower:.3g}–{upper:.3g} rad/m, {limit}"


def attributes(config: CalibratedSeaConfig) -> dict[str, str | float]:
    """The same for data files."""
    limit = config.breaking_wavenumber
    lower, upper = config.band or _build.cascade(config.cascade).band
    return {
        "area_measure": config.measure,
        "band_rad_per_m": f"{lower:.6g} to {upper:.6g}",
        "breaking_wavenumber": "none" if limit is None else f"{limit:.6g} rad/m",
        "scatter_log10_coverage": config.scatter,
        "choppiness_prior": f"{config.choppiness_prior.mean:g} +- {config.choppiness_prior.deviation:g}",
        "spectrum": config.spectrum.family,
    }


def limits(config: CalibratedSeaConfig) -> list[str]:
    """Notes for results that depend on the grid, or on a spectrum outside of what it was made for."""
    notes = _build.outside_validity(config.spectrum, config.wind)
    if config.band is not None:
        return notes
    return notes + _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)
