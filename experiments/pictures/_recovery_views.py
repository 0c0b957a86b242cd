"""Pictures and data of `picture_recovery`."""

import re
from collections.abc import Sequence

import jax.numpy as jnp
import numpy as np

from jaxocean import optics

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable
from . import _scene
from ._recovery_scenes import Number, half_width, numbers

DARKEST = 2.0
"""Difference [stops] that has the darkest colour."""


def plot(store: Files, config: schema.PictureRecoveryConfig, recoveries: Sequence) -> None:
    """`recovered.png`: how far off each number is, with its interval."""
    found = [each for each in recoveries if not each.failure]
    sought = numbers(config)
    columns = -(-len(sought) // 2)
    with _plots.figure(2, columns, size=(3.6 * columns, 6.2)) as (fig, axes):
        for place, number in enumerate(sought):
            _one(axes.flat[place], config, found, place, number)
        for axis in axes.flat[len(sought) :]:
            axis.axis("off")
        axes[0, 0].legend(loc="best")
        store.picture("recovered", fig)


def _one(axis, config: schema.PictureRecoveryConfig, found: Sequence, place: int, number: Number) -> None:
    truth = np.asarray([each.truth[place] for each in found])
    rays = np.asarray([each.rays for each in found], bool)
    off = np.asarray([each.found[place] for each in found]) - truth
    error = half_width(config.level) * np.asarray([each.errors[place] for each in found])
    for drawn, colour, label in (
        (rays, _plots.BLUE, "drawn by rays"),
        (~rays, _plots.ORANGE, "by a fine mesh"),
    ):
        axis.errorbar(
            truth[drawn], off[drawn], yerr=error[drawn], fmt="o", ms=4, lw=1.2, color=colour, label=label
        )
    axis.axhline(0, color=_plots.GREY, lw=1)
    if number.bound is not None and truth.size:
        most, relative = number.bound
        line = np.linspace(truth.min(), truth.max(), 50)
        width = most * (np.abs(line) if relative else np.ones_like(line))
        axis.fill_between(line, -width, width, color=_plots.GREY, alpha=0.15, lw=0, label="asked")
        _mark_beyond(axis, truth, off, 1.7 * float(width.max()))
    unit = "" if number.unit == "-" else f" ({number.unit})"
    axis.set(xlabel=f"true {number.name}{unit}", ylabel=f"found − true{unit}")
    axis.set_title(number.name.capitalize())


def _mark_beyond(axis, truth: np.ndarray, off: np.ndarray, edge: float) -> None:
    """Limits of the axis, and at them, with its number, what another valley leaves farther off.

    Of an interval that is wider it is enough to see that it is.
    """
    axis.set_ylim(-edge, edge)
    for true, each in zip(truth, off, strict=True):
        if abs(each) > edge:
            side = np.sign(each)
            axis.plot(
                true,
                0.93 * side * edge,
                "^" if side > 0 else "v",
                ms=6,
                color=_plots.VERMILION,
                clip_on=False,
            )
            axis.annotate(
                f"{each:+.2g}",
                (true, 0.93 * side * edge),
                xytext=(7, 0),
                textcoords="offset points",
                va="center",
                fontsize=9,
                color=_plots.VERMILION,
            )


def show(store: Files, pictures: Sequence[Sequence[np.ndarray]], recoveries: Sequence) -> None:
    """`pictures.png`: target, start, what was found, and what remains between them."""
    if not pictures:
        return
    height, width, _ = pictures[0][0].shape
    wide = 3.3
    size = (4 * wide + 0.6, len(pictures) * (wide * height / width + 0.35))
    with _plots.figure(len(pictures), 4, size=size, squeeze=False) as (fig, axes):
        for row, images, each in zip(axes, pictures, recoveries, strict=False):
            target, start, found = images
            words = "rays" if each.rays else "fine mesh"
            titles = f"Target ({words}), {each.truth[0]:.1f} m/s", f"Start, {each.start[0]:.1f} m/s"
            for axis, image, title in zip(
                row, (target, start, found), (*titles, f"Found, {each.found[0]:.2f} m/s"), strict=False
            ):
                axis.imshow(_scene.shown(image, target), origin="upper", interpolation="antialiased")
                axis.set_title(title, fontsize=10)
            luminance = [np.asarray(optics.luminance(jnp.asarray(image))) for image in (found, target)]
            stops = np.log2(np.maximum(luminance[0], 1e-9) / np.maximum(luminance[1], 1e-9))
            shown = row[3].imshow(
                stops, origin="upper", cmap="RdBu_r", vmin=-DARKEST, vmax=DARKEST, interpolation="antialiased"
            )
            row[3].set_title("Found over target", fontsize=10)
            fig.colorbar(shown, ax=row[3], label="stops", shrink=0.9, extend="both")
        for axis in axes.flat:
            axis.axis("off")
        store.picture("pictures", fig)


def save(store: Files, config: schema.PictureRecoveryConfig, recoveries: Sequence) -> None:
    """`recovered.nc`: truths, starts, what was found, and its errors."""
    variables = {}
    for place, number in enumerate(numbers(config)):
        name = number.name
        units = {"-": "1", "stops": "1"}.get(number.unit, number.unit.replace("/s", " s-1"))
        for kind in ("truth", "start", "found", "errors"):
            values = np.asarray([getattr(each, kind)[place] for each in recoveries])
            words = {"errors": "standard error", "found": "found"}.get(kind, kind)
            stops = " in stops" if number.unit == "stops" else ""
            variables[f"{re.sub('[ .]', '_', name)}_{kind}"] = variable(
                "sea", values, units=units, long_name=f"{name}, {words}{stops}"
            )
    for name, unit, words in (
        ("coverage", "1", "whitecap coverage of the whole plane"),
        ("seconds", "s", "time of the fit"),
        ("steps", "1", "steps that lowered the cost"),
    ):
        values = np.asarray([getattr(each, name) for each in recoveries], float)
        variables[name] = variable("sea", values, units=unit, long_name=words)
    store.data("recovered", variables, title="Seas found again in pictures of them")
