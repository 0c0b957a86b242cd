"""`spectrum`: show a sea state. Its spectrum, its numbers per band, and one realisation of it."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import jaxocean as jo
from jaxocean.spectra import BAND

from .. import schema
from ..common import _build
from ..common._words import low_pass
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result, Table
from . import _sea_views

DIRECTIONS = 180
WAVENUMBERS = 400


class SeaState(NamedTuple):
    """The numbers of a sea state: `patterns` first the whole band, then each pattern."""

    wave_height: Float[Array, " band"]
    slope: Float[Array, "band 3"]
    jacobian_variance: Float[Array, " band"]
    peak_period: Float[Array, ""]
    peak_wavenumber: Float[Array, ""]
    coverage: Float[Array, " closure"]


CLOSURES = (
    ("exact, projected area", jo.whitecaps.ExactClosure("projected")),
    ("exact, rest area", jo.whitecaps.ExactClosure("rest")),
    ("Gaussian, projected area", jo.whitecaps.GaussianClosure("projected")),
    ("Gaussian, rest area", jo.whitecaps.GaussianClosure("rest")),
)


def run(config: schema.SeaStateConfig, progress: Reporter, store: Files) -> Result:
    """Describe the sea of a config; see `schema.SeaStateConfig`."""
    progress.step("Integrating the spectrum")
    relation = _build.dispersion(config.spectrum, depth=config.depth, surface_tension=config.surface_tension)
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind), relation)
    cascade = _build.cascade(config.cascade)
    state = _describe(
        spectrum, cascade, relation, config.choppiness, config.threshold, config.breaking_wavenumber
    )
    curves = _curves(spectrum, relation, state)
    _sea_views.plot_spectrum(store, curves, cascade, float(state.wave_height[0]), float(state.peak_period))

    progress.step("Realising the sea")
    sea = jo.surface.realise(
        spectrum,
        cascade,
        key=jax.random.key(config.seed),
        dispersion=relation,
        repeat_period=config.repeat_period,
    )
    progress.step("Drawing the maps")
    maps = _maps(sea, config)
    _sea_views.plot_maps(store, maps, config)
    _sea_views.save(store, curves, maps, config)
    result = _result(
        state, cascade, config, breaking_share=float(np.mean(maps["jacobian"] < config.threshold))
    )
    store.text("report.md", _sea_views.report(result.values, config, result.notes))
    return result


@eqx.filter_jit
def _describe(spectrum, cascade, relation, choppiness, threshold, breaking_wavenumber) -> SeaState:
    stats = jo.whitecaps.strain_statistics(
        spectrum, choppiness, cascade=cascade, breaking_wavenumber=breaking_wavenumber
    )
    patterns = stats.patterns
    assert patterns is not None  # statistics of a cascade have them
    bands = (BAND, *cascade.bands)
    period = jo.spectra.peak_period(spectrum, relation)
    return SeaState(
        wave_height=jnp.stack([jo.spectra.significant_wave_height(spectrum, band=band) for band in bands]),
        slope=jnp.stack([jnp.stack(jo.spectra.slope_variance(spectrum, band=band)) for band in bands]),
        jacobian_variance=jnp.append(stats.jacobian_variance(), patterns.jacobian_variance()),
        peak_period=period,
        peak_wavenumber=relation.wavenumber(2 * jnp.pi / period),
        coverage=jnp.stack([closure(stats, threshold) for _, closure in CLOSURES]),
    )


def _curves(spectrum, relation, state: SeaState) -> dict[str, np.ndarray]:
    """Ψ, E(k) and E(f), sampled for plots and files."""
    k_peak, f_peak = float(state.peak_wavenumber), 1 / float(state.peak_period)
    wavenumber = np.geomspace(min(k_peak / 10, BAND[1] / 10), BAND[1], WAVENUMBERS)
    frequency = np.linspace(f_peak / 4, 4 * f_peak, WAVENUMBERS)
    near_peak = np.linspace(k_peak / 5, 5 * k_peak, 120)
    angle = np.arange(DIRECTIONS) * 2 * np.pi / DIRECTIONS
    k, phi = np.meshgrid(near_peak, angle, indexing="ij")
    density = eqx.filter_jit(lambda s, k, phi: s.density(k, phi))
    omnidirectional = eqx.filter_jit(lambda s, k: s.harmonics(k).mean)
    energy = eqx.filter_jit(jo.spectra.frequency_spectrum)
    return {
        "wavenumber": wavenumber,
        "omnidirectional": np.asarray(omnidirectional(spectrum, jnp.asarray(wavenumber))),
        "frequency": frequency,
        "energy": np.asarray(energy(spectrum, jnp.asarray(frequency), relation)),
        "near_peak": near_peak,
        "angle": angle,
        "density": np.asarray(density(spectrum, jnp.asarray(k), jnp.asarray(phi))),
    }


def _maps(sea: jo.surface.Sea, config: schema.SeaStateConfig) -> dict[str, np.ndarray]:
    """Height on the large square; slope and j on the close-up."""
    large, close = (
        _sea_views.map_points(config.map.size, config.map.resolution),
        _sea_views.map_points(config.map.close_up, config.map.resolution),
    )
    strain = sea.strain(close, config.time, config.choppiness, config.breaking_wavenumber)
    return {
        "height": np.asarray(sea.height(large, config.time)),
        "slope": np.asarray(sea.slope(close, config.time)),
        "jacobian": np.asarray(jo.whitecaps.jacobian(strain)),
    }


def _result(
    state: SeaState, cascade: jo.surface.Cascade, config: schema.SeaStateConfig, *, breaking_share: float
) -> Result:
    bands = (BAND, *cascade.bands)
    names = ("whole spectrum", *(f"pattern {size:g} m" for size in cascade.sizes))
    mss = state.slope[:, 0] + state.slope[:, 1]
    jacobian = [float("nan"), *map(float, state.jacobian_variance[1:])]
    rows = [
        (name, *band, float(height), float(total), float(x), float(y), variance)
        for name, band, height, total, (x, y, _), variance in zip(
            names, bands, state.wave_height, mss, state.slope, jacobian, strict=True
        )
    ]
    limit = low_pass(config.breaking_wavenumber)
    return Result(
        notes=(
            *_build.unheld_waves(
                cascade,
                float(state.peak_wavenumber),
                float(state.wave_height[0]),
                float(jnp.linalg.norm(state.wave_height[1:])),
            ),
            *_build.outside_validity(config.spectrum, config.wind),
            *_build.unresolved_breaking(cascade, config.breaking_wavenumber),
        ),
        values={
            "significant_wave_height_m": state.wave_height[0],
            "peak_period_s": state.peak_period,
            "peak_wavenumber_rad_per_m": state.peak_wavenumber,
            "bands": [
                {
                    "name": row[0],
                    "band_rad_per_m": row[1:3],
                    "significant_wave_height_m": row[3],
                    "mss": row[4],
                }
                for row in rows
            ],
            "jacobian_variance": state.jacobian_variance[0],
            "coverage": {name: value for (name, _), value in zip(CLOSURES, state.coverage, strict=True)},
            "coverage_of_the_map": breaking_share,
            "threshold": config.threshold,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
            "depth_m": _build.water_depth(config.spectrum, config.depth),
        },
        tables=(
            Table(
                f"Sea state: Tp = {state.peak_period:.4g} s, k_p = {state.peak_wavenumber:.4g} rad/m",
                (
                    "waves",
                    "from (rad/m)",
                    "to (rad/m)",
                    "Hs (m)",
                    "mss (-)",
                    "along x",
                    "along y",
                    "Var j (-)",
                ),
                rows,
            ),
            Table(
                f"Whitecap coverage W at ε = {config.threshold:g}, {limit}",
                ("closure", "W (-)"),
                [(name, float(value)) for (name, _), value in zip(CLOSURES, state.coverage, strict=True)]
                + [("the folding map, rest area", breaking_share)],
            ),
        ),
    )
