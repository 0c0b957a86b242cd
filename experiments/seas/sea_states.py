"""`sea_states`: whitecaps of wind seas of any age, and with swell from any side, in closed form."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean.wind import inverse_wave_age_from_fetch

from .. import schema
from ..common import _build
from ..harness._errors import UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _state_report, _state_views

DEVELOPED = 0.84


class States(NamedTuple):
    """Coverage along four axes; the last axis of each is ε less its error, ε, ε plus its error.

    **Arguments:** `alone`: of the wind sea that the swell meets; `turned`: by height and angle; `longer`: by height,
    along (0) or across (1) the wind, and period; `aged`: by wind and Ω; `blown`: by wind and fetch.
    """

    angle: Any
    period: Any
    age: Any
    fetch: Any
    alone: Any
    turned: Any
    longer: Any
    aged: Any
    blown: Any
    law_aged: Any
    law_blown: Any
    fetch_age: Any


def run(config: schema.SeaStatesConfig, progress: Reporter, store: Files) -> Result:
    """Draw coverage against swell and wave age; see `schema.SeaStatesConfig`."""
    progress.step("Integrating the spectra")
    with jax.enable_x64(True):
        states = _states(config)
    if not states.alone[1] > 0:
        raise UserError(
            f"Nothing breaks in the wind sea of {config.swell.at_wind:g} m/s: raise `swell.at_wind`, `choppiness` or "
            "`threshold`."
        )
    progress.step("Drawing")
    _state_views.plot(store, states, config)
    _state_views.save(store, states, config)
    values = _state_report.values(states, config)
    store.text("report.md", _state_report.report(values, config))
    return Result(
        values=values,
        tables=_state_report.tables(states, config),
        notes=_state_report.notes(values, config),
    )


def _states(config: schema.SeaStatesConfig) -> States:
    """All curves, from one compiled program."""
    cover = _coverage(config)
    swell, winds = config.swell, np.asarray(config.wind.speed)[:, None]
    heights = np.asarray(swell.significant_wave_height)
    angle = np.linspace(0, np.pi, config.points)
    period = np.geomspace(*swell.peak_periods, config.points)
    age = np.geomspace(*config.inverse_wave_age, config.points)
    fetch = np.geomspace(*config.fetch, config.points)
    blown = np.asarray(
        jax.vmap(jax.vmap(inverse_wave_age_from_fetch))(*map(jnp.asarray, np.broadcast_arrays(winds, fetch)))
    )
    sides = np.array([0.0, 0.5 * np.pi])[:, None]
    return States(
        angle=angle,
        period=period,
        age=age,
        fetch=fetch,
        alone=cover(swell.at_wind, DEVELOPED, 0.0, swell.peak_period, 0.0),
        turned=cover(swell.at_wind, DEVELOPED, heights[:, None], swell.peak_period, angle),
        longer=cover(swell.at_wind, DEVELOPED, heights[:, None, None], period, sides),
        aged=cover(winds, age, 0.0, swell.peak_period, 0.0),
        blown=cover(winds, blown, 0.0, swell.peak_period, 0.0),
        law_aged=_law(config, winds, age),
        law_blown=_law(config, winds, blown),
        fetch_age=blown,
    )


def _coverage(config: schema.SeaStatesConfig) -> Callable[..., np.ndarray]:
    """A function of arrays that broadcast: U10, Ω, and the swell's Hs, Tp and angle to the wind."""
    thresholds = config.threshold + config.threshold_error * jnp.asarray([-1.0, 0.0, 1.0])
    limit = None if config.breaking_wavenumber is None else jnp.asarray(config.breaking_wavenumber)
    closure, drag = jo.whitecaps.ExactClosure("projected"), _build.drag(config.wind.drag)

    @jax.jit
    @jax.vmap
    def many(speed, age, height, period, angle):
        wind = jo.Wind(speed, drag=drag)
        swell = jo.spectra.Swell(
            significant_wave_height=height,
            peak_period=period,
            width=config.swell.width,
            direction=angle,
            spreading=_build.spreading(config.swell.spreading, wind),
        )
        stats = jo.whitecaps.strain_statistics(
            jo.spectra.Elfouhaily(wind, age) + swell,
            config.choppiness,
            band=config.band,
            breaking_wavenumber=limit,
        )
        return jax.vmap(lambda epsilon: closure(stats, epsilon))(thresholds)

    def cover(*arguments: Any) -> np.ndarray:
        arrays = np.broadcast_arrays(*(np.asarray(one, float) for one in arguments))
        flat = [one.ravel() for one in arrays]
        size = _BATCH
        found = []
        for start in range(0, flat[0].size, size):
            # Filled up, so that all curves share one program.
            places = np.minimum(np.arange(start, start + size), flat[0].size - 1)
            found.append(np.asarray(many(*(one[places] for one in flat))))
        return np.concatenate(found)[: flat[0].size].reshape(*arrays[0].shape, 3)

    return cover


_BATCH = 128


def _law(config: schema.SeaStatesConfig, winds: np.ndarray, ages: np.ndarray) -> np.ndarray:
    """The law that knows the age of the waves, Zhao & Toba's."""
    drag = _build.drag(config.wind.drag)

    def one(speed, age):
        return jo.whitecaps.laws.ZhaoToba2001(inverse_wave_age=age).coverage(jo.Wind(speed, drag=drag))

    speeds, ages = np.broadcast_arrays(winds, ages)
    return np.asarray(jax.vmap(jax.vmap(one))(jnp.asarray(speeds), jnp.asarray(ages)))
