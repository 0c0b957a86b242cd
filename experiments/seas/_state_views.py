"""The picture and the data of `sea_states`."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MultipleLocator

from .. import schema
from ..common import _plots
from ..common._words import low_pass
from ..harness._files import Files, variable


def plot(store: Files, states: Any, config: schema.SeaStatesConfig) -> None:
    """`sea_states.png`: the swell's angle and period above, the age and the fetch of the wind sea below."""
    with _plots.figure(2, 2, size=(10.4, 8.4)) as (fig, ((angle, period), (age, fetch))):
        _plot_angle(angle, states, config)
        _plot_period(period, states, config)
        _plot_age(age, states, config)
        _plot_fetch(fetch, states, config)
        sees = low_pass(config.breaking_wavenumber)
        fig.suptitle(
            f"Elfouhaily wind seas; exact closure, projected area, ε = {config.threshold:g}, "
            f"λ = {config.choppiness:g}, {sees}; bands: ε ± {config.threshold_error:g}",
            fontsize=11,
            x=0.01,
            ha="left",
        )
        store.picture("sea_states", fig)


def change(coverage: np.ndarray, alone: np.ndarray) -> np.ndarray:
    """Change of coverage [%] at each ε by the swell."""
    return 100 * (coverage / alone - 1)


def _band(axes: Axes, x: np.ndarray, values: np.ndarray, colour: Any, label: str, line: str = "-") -> None:
    axes.fill_between(x, values[:, 0], values[:, 2], color=colour, alpha=0.22, linewidth=0)
    axes.plot(x, values[:, 1], color=colour, label=label, linestyle=line)


def _plot_angle(axes: Axes, states: Any, config: schema.SeaStatesConfig) -> None:
    swell = config.swell
    colours = _plots.colours_for(len(swell.significant_wave_height))
    degrees = np.rad2deg(states.angle)
    for i, (height, colour) in enumerate(zip(swell.significant_wave_height, colours, strict=True)):
        _band(axes, degrees, change(states.turned[i], states.alone), colour, f"swell of {height:g} m")
    axes.set(xlabel="angle from the wind to the swell (°)", ylabel="change of W by the swell (%)")
    axes.set(title=f"(a) Swell of {swell.peak_period:g} s turned, U10 = {swell.at_wind:g} m/s")
    axes.set(xlim=(0, 180), ylim=(0, None))
    axes.xaxis.set_major_locator(MultipleLocator(30))
    axes.legend(loc="center right")


def _plot_period(axes: Axes, states: Any, config: schema.SeaStatesConfig) -> None:
    swell = config.swell
    colours = _plots.colours_for(len(swell.significant_wave_height))
    for i, (height, colour) in enumerate(zip(swell.significant_wave_height, colours, strict=True)):
        _band(
            axes,
            states.period,
            change(states.longer[i, 0], states.alone),
            colour,
            f"{height:g} m, along the wind",
        )
        across = change(states.longer[i, 1], states.alone)[:, 1]
        axes.plot(states.period, across, color=colour, linestyle="--", label=f"{height:g} m, across")
    axes.set(xlabel="peak period of the swell (s)", ylabel="change of W by the swell (%)", yscale="log")
    axes.set(
        title=f"(b) Swell of any period, U10 = {swell.at_wind:g} m/s", xlim=tuple(states.period[[0, -1]])
    )
    axes.legend(loc="upper right")


def _plot_age(axes: Axes, states: Any, config: schema.SeaStatesConfig) -> None:
    _plot_winds(axes, states.age, states.aged, states.law_aged, config)
    axes.set(xlabel="inverse wave age Ω = U10/c_p (-)", title="(c) Younger wind seas at one wind")
    axes.set(xlim=tuple(states.age[[0, -1]]))
    axes.legend(loc="upper center", ncols=2)


def _plot_fetch(axes: Axes, states: Any, config: schema.SeaStatesConfig) -> None:
    _plot_winds(axes, states.fetch / 1e3, states.blown, states.law_blown, config)
    axes.set(
        xlabel="fetch (km)",
        xscale="log",
        title="(d) Fetch at one wind",
        xlim=tuple(states.fetch[[0, -1]] / 1e3),
    )
    axes.legend(loc="upper center", ncols=2)


