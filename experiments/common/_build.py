"""From sections of a config to jaxocean's objects: the one place that knows both names and classes."""

import math
from collections.abc import Callable

import equinox as eqx

import fitting
import jaxocean as jo
from jaxocean import wind as winds
from jaxocean.spectra import spreading as spreadings
from jaxocean.whitecaps import laws

from .. import schema
from ..harness._errors import UserError


def wind(config: schema.WindConfig, *, speed: float | None = None) -> jo.Wind:
    """The wind of a config; `speed` [m/s] replaces its speed, for a range of winds."""
    return jo.Wind(
        config.speed if speed is None else speed,
        config.direction,
        fetch=config.fetch,
        sea_air_temperature_difference=config.sea_air_temperature_difference,
        drag=drag(config.drag),
    )


def drag(name: str) -> winds.AbstractDrag:
    """A drag law."""
    return {"elfouhaily": winds.ElfouhailyDrag, "wu": winds.WuDrag}[name]()


def cascade(config: schema.CascadeConfig) -> jo.surface.Cascade:
    """The patterns of a config."""
    return jo.surface.Cascade(sizes=config.sizes, resolution=config.resolution, bands=config.bands)


def strain_statistics(
    config: schema.GaussianVsMonteCarloConfig | schema.FootprintBiasConfig, speed: float
) -> jo.whitecaps.StrainStatistics:
    """The strain of a config's sea under the wind `speed` [m/s]; an error where nothing can break."""
    stats = jo.whitecaps.strain_statistics(
        spectrum(config.spectrum, wind(config.wind, speed=speed)),
        config.choppiness,
        cascade=cascade(config.cascade),
        breaking_wavenumber=config.breaking_wavenumber,
    )
    if not float(stats.jacobian_variance()) > 0:
        raise UserError(
            f"The waves at U10 = {speed:g} m/s do not strain the surface (j = 1 everywhere), so that nothing "
            "breaks: raise `wind.speed`, `choppiness`, `spectrum.scale` or `breaking_wavenumber`."
        )
    return stats


def unresolved_breaking(cascade: jo.surface.Cascade, breaking_wavenumber: float | None) -> list[str]:
    """A note for results whose cascade does not carry all the waves that foam sees."""
    limit = cascade.wavenumber_limit
    if breaking_wavenumber is None:
        return [
            f"Without k_b the coverage belongs to this grid: it counts all waves up to {limit:.4g} rad/m."
        ]
    if breaking_wavenumber <= limit * (1 + 1e-6):
        return []
    return [
        f"Warning: k_b = {breaking_wavenumber:.4g} rad/m lies beyond the {limit:.4g} rad/m that the cascade resolves, "
        "so that the coverage depends on the grid: lower breaking_wavenumber, or raise cascade.resolution."
    ]


VALID_SPEED, VALID_AGE = (1.0, 50.0), (0.84, 5.0)
"""U10 [m/s] and Ω [-] for which Elfouhaily's spectrum was made."""

WAVELENGTHS, SHARE = 2.5, 0.95
"""A cascade holds a peak if its largest pattern has so many peak wavelengths, and so much of the height variance."""


def outside_validity(config: schema.SpectrumConfig, over: schema.WindConfig) -> list[str]:
    """Notes for results whose wind or wave age the spectrum was not made for."""
    if not isinstance(config, schema.ElfouhailyConfig):
        return []
    speeds = over.speed if isinstance(over.speed, tuple) else (over.speed,)
    notes = []
    low, high = VALID_SPEED
    strange = [speed for speed in speeds if not low <= speed <= high]
    if strange:
        notes.append(
            f"Warning: Elfouhaily's spectrum was made for U10 from {low:g} to {high:g} m/s, but here "
            f"U10 = {', '.join(f'{speed:g}' for speed in strange)} m/s: it is an extrapolation."
        )
    low, high = VALID_AGE
    ages = [config.inverse_wave_age]
    if config.inverse_wave_age is None:
        ages = [float(wind(over, speed=speed).inverse_wave_age()) for speed in speeds if speed > 0]
    for age in ages:
        if age is not None and not low * (1 - 1e-3) <= age <= high * (1 + 1e-3):
            notes.append(
                f"Warning: Elfouhaily's spectrum was made for Ω from {low:g} (fully developed) to {high:g}, but here "
                f"Ω = {age:.3g}: it is an extrapolation."
            )
            break
    return notes


