"""`coverage`: whitecap coverage of one sea in closed form, by every closure and both measures of area."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import jaxocean as jo

from .. import schema
from ..common import _build
from ..common._words import low_pass
from ..harness._errors import UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._quantity import Quantity
from ..harness._result import Result, Table
from . import _coverage_views
from ._coverage_views import Curves

CLOSURES = {
    "exact_projected": (jo.whitecaps.ExactClosure("projected"), "exact closure, projected area"),
    "exact_rest": (jo.whitecaps.ExactClosure("rest"), "exact closure, rest area"),
    "gaussian_projected": (jo.whitecaps.GaussianClosure("projected"), "Gaussian closure, projected area"),
    "gaussian_rest": (jo.whitecaps.GaussianClosure("rest"), "Gaussian closure, rest area"),
    "published": (
        jo.whitecaps.PublishedClosure(),
        "published closure (eqs 6-8 as printed; undefined where its variance is negative), rest area",
    ),
}

QUANTITIES = {
    f"coverage_{name}": Quantity("1", f"whitecap coverage, {words}", may_be_undefined=name == "published")
    for name, (_, words) in CLOSURES.items()
} | {
    "strain_variance_a": Quantity("1", "variance of the strain a = du/dx"),
    "strain_variance_b": Quantity("1", "variance of the strain b = dv/dy"),
    "strain_variance_c": Quantity("1", "variance of the strain c = du/dy, and covariance of a and b"),
    "strain_covariance_ac": Quantity("1", "covariance of the strains a and c"),
    "strain_covariance_bc": Quantity("1", "covariance of the strains b and c"),
    "jacobian_variance": Quantity("1", "variance of the Jacobian j"),
    "jacobian_skewness": Quantity("1", "skewness of the Jacobian j", may_be_undefined=True),
    "significant_wave_height": Quantity(
        "m",
        "significant wave height of the waves that count",
        standard_name="sea_surface_wave_significant_height",
    ),
    "mean_square_slope": Quantity("1", "mean-square slope of the waves that count"),
}
"""What `measure` returns, with units."""

LEVELS = 241


def run(config: schema.CoverageConfig, progress: Reporter, store: Files) -> Result:
    """Coverage of the sea of a config; see `schema.CoverageConfig`."""
    progress.step("Integrating the spectrum")
    lowest = min(-0.2, config.threshold - 0.2)
    levels = np.linspace(lowest, 1.0, LEVELS)
    with jax.enable_x64(True):
        values, curves = jax.tree.map(np.asarray, _close(config, levels))
    numbers = {name: float(values[name]) for name in QUANTITIES}
    if not numbers["jacobian_variance"] > 0:
        raise UserError(
            f"The waves at U10 = {config.wind.speed:g} m/s do not strain the surface (j = 1 everywhere), so that "
            "nothing breaks: raise `wind.speed`, `choppiness`, `spectrum.scale` or `breaking_wavenumber`."
        )
    progress.step("Drawing")
    _coverage_views.plot(store, curves, numbers, config)
    _coverage_views.save(store, curves, numbers, config, QUANTITIES)
    result = _result(numbers, config)
    store.text("report.md", _coverage_views.report(numbers, config, result.notes))
    return result


def measure(config: schema.CoverageConfig) -> dict[str, Float[Array, ""]]:
    """The numbers of one sea, by the names in `QUANTITIES`.

    A pure function of the config, whose numbers at `CoverageConfig.varies` may be traced: a sweep maps it over
    thousands of seas at once.
    """
    spectrum, stats = _statistics(config)
    c = stats.covariance
    band = _band(config)
    threshold = jnp.asarray(config.threshold)
    return {f"coverage_{name}": closure(stats, threshold) for name, (closure, _) in CLOSURES.items()} | {
        "strain_variance_a": c[0, 0],
        "strain_variance_b": c[1, 1],
        "strain_variance_c": c[2, 2],
        "strain_covariance_ac": c[0, 2],
        "strain_covariance_bc": c[1, 2],
        "jacobian_variance": stats.jacobian_variance(),
        "jacobian_skewness": stats.jacobian_skewness(),
        "significant_wave_height": jo.spectra.significant_wave_height(spectrum, band=band),
        "mean_square_slope": jo.spectra.mean_square_slope(spectrum, band=band),
    }


def _statistics(
    config: schema.CoverageConfig,
) -> tuple[jo.spectra.AbstractSpectrum, jo.whitecaps.StrainStatistics]:
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind))
    stats = jo.whitecaps.strain_statistics(
        spectrum,
        config.choppiness,
        band=config.band,
        cascade=None if config.band is not None else _build.cascade(config.cascade),
        breaking_wavenumber=config.breaking_wavenumber,
    )
    return spectrum, stats


def _band(config: schema.CoverageConfig) -> tuple[float, float]:
    return _build.cascade(config.cascade).band if config.band is None else config.band


@eqx.filter_jit
def _close(config: schema.CoverageConfig, levels) -> tuple[dict[str, Array], Curves]:
    """The numbers of `measure`, and the coverage at every level of ε."""
    _, stats = _statistics(config)
    curves = {name: jax.vmap(lambda e, c=c: c.log(stats, e))(levels) for name, (c, _) in CLOSURES.items()}
    return measure(config), Curves(levels, curves)


def _result(numbers: dict[str, float], config: schema.CoverageConfig) -> Result:
    rest, projected = numbers["coverage_exact_rest"], numbers["coverage_exact_projected"]
    published = numbers["coverage_published"]
    rows = [
        ("exact", projected, rest),
        ("Gaussian", numbers["coverage_gaussian_projected"], numbers["coverage_gaussian_rest"]),
        ("published", "rest area only", published if published >= 0 else "undefined"),
    ]
    statistics = [
        (QUANTITIES[name].long_name, number)
        for name, number in numbers.items()
        if not name.startswith("coverage_")
    ]
    notes = [_coverage_views.answer(numbers, config)]
    if not published >= 0:
        notes.append("The published formula is undefined here: its variance is negative.")
    notes += _build.outside_validity(config.spectrum, config.wind)
    if config.band is None:
        notes += _build.unresolved_breaking(_build.cascade(config.cascade), config.breaking_wavenumber)
    return Result(
        values={
            **numbers,
            "threshold": config.threshold,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
            "band_rad_per_m": _band(config),
        },
        tables=(
            Table(
                f"Whitecap coverage W at ε = {config.threshold:g}, {low_pass(config.breaking_wavenumber)}",
                ("closure", "projected area (-)", "rest area (-)"),
                rows,
            ),
            Table(
                f"The sea, k from {_band(config)[0]:.3g} to {_band(config)[1]:.4g} rad/m",
                ("", "value (SI)"),
                statistics,
            ),
        ),
        notes=tuple(notes),
    )
