"""Tables, notes and `report.md` of `sea_states`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import schema
from ..harness._result import Table
from ._state_views import change


def values(states: Any, config: schema.SeaStatesConfig) -> dict[str, Any]:
    """The ends of the curves, by names that tell their units."""
    found: dict[str, Any] = {
        "coverage_of_the_wind_sea": states.alone[1],
        "threshold": config.threshold,
        "choppiness": config.choppiness,
        "breaking_wavenumber_rad_per_m": config.breaking_wavenumber,
    }
    for i, height in enumerate(config.swell.significant_wave_height):
        effect = change(states.turned[i], states.alone)[:, 1]
        along, across = float(effect[0]), float(np.interp(0.5 * np.pi, states.angle, effect))
        name = _spelled(height)
        found[f"swell_{name}_m_along_percent"] = along
        found[f"swell_{name}_m_across_percent"] = across
    for i, speed in enumerate(config.wind.speed):
        name = _spelled(speed)
        found[f"coverage_oldest_{name}_m_per_s"] = states.aged[i, 0, 1]
        found[f"coverage_youngest_{name}_m_per_s"] = states.aged[i, -1, 1]
        found[f"law_ratio_of_ages_{name}"] = states.law_aged[i, 0] / states.law_aged[i, -1]
        found[f"ratio_of_ages_{name}"] = _ratio(states.aged[i, 0, 1], states.aged[i, -1, 1])
    return found


def _ratio(old: float, young: float) -> float:
    return float(old / young) if young > 0 else float("nan")


def _spelled(number: float) -> str:
    return f"{number:g}".replace(".", "_")


def tables(states: Any, config: schema.SeaStatesConfig) -> tuple[Table, ...]:
    """The swell at three angles, and three ages of the wind sea."""
    swell = config.swell
    degrees = (0, 45, 90, 135, 180)
    rows = []
    for i, height in enumerate(swell.significant_wave_height):
        effect = change(states.turned[i], states.alone)[:, 1]
        rows.append((height, *(float(np.interp(np.deg2rad(d), states.angle, effect)) for d in degrees)))
    ages = np.geomspace(*config.inverse_wave_age, 4)
    by_age = [
        (
            speed,
            *(
                float(np.exp(np.interp(np.log(a), np.log(states.age), _log(states.aged[i, :, 1]))))
                for a in ages
            ),
        )
        for i, speed in enumerate(config.wind.speed)
    ]
    return (
        Table(
            f"Change of W (%) by swell of {swell.peak_period:g} s beside a developed sea of {swell.at_wind:g} m/s",
            ("Hs (m)", *(f"at {d}°" for d in degrees)),
            rows,
        ),
        Table(
            f"Whitecap coverage W (-) of wind seas, projected area, ε = {config.threshold:g}",
            ("U10 (m/s)", *(f"Ω = {age:.3g}" for age in ages)),
            by_age,
        ),
    )


def _log(coverage: np.ndarray) -> np.ndarray:
    return np.log(np.maximum(coverage, 1e-300))


def notes(found: Mapping[str, Any], config: schema.SeaStatesConfig) -> list[str]:
    """The answer in two sentences."""
    height = config.swell.significant_wave_height[-1]
    name = _spelled(height)
    along, across = found[f"swell_{name}_m_along_percent"], found[f"swell_{name}_m_across_percent"]
    speed = config.wind.speed[len(config.wind.speed) // 2]
    wind = _spelled(speed)
    oldest, youngest = config.inverse_wave_age
    return [
        f"Swell of {height:g} m and {config.swell.peak_period:g} s raises W at {config.swell.at_wind:g} m/s by "
        f"{along:.3g} % along the wind and by {across:.3g} % across it: its slope counts, its direction hardly does.",
        f"At {speed:g} m/s a wind sea of Ω = {oldest:g} has {found[f'ratio_of_ages_{wind}']:.3g} times the whitecaps "
        f"of one of Ω = {youngest:g}; Zhao & Toba's law says {found[f'law_ratio_of_ages_{wind}']:.3g} times.",
    ]


def report(found: Mapping[str, Any], config: schema.SeaStatesConfig) -> str:
    """`report.md`."""
    limit = config.breaking_wavenumber
    sees = "all waves" if limit is None else f"waves up to k_b = {limit:.4g} rad/m"
    swell, age = notes(found, config)
    return f"""# Whitecaps at one wind: swell, its angle, and the age of the wind sea

Elfouhaily wind seas, with swell beside them that is narrow and has no tail. Exact closure, projected area, \
ε = {config.threshold:g} ± {config.threshold_error:g}, λ = {config.choppiness:g}; foam sees {sees}. The developed sea \
of {config.swell.at_wind:g} m/s alone has W = {100 * float(found["coverage_of_the_wind_sea"]):.3g} %.

{swell} The variance of the Jacobian is, to first order, the mean-square slope, which does not know directions; that \
the two systems cross only makes the Jacobian more skewed, and low values rarer.

{age} This is at one ε for all ages.

The sea is linear: what swell does to the wind, and long waves to the short ones that ride on them, is left out.

![sea states](sea_states.png)"""
