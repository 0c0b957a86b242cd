"""Data of foam in time."""

import numpy as np

from ..common import _build
from ..harness._files import Files, variable
from ._foam_results import FIELDS, View


def save(store: Files, view: View) -> None:
    """`foam_in_time.nc`: series and closed forms; `foam_map.nc`: the last picture."""
    config, calibration = view.config, view.calibration
    series = np.stack([growth.series for growth in view.growths])
    long_names = {
        "active_rest": "active whitecap coverage of the rest area",
        "active_projected": "active whitecap coverage of the projected area",
        "total_rest": "total whitecap coverage of the rest area",
        "total_projected": "total whitecap coverage of the projected area",
    }
    dimensions = ("wind", "sea", "elapsed")
    variables = {
        name: variable(dimensions, series[..., FIELDS.index(name)], units="1", long_name=text)
        for name, text in long_names.items()
    }
    variables["birth_rate"] = variable(
        dimensions,
        series[..., FIELDS.index("birth_rate")],
        units="s-1",
        long_name="part of the rest area that starts to break per time",
    )
    variables |= {
        f"{closure}_{measure}": variable(
            ("wind", "decay_time"),
            values,
            units="1",
            long_name=f"total coverage by the {closure} closure, {measure} area",
        )
        for (closure, measure), values in calibration.closed.items()
    }
    variables["tile_total_rest"] = variable(
        ("wind", "decay_time"),
        np.stack([view.total_at(k)[0] for k in range(len(calibration.decay_times))], axis=1),
        units="1",
        long_name="total coverage of the rest area on the tile, mean after the spin-up",
    )
    variables["active_closure"] = variable(
        "wind",
        calibration.points.projected,
        units="1",
        long_name="active coverage by the exact closure, projected area",
    )
    variables["crossing_rate"] = variable(
        "wind",
        calibration.points.rate,
        units="s-1",
        long_name="rate at which a point starts to break, closed form",
    )
    variables["fitted_decay_time"] = variable(
        "wind",
        calibration.own_decay_time,
        units="s",
        long_name="decay time of foam fitted to the laws at this wind alone",
    )
    for name, values in (("active_law", calibration.active_law), ("total_law", calibration.total_law)):
        variables[name] = variable(
            "wind", values, units="1", long_name=_build.law(getattr(config, name)).name
        )
    coordinates = {
        "wind": variable(
            "wind", np.asarray(config.wind.speed), units="m s-1", long_name="U10", standard_name="wind_speed"
        ),
        "sea": variable("sea", np.arange(config.seas), units="1", long_name="number of the realisation"),
        "elapsed": variable(
            "elapsed",
            config.step * np.arange(1, series.shape[2] + 1),
            units="s",
            long_name="time since there was no foam",
        ),
        "decay_time": variable(
            "decay_time", calibration.decay_times, units="s", long_name="decay time of foam"
        ),
    }
    attributes = {
        "threshold": calibration.used[0],
        "decay_time_s": calibration.used[1],
        "spin_up_s": view.growths[0].spin * config.step,
        "choppiness": np.atleast_1d(config.choppiness),
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
        "tile_size_m": config.tile.size,
    }
    store.data(
        "foam_in_time",
        variables,
        coordinates,
        title="Active and total whitecap coverage in time",
        attributes=attributes,
    )
    picture = view.picture
    if picture is None:
        return
    n = len(picture.age)
    rest = np.arange(n) * (config.tile.size / n)
    plane = ("y", "x")
    store.data(
        "foam_map",
        {
            "coverage": variable(plane, picture.coverage, units="1", long_name="foam coverage"),
            "age": variable(
                plane,
                picture.age,
                units="s",
                long_name="time since it broke, or since the window of the picture began",
            ),
        },
        {
            "x": variable("x", rest, units="m", long_name="rest coordinate x"),
            "y": variable("y", rest, units="m", long_name="rest coordinate y"),
        },
        title="Foam on the world tile at the last time",
        attributes=attributes | {"time_s": picture.time},
    )
