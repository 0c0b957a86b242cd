"""`animate`: a sequence of pictures of a moving sea, as PNG, GIF and MP4."""

import time as clock
from dataclasses import dataclass

import numpy as np

import jaxocean as jo
from jaxocean import render
from jaxocean.io import write_gif, write_mp4

from .. import schema
from ..harness._errors import Interrupted
from ..harness._files import Files
from ..harness._lock import locked
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _animate_report, _animate_views, _scene
from ._frames import Frames
from ._path import Path, check_above


@dataclass(frozen=True)
class Look:
    """One way to render the sequence: `samples` along each side of a pixel, `filtered` over footprints or not."""

    samples: int
    filtered: bool


LOOKS = {"filtered": Look(1, True), "unfiltered": Look(1, False), "supersampled": Look(4, False)}


def run(config: schema.AnimateConfig, progress: Reporter, store: Files) -> Result:
    """Render the sequence of a config, or what is missing of it; see `schema.AnimateConfig`."""
    progress.step("Realising the sea")
    ocean, path = _scene.ocean(config), Path(config)
    times = [config.start + frame / config.frames_per_second for frame in range(config.frames)]
    with locked(store.unfinished()):
        sequences = {
            name: Frames(store.unfinished() / name, config.frames, layered=config.exr and name == "filtered")
            for name in ("filtered", *config.compare)
        }
        _render_missing(config, ocean, path, times, sequences, progress)
        progress.step("Writing the sequence")
        pictures = sequences["filtered"].copy_to(store.folder / "frames")
        for name in config.compare:
            sequences[name].copy_to(store.folder / name)
        write_gif(store.folder / "animation.gif", pictures, config.frames_per_second)
        notes = []
        try:
            write_mp4(store.folder / "animation.mp4", pictures, config.frames_per_second)
        except ImportError as problem:
            notes.append(f"There is no MP4, only the GIF: {problem}")
        found = _animate_report.collect(config, ocean, path, times, sequences)
    _animate_views.plot(store, found, pictures)
    _animate_views.save(store, found)
    result = _animate_report.result(config, found, notes)
    store.text("report.md", _animate_report.report(config, found, result))
    return result


def _render_missing(
    config: schema.AnimateConfig,
    ocean: jo.Ocean,
    path: Path,
    times: list[float],
    sequences: dict[str, Frames],
    progress: Reporter,
) -> None:
    """Render what no earlier run has left, and keep each frame at once."""
    missing = {
        name: sorted(set(range(config.frames)) - set(sequence.numbers()))
        for name, sequence in sequences.items()
    }
    progress.step("Looking where the camera goes")
    check_above(ocean, path, [times[frame] for frame in sorted(set().union(*missing.values()))])
    exposure = config.image.exposure or _kept_exposure(sequences["filtered"])
    try:
        for name, frames in missing.items():
            if not frames:
                continue
            advance = progress.count("Frames" if name == "filtered" else f"Frames, {name}", len(frames))
            for frame in frames:
                began = clock.perf_counter()
                layers, radiance, numbers = _picture(
                    config, ocean, path(times[frame]), times[frame], LOOKS[name]
                )
                seconds = clock.perf_counter() - began
                # One exposure for all, or the sequence would pump.
                exposure = exposure or _scene.exposure(config, radiance)
                code = _scene.code(config, exposure, radiance)
                numbers |= {"time": times[frame], "exposure": exposure, "seconds": seconds}
                if sequences[name].layered:
                    _scene.write_layers(sequences[name].layers_file(frame), layers)
                sequences[name].keep(frame, code, numbers)
                advance()
    except KeyboardInterrupt:
        kept = sum(len(sequence.numbers()) for sequence in sequences.values())
        raise Interrupted(
            f"Interrupted: {kept} of {config.frames * len(sequences)} frames are kept, and the same command goes on "
            "with the others."
        ) from None


def _kept_exposure(sequence: Frames) -> float | None:
    """The exposure of the frames that are there."""
    return next((numbers["exposure"] for numbers in sequence.numbers().values()), None)


def _picture(
    config: schema.AnimateConfig, ocean: jo.Ocean, camera: render.Camera, time: float, look: Look
) -> tuple[render.Layers, np.ndarray, dict[str, float]]:
    """The layers and the light of one frame, the share of it that is sea, and the coverage of that."""
    rows, columns = _scene.size(config.image)
    n = look.samples
    layers = render.render_layers(
        ocean,
        camera,
        time,
        (n * rows, n * columns),
        method=_method(config.image, look),
        curvature=_scene.curvature(config),
    )
    radiance = np.asarray(layers.radiance).reshape(rows, n, columns, n, 3).mean(axis=(1, 3))
    numbers = {"sea": float(np.mean(layers.sea)), "coverage": _scene.seen_whitecaps(layers)}
    return layers, radiance, numbers


def _method(image: schema.RayImageConfig, look: Look) -> render.Raster | render.Rays:
    if image.method == "rays":
        return _scene.method(image)
    spacing = min(look.samples * image.vertex_spacing, 64.0)
    return render.Raster(spacing, filtered=look.filtered, shading_rate=image.shading_rate)
