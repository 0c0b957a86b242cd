"""Pictures and data of `fit_image`."""

from collections.abc import Sequence

import jax
import numpy as np

from fitting.pictures import PhotographFit

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable
from . import _scene
from ._photographs import FREE, UNITS, WIND, drawn
from ._taken import Taken


def plot(store: Files, config: schema.FitImageConfig, taken: Taken, found: PhotographFit) -> None:
    """`fitted.png`: the image beside a picture of the state found."""
    low, high = found.interval(WIND, config.inference.level)
    titles = (
        "The image",
        f"A sea of the state found: U10 {found.values[WIND]:.1f} ({low:.1f} to {high:.1f}) m/s",
    )
    with _plots.figure(1, 2, size=(12.0, 12.0 * 0.5 * taken.shown.shape[0] / taken.shown.shape[1] + 0.5)) as (
        fig,
        axes,
    ):
        beside(axes, taken.shown, found_picture(found), titles)
        store.picture("fitted", fig)


def found_picture(found: PhotographFit) -> np.ndarray:
    """A picture of the state found, of twice as many rows and columns as were compared."""
    rows, columns = found.size
    return np.asarray(jax.block_until_ready(drawn(found.model, (2 * rows, 2 * columns))))


def beside(axes: Sequence, image: np.ndarray, picture: np.ndarray, titles: Sequence[str]) -> None:
    """An image and a picture next to each other, each exposed for itself."""
    for axis, light, title in zip(axes, (image, picture), titles, strict=True):
        axis.imshow(_scene.shown(light, light), origin="upper", interpolation="antialiased", aspect="equal")
        axis.set_title(title, fontsize=10)
        axis.axis("off")


def pairs(store: Files, parts: Sequence[tuple[np.ndarray, np.ndarray, Sequence[str]]]) -> None:
    """`pictures.png`: images and, beside each, a picture of the state found in it."""
    if not parts:
        return
    across = 2 if len(parts) > 1 else 1
    rows = -(-len(parts) // across)
    height = 3.2 * max(image.shape[0] / image.shape[1] for image, _, _ in parts) + 0.3
    with _plots.figure(rows, 2 * across, size=(6.4 * across, rows * height), squeeze=False) as (fig, axes):
        for axis in axes.flat:
            axis.axis("off")
        for number, (image, picture, titles) in enumerate(parts):
            row, place = divmod(number, across)
            beside(axes[row, 2 * place : 2 * place + 2], image, picture, titles)
        store.picture("pictures", fig)


def strip(store: Files, taken: Taken, frames: Sequence[tuple[str, np.ndarray]], found: PhotographFit) -> None:
    """`filmstrip.png`: the image, and pictures of the states on the way, with the same waves."""
    pictures = [("the image", taken.light), *frames]
    columns = 4
    rows = -(-len(pictures) // columns)
    height = 3.2 * found.size[0] / found.size[1] + 0.3
    with _plots.figure(rows, columns, size=(3.2 * columns, rows * height), squeeze=False) as (fig, axes):
        for axis in axes.flat:
            axis.axis("off")
        for axis, (title, light) in zip(axes.flat, pictures, strict=False):
            axis.imshow(
                _scene.shown(light, light), origin="upper", interpolation="antialiased", aspect="equal"
            )
            axis.set_title(title, fontsize=9)
        store.picture("filmstrip", fig)


def plot_statistics(store: Files, found: PhotographFit) -> None:
    """`statistics.png`: what the image says and what the state found predicts, in standard deviations of chance."""
    used = found.chance > 1e-9
    off = (found.observed - found.predicted)[used] / found.chance[used]
    names = [name for name, on in zip(found.names, used, strict=True) if on]
    shown = np.clip(off, -8.0, 8.0)
    place = np.arange(len(names))
    with _plots.figure(size=(7.5, 0.17 * len(names) + 1.2)) as (fig, axis):
        axis.axvspan(-2, 2, color=_plots.GREY, alpha=0.15, lw=0, label="95 % of pictures of that state")
        axis.hlines(place, 0.0, shown, color=_plots.BLUE, lw=1.2)
        axis.plot(shown, place, "o", ms=4, color=_plots.BLUE)
        axis.axvline(0, color=_plots.GREY, lw=1)
        axis.set_yticks(place, names, fontsize=7)
        axis.set(
            xlabel="image − model (standard deviations of one picture)",
            xlim=(-8.5, 8.5),
            ylim=(len(names), -1),
        )
        axis.set_title(f"What the image says (misfit {found.misfit:.2g})")
        fig.legend(loc="outside lower center")
        store.picture("statistics", fig)


def save(store: Files, found: PhotographFit) -> None:
    """`statistics.nc`: the statistics, and the numbers found with their covariance."""
    words = {
        "observed": "of the image",
        "predicted": "mean of the state found",
        "chance": "standard deviation",
    }
    variables = {
        kind: variable("statistic", getattr(found, kind), units="1", long_name=f"statistics, {text}")
        for kind, text in words.items()
    }
    for label, name, unit in zip(found.labels, FREE, UNITS, strict=True):
        units = {"-": "1"}.get(unit, unit.replace("/s", " s-1"))
        variables[label] = variable("", found.values[label], units=units, long_name=name)
    coordinates = {
        "statistic": variable("statistic", list(found.names), units="1", long_name="what is counted")
    }
    coordinates["statistic"].attrs.pop("units")
    store.data("statistics", variables, coordinates, title="A photograph of the sea and what was found in it")
