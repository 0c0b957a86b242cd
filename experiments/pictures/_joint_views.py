"""Picture and data of `joint_targets`."""

from collections.abc import Sequence

import numpy as np

import fitting

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable

LEVEL = 0.9


def plot(store: Files, config: schema.JointTargetsConfig, objectives: Sequence, picture) -> None:
    """`joint.png`: where ε and λ may lie, and the profile of λ, for each objective; what a picture leaves, enlarged."""
    colours = _plots.ORANGE, _plots.BLUE, _plots.VERMILION
    with _plots.figure(1, 2, size=(11.0, 4.8)) as (fig, axes):
        near = axes[0].inset_axes((0.09, 0.1, 0.36, 0.36)), axes[1].inset_axes((0.07, 0.6, 0.24, 0.35))
        for region, profile in (axes, near):
            for each, colour in zip(objectives, colours, strict=True):
                label = f"{each.name} (correlation {each.correlation:+.2f})"
                region.plot(*_ellipse(each, each.told), color=colour, label=label)
                root = np.sqrt(np.maximum(each.profile.excess, 0))
                profile.plot(each.profile.grid, root, marker=".", color=colour, label=each.name)
            label = f"picture alone (correlation {picture.correlation:+.2f})"
            region.plot(*_ellipse(picture, picture.told), color=_plots.GREEN, ls="--", label=label)
            joint = objectives[-1]
            region.plot(
                *_ellipse(joint, joint.covariance),
                color=_plots.VERMILION,
                ls=":",
                label=f"with renderers in doubt ({joint.correlation_in_doubt:+.2f})",
            )
            region.plot(config.choppiness, config.threshold, "+", color=_plots.BLACK, ms=10, label="truth")
            limit = float(np.sqrt(fitting.profile_limit(LEVEL)))
            profile.axhline(limit, color=_plots.GREY, linestyle=":", label=f"{100 * LEVEL:g} % interval")
        axes[0].set(
            xlabel="choppiness λ (-)", ylabel="threshold ε (-)", title=f"{100 * LEVEL:g} % regions of ε and λ"
        )
        axes[0].legend(loc="upper right")
        axes[1].set(
            xlabel="choppiness λ (-)",
            ylabel="√(twice the cost above its least) (-)",
            title="Profile of λ",
            ylim=(0, 4.2),
        )
        axes[1].legend(loc="lower right")
        _enlarge(near, objectives[-1], picture, config)
        axes[0].indicate_inset_zoom(near[0])
        store.picture("joint", fig)


def _enlarge(near, joint, picture, config: schema.JointTargetsConfig) -> None:
    """Limits around what a picture leaves."""
    shown = np.concatenate(
        [
            _ellipse(joint, joint.told),
            _ellipse(picture, picture.told),
            [[config.choppiness], [config.threshold]],
        ],
        axis=1,
    )
    low, high = shown.min(axis=1), shown.max(axis=1)
    room = 0.15 * (high - low)
    near[0].set(xlim=(low[0] - room[0], high[0] + room[0]), ylim=(low[1] - room[1], high[1] + room[1]))
    grid, highest = joint.profile.grid, np.sqrt(max(np.nanmax(joint.profile.excess), 1.0))
    near[1].set(xlim=(grid[0], grid[-1]), ylim=(0, 1.05 * highest))
    for axis in near:
        axis.tick_params(labelsize=7)
        axis.locator_params(nbins=3)


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
