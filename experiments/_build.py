"""From sections of a config to jaxocean's objects: the one place that knows both names and classes."""

import jaxocean as jo
from jaxocean import wind as winds
from jaxocean.spectra import spreading as spreadings

from . import schema
from ._errors import UserError


def wind(config: schema.WindConfig, *, speed: float | None = None) -> jo.Wind:
    """The wind of a config; `speed` [m/s] replaces its speed, for a range of winds."""
    return jo.Wind(
        config.speed if speed is None else speed,
        config.direction,
        fetch=config.fetch,
        sea_air_temperature_difference=config.sea_air_temperature_difference,
        drag={"elfouhaily": winds.ElfouhailyDrag, "wu": winds.WuDrag}[config.drag](),
    )


def cascade(config: schema.CascadeConfig) -> jo.surface.Cascade:
    """The patterns of a config."""
    return jo.surface.Cascade(sizes=config.sizes, resolution=config.resolution, bands=config.bands)


def dispersion(config: schema.SpectrumConfig) -> jo.spectra.Dispersion:
    """The dispersion relation that goes with a spectrum: deep water unless it has a depth."""
    return jo.spectra.Dispersion(config.depth if isinstance(config, schema.TmaConfig) else None)


def spectrum(config: schema.SpectrumConfig, over: jo.Wind) -> jo.spectra.AbstractSpectrum:
    """The spectrum of a config under the wind `over`."""
    built = _spectrum(config, over)
    return built if config.scale == 1.0 else config.scale * built


def _spectrum(config: schema.SpectrumConfig, over: jo.Wind) -> jo.spectra.AbstractSpectrum:
    match config:
        case schema.ElfouhailyConfig():
            return jo.spectra.Elfouhaily(over, config.inverse_wave_age, half_plane=config.half_plane)
        case schema.PiersonMoskowitzConfig():
            return jo.spectra.PiersonMoskowitz.from_wind(over, spreading=spreading(config.spreading, over))
        case schema.JonswapConfig():
            return _jonswap(config, over)
        case schema.TmaConfig():
            return jo.spectra.TMA(
                significant_wave_height=config.significant_wave_height,
                peak_period=config.peak_period,
                dispersion=dispersion(config),
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


def _jonswap(config: schema.JonswapConfig, over: jo.Wind) -> jo.spectra.AbstractSpectrum:
    law = spreading(config.spreading, over)
    if config.significant_wave_height is not None and config.peak_period is not None:
        return jo.spectra.JONSWAP(
            significant_wave_height=config.significant_wave_height,
            peak_period=config.peak_period,
            peak_enhancement=config.peak_enhancement,
            direction=over.direction,
            spreading=law,
        )
    if over.fetch is None:
        raise UserError(
            "The spectrum `jonswap` needs either `wind.fetch` (for example wind.fetch=50e3), "
            "or both `spectrum.significant_wave_height` and `spectrum.peak_period`."
        )
    return jo.spectra.JONSWAP.from_fetch(over, peak_enhancement=config.peak_enhancement, spreading=law)


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