def _plot_winds(axes: Axes, x: np.ndarray, coverage: np.ndarray, law: np.ndarray, config: Any) -> None:
    # Bands overlap: far colours, faint bands, and the curves above all of them.
    colours = [
        (_plots.BLUE, _plots.ORANGE, _plots.BLACK, _plots.GREEN)[i % 4] for i in range(len(config.wind.speed))
    ]
    for i, (speed, colour) in enumerate(zip(config.wind.speed, colours, strict=True)):
        axes.fill_between(x, coverage[i, :, 0], coverage[i, :, 2], color=colour, alpha=0.13, linewidth=0)
        axes.plot(x, coverage[i, :, 1], color=colour, label=f"U10 = {speed:g} m/s")
        axes.plot(x, law[i], color=colour, linestyle=(0, (1, 1.4)), linewidth=1.5)
    axes.plot([], [], color=_plots.GREY, linestyle=(0, (1, 1.4)), linewidth=1.5, label="Zhao & Toba 2001")
    top, bottom = (
        max(float(coverage.max()), float(law.max())),
        float(np.min(coverage[coverage > 0], initial=1.0)),
    )
    # Room for the legend above the curves.
    axes.set(yscale="log", ylabel="whitecap coverage W (-)", ylim=(max(0.6 * bottom, 1e-9 * top), 12 * top))


def save(store: Files, states: Any, config: schema.SeaStatesConfig) -> None:
    """`sea_states.nc`: all curves."""
    swell = config.swell
    curves = {
        "swell_angle": (("swell_height", "angle"), states.turned, "swell at an angle to the wind"),
        "swell_period": (("swell_height", "side", "period"), states.longer, "swell of any period"),
        "wave_age": (("wind_speed", "inverse_wave_age"), states.aged, "wind sea of any age"),
        "fetch": (("wind_speed", "fetch"), states.blown, "wind sea of any fetch"),
        "wind_sea_alone": ((), states.alone, "the developed wind sea that the swell meets"),
    }
    variables = {}
    for name, (dimensions, values, words) in curves.items():
        for i, (suffix, at) in enumerate(
            (("_low", " less its error"), ("", ""), ("_high", " plus its error"))
        ):
            variables[f"coverage_{name}{suffix}"] = variable(
                dimensions, values[..., i], units="1", long_name=f"whitecap coverage, {words}, at epsilon{at}"
            )
    words = "whitecap coverage by Zhao & Toba 2001"
    variables["law_wave_age"] = variable(
        ("wind_speed", "inverse_wave_age"), states.law_aged, units="1", long_name=words
    )
    variables["law_fetch"] = variable(("wind_speed", "fetch"), states.law_blown, units="1", long_name=words)
    axes = {
        "swell_height": (swell.significant_wave_height, "m", "significant wave height of the swell"),
        "angle": (states.angle, "rad", "angle from the wind to the swell"),
        "side": ((0.0, 0.5 * np.pi), "rad", "angle from the wind to the swell"),
        "period": (states.period, "s", "peak period of the swell"),
        "wind_speed": (config.wind.speed, "m s-1", "wind speed at 10 m"),
        "inverse_wave_age": (states.age, "1", "inverse wave age"),
        "fetch": (states.fetch, "m", "fetch"),
    }
    coordinates = {
        name: variable(name, np.asarray(values), units=units, long_name=words)
        for name, (values, units, words) in axes.items()
    }
    store.data(
        "sea_states",
        variables,
        coordinates,
        title="Whitecap coverage against swell and the age of the wind sea",
        attributes={
            "threshold": config.threshold,
            "threshold_error": config.threshold_error,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
            "band_rad_per_m": np.asarray(config.band),
            "swell_peak_period_s": swell.peak_period,
            "swell_at_wind_m_per_s": swell.at_wind,
        },
    )
