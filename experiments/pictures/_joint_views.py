"""Picture and data of `joint_targets`."""

from collections.abc import Sequence

import numpy as np

import fitting

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable

LEVEL = 0.9


def plot(store: Files, config: schema.JointTargetsConfig, objectives: Sequence, picture) -> None:
    """`joint.png`: where ε and λ may lie, and the profile of λ, for each objective."""
    colours = _plots.ORANGE, _plots.BLUE, _plots.VERMILION
    with _plots.figure(1, 2, size=(11.0, 4.6)) as (fig, axes):
        for each, colour in zip(objectives, colours, strict=True):
            label = f"{each.name} (correlation {each.correlation:+.2f})"
            axes[0].plot(*_ellipse(each, each.told), color=colour, label=label)
            if each.doubted is not None:
                axes[0].plot(
                    *_ellipse(each, each.covariance), color=colour, ls=":", label="with renderers in doubt"
                )
            root = np.sqrt(np.maximum(each.profile.excess, 0))
            axes[1].plot(each.profile.grid, root, marker=".", color=colour, label=each.name)
        label = f"picture alone (correlation {picture.correlation:+.2f})"
        axes[0].plot(*_ellipse(picture, picture.told), color=_plots.GREEN, linestyle="--", label=label)
        axes[0].plot(config.choppiness, config.threshold, "+", color=_plots.BLACK, ms=10, label="truth")
        axes[0].set(
            xlabel="choppiness λ (-)", ylabel="threshold ε (-)", title=f"{100 * LEVEL:g} % regions of ε and λ"
        )
        axes[0].legend(loc="best")
        limit = float(np.sqrt(fitting.profile_limit(LEVEL)))
        axes[1].axhline(limit, color=_plots.GREY, linestyle=":", label=f"{100 * LEVEL:g} % interval")
        axes[1].set(
            xlabel="choppiness λ (-)",
            ylabel="√(twice the cost above its least) (-)",
            title="Profile of λ",
            ylim=(0, 4.2),
        )
        axes[1].legend(loc="best")
        store.picture("joint", fig)


def _ellipse(each, covariance: np.ndarray) -> np.ndarray:
    """Where a Gaussian of this covariance has its contour, λ and ε."""
    angle = np.linspace(0, 2 * np.pi, 200)
    # The quantile of χ² with two degrees of freedom.
    radius = np.sqrt(-2 * np.log(1 - LEVEL))
    values, vectors = np.linalg.eigh(covariance)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    threshold, choppiness = each.values[:, None] + radius * vectors @ (
        np.sqrt(np.maximum(values, 0))[:, None] * circle
    )
    return np.stack([choppiness, threshold])


def save(store: Files, objectives: Sequence, picture) -> None:
    """`joint.nc`: values and covariances of ε and λ, and the profiles."""
    every = [*objectives, picture]
    variables = {
        "found": variable(
            ("objective", "number"),
            np.stack([each.values for each in every]),
            units="1",
            long_name="threshold and choppiness",
        ),
        "covariance": variable(
            ("objective", "number", "other"),
            np.stack([each.covariance for each in every]),
            units="1",
            long_name="covariance of threshold and choppiness",
        ),
    }
    for number, each in enumerate(objectives):
        axis = f"point_{number}"
        variables[f"choppiness_{number}"] = variable(
            axis, each.profile.grid, units="1", long_name=f"choppiness of the profile with {each.name}"
        )
        variables[f"excess_{number}"] = variable(
            axis, each.profile.excess, units="1", long_name=f"twice the cost above its least with {each.name}"
        )
    names = np.asarray([each.name for each in every])
    store.data(
        "joint",
        variables,
        {"objective": variable("objective", names, units="1", long_name="what was fitted")},
        title="What targets say of threshold and choppiness",
    )
