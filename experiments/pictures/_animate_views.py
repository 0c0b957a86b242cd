"""Pictures and data of `animate`."""

from collections.abc import Sequence
from pathlib import Path

import imageio.v3 as imageio
import numpy as np

from ..common import _plots
from ..harness._files import Files, variable
from ._animate_report import Found
from ._path import Place

SHOWN = 6
"""Frames in the overview, at most."""


def plot(store: Files, found: Found, pictures: Sequence[Path]) -> None:
    """`sequence.png`: some frames, the coverage over time, and the flicker by image row."""
    some = np.unique(np.linspace(0, len(pictures) - 1, SHOWN).round().astype(int))
    images = {f"frame {i}": imageio.imread(pictures[i]) for i in some}
    names = list(images)
    per_row = max(1, (len(names) + 1) // 2)
    strip = [names[:per_row], (names[per_row:] + ["."] * per_row)[:per_row]]
    curves = [["coverage"] * per_row] + ([["flicker"] * per_row] if found.flicker else [])
    height, width, _ = next(iter(images.values())).shape
    tall = 3.6 * height / width * 3 / per_row
    sizes = [tall, tall if len(names) > 1 else 0.01, *[2.6] * len(curves)]
    layout = [*strip, *curves] if len(names) > 1 else [strip[0], *curves]
    sizes = sizes if len(names) > 1 else [sizes[0], *sizes[2:]]
    with _plots.mosaic(layout, size=(10.8, sum(sizes)), gridspec_kw={"height_ratios": sizes}) as (fig, axes):
        for i, (name, image) in zip(some, images.items(), strict=True):
            axes[name].imshow(image, origin="upper", interpolation="antialiased")
            axes[name].set_title(f"{found.time[i]:.2f} s, from {found.place[i, 2]:.3g} m", fontsize=9)
            axes[name].axis("off")
        _coverage(axes["coverage"], found)
        if found.flicker:
            _flicker(axes["flicker"], found)
        store.picture("sequence", fig)


def _coverage(axes, found: Found) -> None:
    for name, numbers in found.numbers.items():
        axes.plot(found.time, 100 * numbers["coverage"], label=f"seen, {name}", marker=".")
    axes.axhline(100 * found.plane, color=_plots.GREY, linestyle="--", label="whole plane")
    axes.set(xlabel="time (s)", ylabel="coverage (%)", title="Whitecaps in view", ylim=(0, None))
    axes.legend(ncols=4)


def _flicker(axes, found: Found) -> None:
    for name, rows in found.flicker.items():
        axes.plot(np.arange(rows.size), rows, label=name)
    for name, rows in found.error.items():
        axes.plot(np.arange(rows.size), rows, linestyle=":", label=f"{name}, error")
    axes.set(
        xlabel="row of the image, from above",
        ylabel="flicker (1/255)",
        title="Second difference from frame to frame, root-mean-square",
        ylim=(0, None),
    )
    axes.legend(ncols=2)


def save(store: Files, found: Found) -> None:
    """`sequence.nc`: numbers of every frame."""
    own = found.numbers["filtered"]
    variables = {
        "coverage": variable("time", own["coverage"], units="1", long_name="coverage of the sea in view"),
        "sea_share": variable("time", own["sea"], units="1", long_name="share of the picture that is sea"),
        "exposure": variable("time", own["exposure"], units="1", long_name="factor of the light"),
        "render_time": variable("time", own["seconds"], units="s", long_name="time to render the frame"),
    }
    for name in set(found.numbers) - {"filtered"}:
        values = found.numbers[name]["coverage"]
        variables[f"coverage_{name}"] = variable(
            "time", values, units="1", long_name=f"coverage of the sea in view, {name}"
        )
    units = {"x": "m", "y": "m", "height": "m"}
    for column, name in enumerate(Place._fields):
        variables[f"camera_{name}"] = variable(
            "time",
            found.place[:, column],
            units=units.get(name, "rad"),
            long_name=f"{name.replace('_', ' ')} of the camera",
        )
    for name, rows in found.flicker.items():
        variables[f"flicker_{name}"] = variable(
            "row", rows / 255, units="1", long_name=f"second difference of code values in time, {name}"
        )
    store.data(
        "sequence",
        variables,
        {"time": variable("time", found.time, units="s", long_name="time of the sea")},
        title="A sequence of pictures of the sea",
        attributes={"coverage_of_the_plane": found.plane},
    )
