"""Pictures and data files of a sea state: its spectrum, and maps of one realisation."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jaxocean.surface import Cascade

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable


def map_points(side: float, resolution: int) -> np.ndarray:
    """Points (x, y) [m] in the middle of the pixels of a square map, indexed [y, x]."""
    along = (np.arange(resolution) + 0.5) * side / resolution
    return np.stack(np.meshgrid(along, along), axis=-1)


def plot_spectrum(
    store: Files, curves: dict[str, np.ndarray], cascade: Cascade, wave_height: float, peak_period: float
) -> None:
    """`spectrum.png` (E(k) with the patterns, E(f)) and `directional.png`."""
    k, f = curves["wavenumber"], curves["frequency"]
    with _plots.figure(1, 2, size=(9.5, 3.9)) as (fig, (left, right)):
        left.loglog(k, curves["omnidirectional"], color=_plots.BLACK)
        shown = curves["omnidirectional"].max()
        left.set(ylim=(shown * 1e-12, shown * 3), xlim=(k[0], k[-1]))
        for (lower, upper), colour in zip(cascade.bands, 4 * _plots.PALETTE, strict=False):
            left.axvspan(lower, upper, color=colour, alpha=0.16, linewidth=0)
        for (lower, upper), size in zip(cascade.bands, cascade.sizes, strict=True):
            middle = np.sqrt(max(lower, k[0]) * min(upper, k[-1]))
            left.text(middle, shown * 1.2e-12 * 4, f"{size:g} m", ha="center", va="bottom", fontsize=9)
        left.set(xlabel="wavenumber k (rad/m)", ylabel="E(k) (m³)", title="Wavenumber spectrum and patterns")
        right.plot(f, curves["energy"], color=_plots.BLUE)
        right.fill_between(f, curves["energy"], color=_plots.BLUE, alpha=0.15, linewidth=0)
        right.set(xlabel="frequency f (Hz)", ylabel="E(f) (m²/Hz)", title="Frequency spectrum")
        right.set(xlim=(f[0], f[-1]), ylim=(0, None))
        right.annotate(
            f"Hs = {wave_height:.3g} m\nTp = {peak_period:.3g} s",
            (0.97, 0.95),
            xycoords="axes fraction",
            ha="right",
            va="top",
        )
        store.picture("spectrum", fig)
    with _plots.figure(size=(5.6, 4.6), subplot_kw={"projection": "polar"}) as (fig, axes):
        label = "log10 Ψ (m⁴)"
        _plots.directional(axes, curves["near_peak"], curves["angle"], curves["density"], label=label)
        axes.set_title("Ψ(k, φ): radius k (rad/m), waves travel towards φ", fontsize=10, pad=14)
        store.picture("directional", fig)


def plot_maps(store: Files, maps: dict[str, np.ndarray], config: schema.SeaStateConfig) -> None:
    """`height.png`, `normal.png` and `folding.png`."""
    side, close = config.map.size, config.map.close_up
    with _plots.figure(size=(6.4, 5.2)) as (fig, axes):
        _plots.field_map(axes, maps["height"], side, label="height η (m)", centre=0.0)
        axes.set_title("Height")
        store.picture("height", fig)
    with _plots.figure(size=(5.4, 5.2)) as (fig, axes):
        _plots.picture_map(axes, _plots.normal_colours(maps["slope"]), close)
        axes.set_title("Normal map (red x, green y, blue up)")
        store.picture("normal", fig)
    with _plots.figure(size=(6.4, 5.2)) as (fig, axes):
        _plots.field_map(axes, maps["jacobian"], close, label="Jacobian j (-)", centre=1.0, colours="RdBu")
        _plots.outline_below(axes, maps["jacobian"], config.threshold, close)
        broken = float(np.mean(maps["jacobian"] < config.threshold))
        marked = "black: breaking" if broken > 0 else "nothing breaks here"
        axes.set_title(f"Folding map; {marked}, ε = {config.threshold:g}")
        store.picture("folding", fig)


def report(values: Mapping[str, Any], config: schema.SeaStateConfig, notes: Sequence[str]) -> str:
    """`report.md`."""
    swell, coverage, depth = config.spectrum.swell, values["coverage"], values["depth_m"]
    beside = (
        ""
        if swell is None
        else f" with swell of {swell.significant_wave_height:g} m and {swell.peak_period:g} s towards "
        f"{swell.direction:.3g} rad"
    )
    water = "deep water" if depth is None else f"water of {depth:g} m"
    listed = "".join(f"\n- {note}" for note in notes)
    name = config.spectrum.family.replace("_", "-").title()
    return f"""# Sea state: {name} at U10 = {config.wind.speed:g} m/s{beside}

