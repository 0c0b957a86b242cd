"""Pictures and data of `wave_recovery`."""

from collections.abc import Sequence

import numpy as np

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable
from . import _scene


def plot(
    store: Files,
    config: schema.WaveRecoveryConfig,
    height: np.ndarray,
    found: Sequence,
    pictures: Sequence[np.ndarray],
) -> None:
    """`waves.png`: heights, errors, and how much of the waves is found by their length; `pictures.png`."""
    columns = 1 + len(found)
    reach = 100 * float(np.quantile(np.abs(height - height.mean()), 0.998))
    worst = max(float(np.quantile(np.abs(off(each.height, height)), 0.995)) for each in found)
    with _plots.figure(2, columns, size=(4.1 * columns, 7.2), squeeze=False) as (fig, axes):
        options = {"label": "height (cm)", "limits": (-reach, reach)}
        _plots.field_map(axes[0, 0], 100 * (height - height.mean()), config.side, **options)
        axes[0, 0].set_title("Truth")
        for column, each in enumerate(found, 1):
            words = f"{each.views} picture{'s' if each.views > 1 else ''}"
            mean = each.height.mean()
            _plots.field_map(axes[0, column], 100 * (each.height - mean), config.side, **options)
            axes[0, column].set_title(f"From {words}")
            _plots.field_map(
                axes[1, column],
                100 * off(each.height, height),
                config.side,
                label="found − true (cm)",
                colours="PuOr",
                limits=(-100 * worst, 100 * worst),
            )
            axes[1, column].set_title(f"Error, {words}")
        _by_length(axes[1, 0], config.side, height, found)
        store.picture("waves", fig)
    wide = 3.6
    across = len(pictures)
    size = (wide * across, wide * config.height / config.width + 0.35)
    with _plots.figure(1, across, size=size, squeeze=False) as (fig, axes):
        for number, (axis, image) in enumerate(zip(axes.flat, pictures, strict=True), 1):
            axis.imshow(_scene.shown(image, image), origin="upper", interpolation="antialiased")
            axis.set_title(f"Picture {number}", fontsize=10)
            axis.axis("off")
        store.picture("pictures", fig)


def off(found: np.ndarray, height: np.ndarray) -> np.ndarray:
    """What is wrong, but for the mean, which no picture of a patch tells."""
    return (found - found.mean()) - (height - height.mean())


def variance_by_length(height: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths [m] of half-octave bands, and the variance [m²] of the height in each."""
    count = len(height)
    power = np.abs(np.fft.fft2(height) / count**2) ** 2
    number = np.fft.fftfreq(count, 1 / count)
    k = np.hypot(number[:, None], number[None, :])
    edges = np.geomspace(0.8, count / 2, int(2 * np.log2(count / 1.6)) + 1)
    band = np.digitize(k.ravel(), edges)
    sums = np.bincount(band, power.ravel(), len(edges) + 1)[1:-1]
    return side / np.sqrt(edges[1:] * edges[:-1]), sums


def _by_length(axis, side: float, height: np.ndarray, found: Sequence) -> None:
    length, whole = variance_by_length(height, side)
    seen = whole > 0
    for each in found:
        _, wrong = variance_by_length(off(each.height, height), side)
        label = f"{each.views} picture{'s' if each.views > 1 else ''}"
        axis.plot(length[seen], np.sqrt(wrong[seen] / whole[seen]), marker="o", ms=4, label=label)
    axis.axhline(1, color=_plots.GREY, linestyle="--", label="nothing known")
    axis.set(
        xscale="log",
        yscale="log",
        xlabel="wavelength (m)",
        ylabel="rms error / rms height (-)",
        title="By the length of the waves",
    )
    axis.legend()


def save(store: Files, config: schema.WaveRecoveryConfig, height: np.ndarray, found: Sequence) -> None:
    """`waves.nc`: the true height and those that were found."""
    place = (np.arange(len(height)) + 0.0) * config.side / len(height)
    store.data(
        "waves",
        {
            "height": variable(("y", "x"), height, units="m", long_name="true height of the surface"),
            "found": variable(
                ("views", "y", "x"),
                np.stack([each.height for each in found]),
                units="m",
                long_name="height of the surface from so many pictures",
            ),
        },
        {
            "x": variable("x", place, units="m", long_name="x"),
            "y": variable("y", place, units="m", long_name="y"),
            "views": variable(
                "views", np.asarray([each.views for each in found]), units="1", long_name="number of pictures"
            ),
        },
        title="Waves recovered from pictures",
    )
