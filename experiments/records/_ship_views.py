"""The picture and the data of `ship_records`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from jaxocean._constants import GRAVITY
from jaxocean.io import ShipRecords

from .. import schema
from ..common import _build, _plots
from ..common._words import low_pass
from ..harness._files import Files, variable

DEVELOPED = 0.84
COLOURS = (_plots.VERMILION, _plots.GREEN, _plots.PURPLE, _plots.ORANGE)
CLASS = 0.025
"""Width [-] of the classes of wave age; one begins at 0.84."""

STEP = 0.5
"""Width [m/s] of the classes of wind whose medians make lines."""


def plot(
    store: Files, sea: Any, peak_speed: np.ndarray, compared: Sequence[Any], config: schema.ShipRecordsConfig
) -> None:
    """`ship_records.png`: coverage against wind and against laws, what the swell does, and the wave ages."""
    with _plots.figure(2, 2, size=(10.4, 8.2)) as (fig, ((wind, law), (swell, age))):
        _plot_wind(wind, sea, config)
        _plot_law(law, sea, compared)
        _plot_swell(swell, sea, config)
        _plot_age(age, sea, peak_speed)
        sees = low_pass(config.breaking_wavenumber)
        fig.suptitle(
            f"{sea.wind_speed.size} ship records; exact closure, projected area, ε = {config.threshold:g} ± "
            f"{config.threshold_error:g}, λ = {config.choppiness:g}, {sees}",
            fontsize=11,
            x=0.01,
            ha="left",
        )
        store.picture("ship_records", fig)


def _plot_wind(axes: Axes, sea: Any, config: schema.ShipRecordsConfig) -> None:
    predicted, younger = sea.projected[:, 1], sea.younger.astype(bool)
    dots: dict[str, Any] = {"markersize": 2.5, "alpha": 0.5, "markeredgewidth": 0}
    axes.plot(
        sea.wind_speed[~younger],
        predicted[~younger],
        "o",
        color=_plots.SKY,
        label="developed + swell",
        **dots,
    )
    axes.plot(
        sea.wind_speed[younger], predicted[younger], "o", color=_plots.BLACK, label="younger wind sea", **dots
    )
    centres, low, middle, high = _course(sea.wind_speed, sea.projected)
    axes.fill_between(centres, low, high, color=_plots.BLUE, alpha=0.25, linewidth=0)
    axes.plot(centres, middle, color=_plots.BLUE, label="median, band: error of ε")
    order = np.argsort(sea.wind_speed)
    for i, (name, colour) in enumerate(zip(config.laws, COLOURS, strict=False)):
        law = np.where(sea.laws[:, i] > 0, sea.laws[:, i], np.nan)
        axes.plot(sea.wind_speed[order], law[order], color=colour, label=_build.law(name).name)
    axes.set(yscale="log", xlabel="wind speed U10 (m/s)", ylabel="whitecap coverage W (-)")
    axes.set(title="(a) Against the wind", ylim=_limits(predicted))
    axes.legend(loc="lower right", markerscale=2.5)


def _course(wind: np.ndarray, projected: np.ndarray) -> tuple[np.ndarray, ...]:
    """Medians in classes of wind that hold at least ten records: centres, low, middle, high."""
    edges = np.arange(np.floor(wind.min()), np.ceil(wind.max()) + STEP, STEP)
    place = np.digitize(wind, edges)
    rows = [
        (edges[k - 1] + 0.5 * STEP, *np.median(projected[place == k], axis=0))
        for k in np.unique(place)
        if np.sum(place == k) >= min(10, wind.size)
    ]
    return tuple(np.array(rows).reshape(-1, 4).T)


def _limits(predicted: np.ndarray) -> tuple[float, float]:
    """From well below what is predicted, but for a few records, to more than ever was."""
    return max(1e-6, 0.1 * float(np.quantile(predicted, 0.002))), 0.1


def _plot_law(axes: Axes, sea: Any, compared: Sequence[Any]) -> None:
    predicted = sea.projected[:, 1]
    limits = _limits(predicted)
    span = np.array(limits)
    axes.fill_between(span, span / 10, span * 10, color="#E4E4E4", linewidth=0, label="a factor of 10")
    axes.plot(span, span, color=_plots.GREY, linewidth=1)
    for i, (one, colour) in enumerate(zip(compared, COLOURS, strict=False)):
        law = np.where(sea.laws[:, i] > 0, sea.laws[:, i], np.nan)
        label = f"{_build.law(one.law).name}: {one.rank_correlation[0]:.3f}"
        axes.plot(
            law, predicted, "o", color=colour, markersize=2.5, alpha=0.5, markeredgewidth=0, label=label
        )
    axes.set(xscale="log", yscale="log", xlabel="W by the law (-)", ylabel="W predicted (-)")
    axes.set(title="(b) Against the laws, with rank correlations", xlim=limits, ylim=limits)
    axes.legend(loc="upper left", markerscale=2.5)


def _plot_swell(axes: Axes, sea: Any, config: schema.ShipRecordsConfig) -> None:
    """Against the slope of the swell, since it is slope that strains."""
    has = sea.swell_height > 0
    wavenumber = (2 * np.pi / sea.swell_period) ** 2 / GRAVITY
    angle = np.rad2deg(config.swell.angle)
    slope = 0.25 * sea.swell_height * wavenumber
    for changed, colour, label in (
        (sea.projected[:, 1], _plots.BLUE, f"at {angle:.3g}° to the wind"),
        (sea.swell_across, _plots.VERMILION, f"at {angle + 90:.3g}°"),
    ):
        effect = 100 * (changed[has] / sea.without_swell[has] - 1)
        axes.plot(
            slope[has], effect, "o", color=colour, markersize=2.5, alpha=0.5, markeredgewidth=0, label=label
        )
    axes.set(xlabel="slope of the swell, k_p Hs/4 (-)", ylabel="change of W by the swell (%)")
    axes.set(title="(c) What the swell does", xlim=(0, None), ylim=(0, None))
    axes.legend(loc="upper left", markerscale=2.5)


def _plot_age(axes: Axes, sea: Any, peak_speed: np.ndarray) -> None:
    measured = sea.wind_speed / peak_speed
    last = max(1.3, float(sea.inverse_wave_age.max()))
    bins = DEVELOPED + CLASS * np.arange(-DEVELOPED // CLASS, (last - DEVELOPED) // CLASS + 2)
    counts, *_ = axes.hist(measured, bins=list(bins), color=_plots.SKY, label="measured, U10/c_p")
    axes.hist(
        sea.inverse_wave_age[sea.inverse_wave_age > DEVELOPED + 1e-6],
        bins=list(bins),
        color=_plots.BLACK,
        histtype="step",
        linewidth=1.5,
        label="wind seas younger than developed",
    )
    axes.axvline(DEVELOPED, color=_plots.VERMILION, linewidth=1.2, label="fully developed, 0.84")
    axes.set_ylim(0, 1.3 * float(np.max(counts)))
    axes.set(xlabel="inverse wave age Ω (-)", ylabel="records", title="(d) Wave age")
    axes.legend(loc="upper right")


def save(
    store: Files, ship: ShipRecords, where: np.ndarray, sea: Any, config: schema.ShipRecordsConfig
) -> None:
    """`ship_records.nc`: every record with its two wave systems and its whitecaps."""
    columns = {
        "day_of_year": (ship.day[where], "d", "day of the year, the first of January is day 1", None),
        "wind_speed": (sea.wind_speed, "m s-1", "wind speed at 10 m, neutral profile", "wind_speed"),
        "significant_wave_height": (
            ship.significant_wave_height[where],
            "m",
            "significant wave height as measured",
            "sea_surface_wave_significant_height",
        ),
        "wind_sea_height": (
            sea.wind_sea_height,
            "m",
            "significant wave height of the wind sea",
            "sea_surface_wind_wave_significant_height",
        ),
        "swell_height": (
            sea.swell_height,
            "m",
            "significant wave height of the swell",
            "sea_surface_swell_wave_significant_height",
        ),
        "swell_period": (sea.swell_period, "s", "peak period of the swell, from the phase speed", None),
        "inverse_wave_age": (sea.inverse_wave_age, "1", "inverse wave age of the wind sea", None),
        "younger": (sea.younger.astype(np.int8), "1", "1 where the wind sea had to be made younger", None),
        "coverage_projected": (sea.projected[:, 1], "1", "whitecap coverage, projected area", None),
        "coverage_projected_low": (sea.projected[:, 0], "1", "the same at epsilon less its error", None),
        "coverage_projected_high": (sea.projected[:, 2], "1", "the same at epsilon plus its error", None),
        "coverage_rest": (sea.rest, "1", "whitecap coverage, rest area", None),
        "coverage_without_swell": (sea.without_swell, "1", "projected coverage of the wind sea alone", None),
        "coverage_swell_across": (
            sea.swell_across,
            "1",
            "projected coverage, swell turned by 90 degrees",
            None,
        ),
        "coverage_scaled": (
            sea.scaled,
            "1",
            "projected coverage of the wind sea alone, scaled down where too high instead of made younger",
            None,
        ),
    }
    for i, name in enumerate(config.laws):
        columns[f"coverage_{name}"] = (
            sea.laws[:, i],
            "1",
            f"whitecap coverage by {_build.law(name).name}",
            None,
        )
    variables = {
        key: variable("record", values, units=units, long_name=text, standard_name=standard)
        for key, (values, units, text, standard) in columns.items()
    }
    coordinates = {
        "latitude": variable(
            "record",
            ship.latitude[where],
            units="degrees_north",
            long_name="latitude",
            standard_name="latitude",
        ),
        "longitude": variable(
            "record",
            ship.longitude[where],
            units="degrees_east",
            long_name="longitude",
            standard_name="longitude",
        ),
    }
    store.data(
        "ship_records",
        variables,
        coordinates if np.isfinite(ship.latitude[where]).any() else {},
        title="Whitecap coverage predicted from ship records of wind, wave height and phase speed",
        attributes={
            "threshold": config.threshold,
            "threshold_error": config.threshold_error,
            "choppiness": config.choppiness,
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
            "band_rad_per_m": np.asarray(config.band),
            "swell_angle_rad": config.swell.angle,
            "swell_width": config.swell.width,
        },
    )