The sea ({config.spectrum.family} at U10 = {config.wind.speed:g} m/s{beside}, {water}) has a significant wave height \
of {float(values["significant_wave_height_m"]):.4g} m, a peak period of {float(values["peak_period_s"]):.4g} s and a \
mean-square slope of {values["bands"][0]["mss"]:.4g}.

At ε = {config.threshold:g} whitecaps cover {100 * float(coverage["exact, projected area"]):.3g} % of it as seen from \
above and {100 * float(coverage["exact, rest area"]):.3g} % of its plane at rest (exact closure). On the square of \
{config.map.close_up:g} m that is drawn it is {100 * values["coverage_of_the_map"]:.3g} % of the plane at rest: one \
place at one time.

![the spectrum](spectrum.png)

![the spectrum by direction](directional.png)

![the height](height.png)

![the normals](normal.png)

![where the surface folds](folding.png)
{listed}"""


def save(
    store: Files, curves: dict[str, np.ndarray], maps: dict[str, np.ndarray], config: schema.SeaStateConfig
) -> None:
    store.data(
        "spectrum",
        {
            "omnidirectional": variable(
                "wavenumber", curves["omnidirectional"], units="m3", long_name="E(k)"
            ),
            "energy": variable(
                "frequency",
                curves["energy"],
                units="m2 s",
                long_name="E(f)",
                standard_name="sea_surface_wave_variance_spectral_density",
            ),
            "density": variable(
                ("near_peak", "angle"), curves["density"], units="m4", long_name="directional spectrum Psi"
            ),
        },
        {
            "wavenumber": variable(
                "wavenumber", curves["wavenumber"], units="rad m-1", long_name="wavenumber"
            ),
            "frequency": variable(
                "frequency",
                curves["frequency"],
                units="s-1",
                long_name="frequency",
                standard_name="wave_frequency",
            ),
            "near_peak": variable("near_peak", curves["near_peak"], units="rad m-1", long_name="wavenumber"),
            "angle": variable(
                "angle",
                curves["angle"],
                units="rad",
                long_name="direction towards, counter-clockwise from +x",
            ),
        },
        title="Spectrum of a sea state",
    )
    resolution = config.map.resolution
    large = map_points(config.map.size, resolution)[0, :, 0]
    close = map_points(config.map.close_up, resolution)[0, :, 0]
    store.data(
        "sea",
        {
            "height": variable(
                ("y", "x"), maps["height"], units="m", long_name="height above the rest plane"
            ),
            "slope": variable(
                ("yc", "xc", "axis"), maps["slope"], units="1", long_name="slope along x and y"
            ),
            "jacobian": variable(("yc", "xc"), maps["jacobian"], units="1", long_name="Jacobian j"),
        },
        {
            name: variable(name, values, units="m", long_name=f"{name[0]} on the rest plane")
            for name, values in (("x", large), ("y", large), ("xc", close), ("yc", close))
        },
        title="One realisation of a sea state",
        attributes={
            "time_s": config.time,
            "depth_m": config.depth or "deep, or that of the spectrum",
            "repeat_period_s": config.repeat_period or "none",
            "choppiness": np.atleast_1d(config.choppiness),
            "breaking_wavenumber_rad_per_m": config.breaking_wavenumber or "none",
        },
    )
