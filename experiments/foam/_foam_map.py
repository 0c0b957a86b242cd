"""Foam on the displaced surface, seen from above."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize

from ..common import _plots
from ..harness._files import Files
from ._foam_results import View

DEEP, LIT, FOAM = np.array([0.02, 0.09, 0.16]), np.array([0.17, 0.41, 0.50]), np.array([0.97, 0.98, 0.98])
AGES = LinearSegmentedColormap.from_list("ages", ["#FFF6DF", "#FDB35A", "#E4572E", "#96306F", "#4A3A86"])
SIDE = 96.0
"""Side [m] of the square that is drawn, at most."""


def plot_map(store: Files, view: View) -> None:
    """`foam_map.png`: as the eye sees it, and coloured by age."""
    config, picture = view.config, view.picture
    if picture is None:
        return
    n, side = len(picture.age), min(config.tile.size, SIDE)
    spacing = config.tile.size / n
    # A piece from the middle with a margin, because the displaced mesh has no straight edges.
    margin = min(4.0, 0.1 * side)
    first = round(0.5 * (config.tile.size - side) / spacing)
    cut = slice(first, first + round(side / spacing))
    rest = np.arange(n) * spacing
    x = (rest[None, :] + picture.displacement[..., 0])[cut, cut] - rest[first]
    y = (rest[:, None] + picture.displacement[..., 1])[cut, cut] - rest[first]
    along_y, along_x = (slope[cut, cut] for slope in np.gradient(picture.height, spacing))
    light = np.clip(0.45 - 2.0 * (0.8 * along_x + 0.6 * along_y), 0, 1)[..., None]
    water = DEEP + (LIT - DEEP) * light
    white = picture.coverage[cut, cut, None]
    tau = view.calibration.used[1]
    norm = Normalize(0, 3 * tau)
    aged = AGES(norm(picture.age[cut, cut]))[..., :3]
    drawn = config.wind.speed[-1] if config.drawn_wind is None else config.drawn_wind
    words = f"U10 = {drawn:g} m/s, ε = {view.calibration.used[0]:.2f}, τ = {tau:.2f} s"
    with _plots.figure(1, 2, size=(12.0, 5.7)) as (fig, axes):
        for each, colours, title in (
            (axes[0], water + (FOAM - water) * white, f"(a) Foam from above; {words}"),
            (axes[1], 0.5 * water + (aged - 0.5 * water) * np.sqrt(white), "(b) Its age"),
        ):
            each.pcolormesh(x, y, np.clip(colours, 0, 1), shading="gouraud", rasterized=True)
            _plots.label_plane(each)
            each.set(xlim=(margin, side - margin), ylim=(margin, side - margin), title=title)
        bar = fig.colorbar(ScalarMappable(norm, AGES), ax=axes[1], shrink=0.9, pad=0.02, extend="max")
        bar.set_label("time since it broke (s)")
        bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
        store.picture("foam_map", fig)
