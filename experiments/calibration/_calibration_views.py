"""The picture of `calibrate_monahan`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import numpy as np

import fitting

from .. import schema
from ..common import _build, _plots
from ..harness._files import Files

COLOURS = {"exact": _plots.BLUE, "gaussian": _plots.VERMILION}
MARKS = ("o", "s", "^", "D", "v", "P", "X", "*", "<", ">", "h", "d")


@dataclass(frozen=True)
class View:
    """What is to be shown."""

    config: schema.CalibrationConfig
    calibrations: Mapping[str, Any]
    table: Mapping[str, Sequence[tuple[float, float, float, float]]]
    check: Any

    @cached_property
    def coverage(self) -> dict[str, np.ndarray]:
        """W of each closure's shared fit at the config's winds."""
        return {name: fitted_coverage(self.config, one.shared) for name, one in self.calibrations.items()}

    @cached_property
    def spread(self) -> dict[str, np.ndarray]:
        """Standard error of ln W of each closure's shared fit at the config's winds; NaN if only points were fitted."""
        unknown = np.full(len(self.config.wind.speed), np.nan)
        return {
            name: np.log(10) * one.shared.targets[0].error if self.config.laws else unknown
            for name, one in self.calibrations.items()
        }


def fitted_coverage(config: schema.CalibrationConfig, fit: fitting.Fit) -> np.ndarray:
    """W of a fitted model at the config's winds."""
    if config.laws:
        # The first target is a law at these very winds.
        return 10 ** fit.targets[0].predicted
    with jax.enable_x64(True):
        return np.asarray(
            [float(fit.model.coverage(_build.wind(config.wind, speed=u))) for u in config.wind.speed]
        )


def band_name(config: schema.CalibrationConfig) -> str:
    """Which waves count."""
    lower, upper = config.band or _build.cascade(config.cascade).band
    return f"k = {lower:.3g}–{upper:.3g} rad/m"


def table_choppiness(config: schema.CalibrationConfig) -> float:
    """λ of the table of ε against k_b: the centre of its prior, or its value where it is not fitted."""
    return config.choppiness_prior.mean if config.free.choppiness else config.choppiness


def per_wind_threshold(fit: fitting.Fit, speeds: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """ε and its error at the given winds, NaN where a wind was no target."""
    value, error = (np.full(len(speeds), np.nan) for _ in range(2))
    known = {round(float(u), 9): i for i, u in enumerate(fit.winds)}
    for position, speed in enumerate(speeds):
        index = known.get(round(float(speed), 9))
        if index is not None:
            value[position] = np.ravel(fit.values["threshold"])[index]
            error[position] = np.ravel(fit.errors["threshold"])[index]
    return value, error


def plot(store: Files, view: View) -> None:
    """Coverage, residuals, ε(U10) and ε(k_b) in one figure."""
    with _plots.figure(2, 2, size=(10.5, 7.6), title=_title(view)) as (fig, axes):
        _plot_coverage(axes[0, 0], view)
        _plot_residuals(axes[0, 1], view)
        _plot_thresholds(axes[1, 0], view)
        _plot_limits(axes[1, 1], view)
        store.picture("calibration", fig)


def _title(view: View) -> str:
    fit = view.calibrations["exact"].shared
    parts = [f"ε = {fit.values['threshold']:.3f}"]
    if "choppiness" in fit.values:
        parts.append(f"λ = {fit.values['choppiness']:.3f}")
    return f"One sea for all winds: {', '.join(parts)} ({view.config.measure} area, {band_name(view.config)})"


def _plot_coverage(ax, view: View) -> None:
    speeds = np.asarray(view.config.wind.speed)
    for mark, target in zip(MARKS, view.calibrations["exact"].shared.targets, strict=False):
        ax.plot(
            target.speeds, 10**target.observed, mark, color=_plots.BLACK, mfc="none", ms=6, label=target.name
        )
    for name, style in (("exact", "-"), ("gaussian", "--")):
        if name == "exact":
            # One band is enough to see: the other is as wide.
            factor = np.exp(view.spread[name])
            band = (view.coverage[name] / factor, view.coverage[name] * factor)
            ax.fill_between(
                speeds, *band, color=COLOURS[name], alpha=0.25, lw=0, label="± its standard error"
            )
        ax.plot(speeds, view.coverage[name], style, color=COLOURS[name], label=f"{name} closure, fitted")
    if view.check is not None:
        ax.errorbar(
            speeds,
            view.check.counted,
            3 * view.check.error,
            fmt=".",
            color=_plots.GREEN,
            capsize=3,
            ms=4,
            label=f"{view.config.realisations} FFT seas, ± 3 SE",
        )
    ax.set(yscale="log", xlabel="wind speed U10 (m/s)", ylabel="whitecap coverage W (-)", title="Coverage")
    ax.legend()


def _plot_residuals(ax, view: View) -> None:
    for name, shape in (("exact", "o-"), ("gaussian", "s--")):
        for i, target in enumerate(view.calibrations[name].shared.targets):
            label = f"{name}, RMS {target.rms:.2f}" if i == 0 else None
            order = np.argsort(target.speeds)
            ax.plot(
                target.speeds[order], target.residuals[order], shape, color=COLOURS[name], alpha=1 / (1 + 0.5 * i),
                ms=4, label=label,
            )  # fmt: skip
    ax.axhline(0, color=_plots.GREY, lw=1)
    ax.set(
        xlabel="wind speed U10 (m/s)", ylabel="log10 W(fit) − log10 W(law)", title="What one ε cannot match"
    )
    ax.legend()


def _plot_thresholds(ax, view: View) -> None:
    speeds = np.asarray(view.config.wind.speed)
    for name, shape in (("exact", "o-"), ("gaussian", "s--")):
        calibration = view.calibrations[name]
        value, error = per_wind_threshold(calibration.per_wind, view.config.wind.speed)
        ax.errorbar(
            speeds, value, error, fmt=shape, color=COLOURS[name], ms=4, capsize=3, label=f"{name}, each wind"
        )
        ax.axhline(calibration.shared.values["threshold"], color=COLOURS[name], lw=1, ls=":")
    ax.plot([], [], color=_plots.GREY, lw=1, ls=":", label="one for all winds")
    ax.set(
        xlabel="wind speed U10 (m/s)", ylabel="breaking threshold ε (-)", title="A threshold for each wind"
    )
    ax.legend()


def _plot_limits(ax, view: View) -> None:
    for (measure, rows), shape in zip(view.table.items(), ("o-", "s--"), strict=True):
        if rows:
            k, value, error, _ = (np.asarray(column) for column in zip(*rows, strict=True))
            ax.errorbar(k, value, error, fmt=shape, ms=4, capsize=3, label=f"{measure} area")
    if any(view.table.values()):
        ax.set_xscale("log")
        ticks = [row[0] for row in view.table["projected"]]
        ax.set_xticks(ticks, [f"{k:g}" for k in ticks])
        ax.minorticks_off()
        ax.legend()
    lam = table_choppiness(view.config)
    ax.set(
        xlabel="breaking wavenumber k_b (rad/m)",
        ylabel="breaking threshold ε (-)",
        title=f"ε means nothing without its band (λ = {lam:g})",
    )