def unheld_waves(
    cascade: jo.surface.Cascade, peak_wavenumber: float, whole_height: float, held_height: float
) -> list[str]:
    """A note for realised seas whose longest waves do not fit.

    **Arguments:** `peak_wavenumber` [rad/m]; significant wave heights [m]: of the spectrum, and of what the patterns
    hold.
    """
    largest, wave = max(cascade.sizes), 2 * math.pi / peak_wavenumber
    share = (held_height / whole_height) ** 2 if whole_height > 0 else 1.0
    if largest >= WAVELENGTHS * wave and share >= SHARE:
        return []
    return [
        f"Warning: the cascade does not hold the peak: its largest pattern of {largest:g} m has {largest / wave:.2g} "
        f"peak wavelengths ({wave:.3g} m), its patterns hold {100 * share:.3g} % of the height variance, and what is "
        f"realised has Hs = {held_height:.3g} m instead of {whole_height:.3g} m: give cascade.sizes one pattern of at "
        f"least {math.ceil(WAVELENGTHS * wave):g} m."
    ]


def dispersion(
    config: schema.SpectrumConfig, *, depth: float | None = None, surface_tension: float = 0.0
) -> jo.spectra.Dispersion:
    """The dispersion relation that goes with a spectrum: its own depth [m] if it has one, else `depth`."""
    return jo.spectra.Dispersion(water_depth(config, depth), surface_tension)


def water_depth(config: schema.SpectrumConfig, depth: float | None) -> float | None:
    """The depth [m] that a spectrum has, else `depth`; None for deep water."""
    return config.depth if isinstance(config, schema.TmaConfig) else depth


def spectrum(
    config: schema.SpectrumConfig, over: jo.Wind, relation: jo.spectra.Dispersion | None = None
) -> jo.spectra.AbstractSpectrum:
    """The spectrum of a config under the wind `over`, with its swell.

    `relation` turns frequencies into wavenumbers where the spectrum is one of frequency: that of `dispersion` if None.
    """
    relation = dispersion(config) if relation is None else relation
    built = _spectrum(config, over, relation)
    # A sweep puts traced numbers into configs; the usual factor of one costs nothing.
    if not (isinstance(config.scale, float) and config.scale == 1.0):
        built = config.scale * built
    return built if config.swell is None else built + swell(config.swell, over, relation)


def swell(
    config: schema.SwellConfig, over: jo.Wind, relation: jo.spectra.Dispersion | None = None
) -> jo.spectra.Swell:
    """The swell of a config."""
    return jo.spectra.Swell(
        significant_wave_height=config.significant_wave_height,
        peak_period=config.peak_period,
        width=config.width,
        direction=config.direction,
        spreading=spreading(config.spreading, over),
        dispersion=jo.spectra.Dispersion() if relation is None else relation,
    )


def _spectrum(
    config: schema.SpectrumConfig, over: jo.Wind, relation: jo.spectra.Dispersion
) -> jo.spectra.AbstractSpectrum:
    match config:
        case schema.ElfouhailyConfig():
            return jo.spectra.Elfouhaily(over, config.inverse_wave_age, half_plane=config.half_plane)
        case schema.PiersonMoskowitzConfig():
            law = spreading(config.spreading, over)
            return jo.spectra.PiersonMoskowitz.from_wind(over, spreading=law, dispersion=relation)
        case schema.JonswapConfig():
            return _jonswap(config, over, relation)
        case schema.TmaConfig():
            return jo.spectra.TMA(
                significant_wave_height=config.significant_wave_height,
                peak_period=config.peak_period,
                dispersion=relation,
                peak_enhancement=config.peak_enhancement,
                direction=over.direction,
                spreading=spreading(config.spreading, over),
            )
        case schema.PhillipsConfig():
            return jo.spectra.Phillips(
                over,
                config.amplitude,
                exponent=config.exponent,
                smallest_wave=config.smallest_wave,
                opposing=config.opposing,
            )
        case schema.TessendorfConfig():
            return jo.spectra.Phillips.from_tessendorf(
                over,
                amplitude=config.amplitude,
                size=config.size,
                exponent=config.exponent,
                smallest_wave=config.smallest_wave,
                opposing=config.opposing,
            )


