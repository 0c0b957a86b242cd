"""How pictures look: one style, readable letters, labelled axes, colours for the colour-blind too."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

# Okabe & Ito 2008, without yellow, which is hard to see on white.
BLUE, ORANGE, GREEN, VERMILION, SKY, PURPLE, BLACK = PALETTE = (
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#D55E00",
    "#56B4E9",
    "#CC79A7",
    "#000000",
)
GREY = "#767676"

STYLE: dict[Any, Any] = {
    "figure.dpi": 150,
    "savefig.dpi": 150,
    "figure.constrained_layout.use": True,
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.prop_cycle": cycler(color=list(PALETTE)),
    "grid.color": "#E3E3E3",
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "image.origin": "lower",
}


@contextmanager
def figure(
    rows: int = 1, columns: int = 1, *, size: tuple[float, float], title: str | None = None, **options: Any
) -> Iterator[tuple[Figure, Any]]:
    """A figure and its axes in the common style; `size` in inches, `options` as for `plt.subplots`.

    Use: `with figure(size=(7, 4)) as (fig, ax): …; store.picture("name", fig)`.
    """
    with plt.rc_context(STYLE):
        fig, axes = plt.subplots(rows, columns, figsize=size, **options)
        if title is not None:
            fig.suptitle(title, fontsize=12, fontweight="bold", x=0.01, ha="left")
        yield fig, axes


@contextmanager
def mosaic(
    layout: Sequence[Sequence[str]], *, size: tuple[float, float], **options: Any
) -> Iterator[tuple[Figure, dict[str, Axes]]]:
    """A figure whose axes have names and may span several cells; `options` as for `plt.subplot_mosaic`."""
    with plt.rc_context(STYLE):
        fig, axes = plt.subplot_mosaic([list(row) for row in layout], figsize=size, **options)
        yield fig, axes


def field_map(
    axes: Axes,
    values: ArrayLike,
    side: float,
    *,
    label: str,
    colours: str = "RdBu_r",
    limits: tuple[float, float] | None = None,
    centre: float | None = None,
) -> None:
    """A square map of `values[y, x]` with sides of `side` metres and a colour bar.

    **Arguments:** `label`: quantity and unit for the colour bar; `limits`: of the colours; `centre`: the
    value in the middle of a diverging colour map, whose limits are then symmetric and hold 99.8 % of it.
    """
    field = np.asarray(values)
    if limits is None and centre is not None:
        reach = float(np.quantile(np.abs(field - centre), 0.998)) or 1.0
        limits = (centre - reach, centre + reach)
    norm = Normalize(*limits) if limits else Normalize(float(field.min()), float(field.max()))
    picture = axes.imshow(field, extent=(0, side, 0, side), cmap=colours, norm=norm, interpolation="nearest")
    bar = axes.figure.colorbar(
        picture, ax=axes, shrink=0.85, pad=0.02, extend="both" if limits else "neither"
    )
    bar.set_label(label)
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
    label_plane(axes)


def picture_map(axes: Axes, colours: ArrayLike, side: float) -> None:
    """A square map of colours `[y, x, 3]` in 0…1 with sides of `side` metres."""
    axes.imshow(np.asarray(colours), extent=(0, side, 0, side), interpolation="nearest")
    label_plane(axes)


def label_plane(axes: Axes) -> None:
    """Axes of a map of the sea."""
    axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    axes.grid(visible=False)


def directional(
    axes: Any,
    frequencies: ArrayLike,
    angles: ArrayLike,
    density: ArrayLike,
    *,
    label: str,
    decades: float = 3.0,
) -> None:
    """E(f, φ) on polar axes (`subplot_kw={"projection": "polar"}`), logarithmic, φ from +x counter-clockwise.

    **Arguments:** `frequencies` [Hz] and `angles` [rad] over the whole circle; `density` [frequency, angle];
    `label`: quantity and unit; `decades`: below the maximum, shown.
    """
    f, phi, e = np.asarray(frequencies), np.asarray(angles), np.asarray(density)
    # Close the circle.
    phi = np.append(phi, phi[0] + 2 * np.pi)
    e = np.concatenate([e, e[:, :1]], axis=1)
    top = float(np.log10(e.max()))
    levels = np.linspace(top - decades, top, 4 * int(decades) + 1)
    shown = np.log10(np.maximum(e, 10 ** (top - decades - 1)))
    colours = plt.get_cmap("viridis").with_extremes(under="white")
    filled = axes.contourf(phi, f, shown, levels=levels, cmap=colours, extend="min")
    bar = axes.figure.colorbar(
        filled, ax=axes, shrink=0.8, pad=0.1, ticks=np.arange(np.ceil(top - decades), top + 0.01)
    )
    bar.set_label(label)
    axes.set_rlabel_position(90)
    axes.tick_params(labelsize=8)
    axes.tick_params(axis="y", labelcolor="white")
    axes.set_axisbelow(False)
    axes.grid(color="white", linewidth=0.4, alpha=0.6)


def normal_colours(slope: ArrayLike) -> np.ndarray:
    """A normal map: (n + 1)/2 of the unit normal n ∝ (−∂η/∂x, −∂η/∂y, 1) as red, green, blue."""
    s = np.asarray(slope)
    normal = np.concatenate([-s, np.ones_like(s[..., :1])], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return 0.5 * (normal + 1)


def colours_for(count: int) -> Sequence[Any]:
    """Colours for `count` ordered lines, for example winds from weak to strong."""
    return [plt.get_cmap("viridis")(x) for x in np.linspace(0.05, 0.88, count)]


def outline_below(axes: Axes, values: ArrayLike, level: float, side: float) -> None:
    """Fill in black where `values[y, x]` are below `level`, on a map drawn by `field_map`."""
    below = np.ma.masked_where(np.asarray(values) >= level, np.zeros(np.shape(values)))
    axes.imshow(below, extent=(0, side, 0, side), cmap="gray", norm=Normalize(0, 1), interpolation="nearest")
