"""Pictures and data of `flyover`."""

from collections.abc import Sequence

import numpy as np

from ..common import _plots
from ..harness._files import Files, variable
from ._flyover_report import standard_error

PER_ROW = 4


def plot(store: Files, levels: Sequence, plane: float) -> None:
    """`heights.png`, what is seen; `flyover.png`, what it costs, and the whitecaps."""
    _sheet(store, levels)
    with _plots.figure(1, 2, size=(10.8, 4.0)) as (fig, axes):
        _cost(axes[0], levels)
        _coverage(axes[1], levels, plane)
        store.picture("flyover", fig)


def _sheet(store: Files, levels: Sequence) -> None:
    columns = min(PER_ROW, len(levels))
    rows = -(-len(levels) // columns)
    height, width, _ = levels[0].picture.shape
    wide = 3.6
    with _plots.figure(
        rows, columns, size=(wide * columns, rows * (wide * height / width + 0.3)), squeeze=False
    ) as (fig, axes):
        for axis in axes.flat:
            axis.axis("off")
        for axis, level in zip(axes.flat, levels, strict=False):
            axis.imshow(level.picture, origin="upper", interpolation="antialiased")
            axis.set_title(f"{level.height:,.{1 if level.height < 10 else 0}f} m", fontsize=10)
        store.picture("heights", fig)


def _cost(axes, levels: Sequence) -> None:
    footprints = [level.footprint for level in levels]
    median = np.asarray([1e3 * np.median(level.seconds) for level in levels])
    least = np.asarray([1e3 * np.min(level.seconds) for level in levels])
    most = np.asarray([1e3 * np.max(level.seconds) for level in levels])
    axes.errorbar(footprints, median, yerr=(median - least, most - median), marker="o", capsize=3)
    axes.axhspan(0.7 * median.mean(), 1.3 * median.mean(), color=_plots.GREY, alpha=0.15, label="mean ± 30 %")
    axes.set(
        xscale="log",
        xlabel="side of a pixel's footprint on the sea, median (m)",
        ylabel="time per frame (ms)",
        title="Cost: median, least, most",
        ylim=(0, None),
    )
    axes.legend()


def _coverage(axes, levels: Sequence, plane: float) -> None:
    heights = [level.height for level in levels]
    mean = np.asarray([100 * np.mean(level.coverage) for level in levels])
    error = np.asarray([100 * standard_error(level.coverage) for level in levels])
    axes.errorbar(heights, mean, yerr=np.nan_to_num(error), marker="o", capsize=3, label="seen, ± its error")
    axes.axhline(100 * plane, color=_plots.GREY, linestyle="--", label="whole plane")
    axes.set(
        xscale="log",
        xlabel="height above the water (m)",
        ylabel="coverage (%)",
        title="Whitecaps in view",
        ylim=(0, None),
    )
    axes.legend()


def save(store: Files, levels: Sequence, plane: float) -> None:
    """`flyover.nc`: every frame's time and coverage."""
    axes = ("height", "frame")
    store.data(
        "flyover",
        {
            "render_time": variable(
                axes, np.stack([level.seconds for level in levels]), units="s", long_name="time per frame"
            ),
            "coverage": variable(
                axes,
                np.stack([level.coverage for level in levels]),
                units="1",
                long_name="whitecap coverage of the sea in view, mean over its pixels",
            ),
            "footprint": variable(
                "height",
                np.asarray([level.footprint for level in levels]),
                units="m",
                long_name="side of the square as large as the median footprint of a pixel",
            ),
        },
        {
            "height": variable(
                "height",
                np.asarray([level.height for level in levels]),
                units="m",
                long_name="height of the camera above the water below it",
            )
        },
        title="From metres to kilometres above the sea",
        attributes={"coverage_of_the_plane": plane},
    )