def _jonswap(
    config: schema.JonswapConfig, over: jo.Wind, relation: jo.spectra.Dispersion
) -> jo.spectra.AbstractSpectrum:
    law = spreading(config.spreading, over)
    if config.significant_wave_height is not None and config.peak_period is not None:
        return jo.spectra.JONSWAP(
            significant_wave_height=config.significant_wave_height,
            peak_period=config.peak_period,
            peak_enhancement=config.peak_enhancement,
            direction=over.direction,
            spreading=law,
            dispersion=relation,
        )
    if over.fetch is None:
        raise UserError(
            "The spectrum `jonswap` needs either `wind.fetch` (for example wind.fetch=50e3), "
            "or both `spectrum.significant_wave_height` and `spectrum.peak_period`."
        )
    return jo.spectra.JONSWAP.from_fetch(
        over, peak_enhancement=config.peak_enhancement, spreading=law, dispersion=relation
    )


def spreading(config: schema.SpreadingConfig, over: jo.Wind) -> spreadings.AbstractSpreading:
    """The directional spreading of a config under the wind `over`."""
    match config:
        case schema.CosineSpreading():
            return spreadings.Cosine2s(config.s)
        case schema.MitsuyasuSpreading():
            return spreadings.Mitsuyasu(config.s_max)
        case schema.HasselmannSpreading():
            return spreadings.Hasselmann1980(config.inverse_wave_age)
        case schema.DonelanBannerSpreading():
            return spreadings.DonelanBanner()
        case schema.ElfouhailySpreading():
            return spreadings.ElfouhailySpreading(over)


LAWS: dict[str, Callable[[], laws.AbstractLaw]] = {
    "monahan_1980": laws.Monahan1980,
    "monahan_1980_least_squares": laws.Monahan1980LeastSquares,
    "monahan_1986": laws.MonahanOMuircheartaigh1986,
    "callaghan_2008": laws.Callaghan2008,
    "stramska_petelski_2003_undeveloped": laws.StramskaPetelski2003Undeveloped,
    "stramska_petelski_2003_developed": laws.StramskaPetelski2003Developed,
    "salisbury_2013": laws.Salisbury2013,
    "goddijn_murphy_2011": laws.GoddijnMurphy2011,
    "zhao_toba_2001": laws.ZhaoToba2001,
    "monahan_lu_1990_stage_a": laws.MonahanLu1990StageA,
    "monahan_lu_1990_stage_b": laws.MonahanLu1990StageB,
    "coare_3_6": laws.COARE36,
}
"""Whitecap laws by the names that configs use."""


def law(name: str) -> laws.AbstractLaw:
    """A whitecap law with its default constants."""
    return LAWS[name]()


SOLVERS: dict[str, Callable[[], fitting.AbstractSolver]] = {
    "levenberg_marquardt": fitting.LevenbergMarquardt,
    "gauss_newton": fitting.GaussNewton,
    "dogleg": fitting.Dogleg,
    "bfgs": fitting.BFGS,
    "lbfgs": fitting.LBFGS,
    "nelder_mead": fitting.NelderMead,
}


def solver(name: str) -> fitting.AbstractSolver:
    """A solver with its default tolerances."""
    return SOLVERS[name]()


class ConfiguredSea(eqx.Module):
    """Makes the spectrum of a config for any wind."""

    config: schema.SpectrumConfig = eqx.field(static=True)

    def __call__(self, wind: jo.Wind) -> jo.spectra.AbstractSpectrum:
        """The spectrum under this wind."""
        return spectrum(self.config, wind)
