"""The picture and the data of `dupuy_scenes`."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter

from .. import schema
from ..common import _plots
from ..harness._files import Files, variable
from ..schema import Scene

LEVELS = np.round(np.arange(-0.4, 0.61, 0.1), 2)
"""Thresholds at which seas are counted, besides the scene's own."""
CURVE = np.linspace(-0.4, 0.6, 101)
LOWEST = 3e-6
FEWEST = 8
"""Counts are drawn where something broke in so many seas."""

NAMES = {
    "foam": "the program's foam field",
    "jacobian": "the program's sea, true Jacobian",
    "spectrum": "the spectrum's own sea",
}
LINES: dict[str, tuple[str, str, str]] = {
    "program": ("Gaussian, the program's variance", "#F2B591", "-"),
    "gaussian": ("Gaussian, right variance", _plots.VERMILION, "--"),
    "exact": ("exact closure", _plots.BLUE, "-"),
}
WIDTHS = {"program": 4.5, "gaussian": 1.4, "exact": 1.8}
WATER, ONLY_TRUE, ONLY_FOAM, BOTH = "#1F4468", "#A9CBE3", "#E69F00", "#FFFFFF"


class Closed(NamedTuple):
    """One field without sampling. Coverages hold the scene's threshold first, then the curve."""

    printed_variance: Any
    program_variance: Any
    variance: Any
    skewness: Any
    coverage: dict[str, Any]
    projected: dict[str, Any]


class Field(NamedTuple):
    """One of the three fields of a scene, closed and counted."""

    number: int
    scene: Scene
    name: str
    closed: Closed
    rest: np.ndarray  # counted [sea, threshold], the scene's first
    projected: np.ndarray  # counted [sea]

    def at(self, formula: str) -> float:
        """Coverage at rest at the scene's threshold."""
        value = np.asarray(self.closed.coverage[formula])
        return float(value if value.ndim == 0 else value[0])

    @property
    def defined(self) -> bool:
        """Whether the variance of eq. 8 as printed is positive."""
        return bool(self.closed.printed_variance > 0)

    @property
    def counted(self) -> tuple[float, float]:
        """Coverage at rest at the scene's threshold, and its standard error."""
        return _mean(self.rest[:, 0])

    @property
    def counted_projected(self) -> tuple[float, float]:
        """Coverage seen from above at the scene's threshold, and its standard error."""
        return _mean(self.projected)


class Painted(NamedTuple):
    """Where one sea breaks [y, x]: by its true Jacobian, and in the program's foam field."""

    jacobian: np.ndarray
    foam: np.ndarray


def _mean(values: np.ndarray) -> tuple[float, float]:
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def plot(store: Files, fields: list[Field], painted: list[Painted], config: schema.DupuyScenesConfig) -> None:
    """`scenes.png`: per scene W(ε) of the program's foam field and of the true Jacobian, and a piece of its sea."""
    columns = len(config.scenes)
    size = (max(2.9 * columns + 0.6, 6.5), 9.2)
    with _plots.figure(3, columns, size=size, squeeze=False, height_ratios=(1, 1, 1.05)) as (fig, axes):
        for column, number in enumerate(config.scenes):
            for row, name in enumerate(("foam", "jacobian")):
                field = next(f for f in fields if f.number == number and f.name == name)
                _plot_coverage(axes[row, column], field, CURVE, LEVELS)
            _plot_map(axes[2, column], painted[column], config.crop)
            scene = next(f.scene for f in fields if f.number == number)
            axes[0, column].set_title(f"Scene {number}, ε = {scene.threshold:g}")
            axes[1, column].set_xlabel("breaking threshold ε (-)")
        axes[0, 0].set_ylabel("W of the foam field,\neven part (-)")
        axes[1, 0].set_ylabel("W of the same sea,\ntrue Jacobian (-)")
        dark: Any = {"color": _plots.BLACK, "marker": "o", "linestyle": ""}
        counts = f"counted on {len(fields[0].rest)} seas, ± 2 std errors"
        handles = [
            *(_line(label, colour, line, WIDTHS[name]) for name, (label, colour, line) in LINES.items()),
            Line2D([], [], markersize=4, label=counts, **dark),
            Line2D([], [], markersize=8, markerfacecolor="none", label="the scene's ε", **dark),
        ]
        foam = [
            Patch(facecolor=BOTH, edgecolor=_plots.GREY, label="map: both break"),
            Patch(facecolor=ONLY_TRUE, edgecolor="none", label="map: true Jacobian only"),
            Patch(facecolor=ONLY_FOAM, edgecolor="none", label="map: foam field only"),
        ]
        fig.legend(handles=[*handles, *foam], loc="outside lower center", ncols=4)
        store.picture("scenes", fig)


def _line(label: str, colour: str, line: Any, width: float) -> Line2D:
    return Line2D([], [], color=colour, linestyle=line, linewidth=width, label=label)


def _plot_coverage(axes: Axes, field: Field, curve: np.ndarray, levels: np.ndarray) -> None:
    for name, (_, colour, line) in LINES.items():
        coverage = np.asarray(field.closed.coverage[name])[1:]
        axes.plot(curve, coverage, linestyle=line, color=colour, linewidth=WIDTHS[name])
    often = np.count_nonzero(field.rest, axis=0) >= FEWEST
    mean, error = field.rest.mean(axis=0), field.rest.std(axis=0, ddof=1) / np.sqrt(len(field.rest))
    x = np.array([field.scene.threshold, *levels])
    style: Any = {"fmt": "o", "color": _plots.BLACK, "elinewidth": 1.0, "capsize": 1.5, "zorder": 4}
    use = often.copy()
    use[0] = False
    axes.errorbar(x[use], mean[use], yerr=2 * error[use], markersize=3, **style)
    if often[0]:
        axes.errorbar(x[:1], mean[:1], yerr=2 * error[:1], markersize=8, markerfacecolor="none", **style)
    axes.axvline(field.scene.threshold, color=_plots.GREY, linewidth=1, zorder=1)
    printed = f"eq. 8 as printed: σ² = {float(field.closed.printed_variance):.2f}"
    printed += "" if field.defined else "\nundefined"
    axes.annotate(printed, (0.97, 0.04), xycoords="axes fraction", ha="right", fontsize=8, color=_plots.BLACK)
    axes.set(yscale="log", ylim=(LOWEST, 1), xlim=(curve[0], curve[-1]))
    axes.yaxis.set_major_locator(LogLocator(numticks=8))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _plot_map(axes: Axes, painted: Painted, side: float) -> None:
    colours = np.empty((*painted.foam.shape, 3))
    colours[...] = to_rgb(WATER)
    colours[painted.jacobian & ~painted.foam] = to_rgb(ONLY_TRUE)
    colours[painted.foam & ~painted.jacobian] = to_rgb(ONLY_FOAM)
    colours[painted.foam & painted.jacobian] = to_rgb(BOTH)
    _plots.picture_map(axes, colours, side)


def save(store: Files, fields: list[Field], config: schema.DupuyScenesConfig) -> None:
    """`scenes.nc`: every number of every field of every scene."""

    def column(of: Callable[[Field], float]) -> np.ndarray:
        return np.array([of(field) for field in fields]).reshape(len(config.scenes), len(NAMES))

    rest, above = "coverage of the plane at rest", "coverage seen from above"
    numbers: dict[str, tuple[Callable[[Field], float], str]] = {
        "printed_variance": (lambda f: float(f.closed.printed_variance), "variance of j by eq. 8 as printed"),
        "program_variance": (lambda f: float(f.closed.program_variance), "variance of j by the program"),
        "jacobian_variance": (lambda f: float(f.closed.variance), "variance of j"),
        "jacobian_skewness": (lambda f: float(f.closed.skewness), "skewness of j"),
        "coverage_printed": (
            lambda f: f.at("printed"),
            f"{rest}, eqs 6 to 8 as printed, NaN where undefined",
        ),
        "coverage_program": (lambda f: f.at("program"), f"{rest}, Gaussian, the program's variance"),
        "coverage_gaussian": (lambda f: f.at("gaussian"), f"{rest}, Gaussian, right variance"),
        "coverage_exact": (lambda f: f.at("exact"), f"{rest}, exact closure"),
        "coverage_counted": (lambda f: f.counted[0], f"{rest}, counted"),
        "coverage_counted_error": (lambda f: f.counted[1], f"standard error of the {rest}, counted"),
        "projected_exact": (lambda f: float(f.closed.projected["exact"]), f"{above}, exact closure"),
        "projected_counted": (lambda f: f.counted_projected[0], f"{above}, counted"),
        "projected_counted_error": (
            lambda f: f.counted_projected[1],
            f"standard error of the {above}, counted",
        ),
    }
    scenes = [next(f.scene for f in fields if f.number == number) for number in config.scenes]
    per_scene = {
        "threshold": variable(
            "scene", [s.threshold for s in scenes], units="1", long_name="breaking threshold epsilon"
        ),
        "wind_speed": variable(
            "scene", [s.wind for s in scenes], units="m s-1", long_name="U10", standard_name="wind_speed"
        ),
    }
    store.data(
        "scenes",
        per_scene
        | {
            name: variable(("scene", "field"), column(of), units="1", long_name=text)
            for name, (of, text) in numbers.items()
        },
        {
            "scene": variable(
                "scene", list(config.scenes), units="1", long_name="number of the published scene"
            ),
            "field_name": variable("field", list(NAMES.values()), units="1", long_name="field that breaks"),
        },
        title="Coverage of the published whitecap scenes by every formula, and counted",
        attributes={
            "resolution": config.resolution,
            "realisations": len(fields[0].rest),
            "peak_enhancement": config.peak_enhancement,
            "breaking_wavenumber_rad_per_m": "none",
        },
    )
