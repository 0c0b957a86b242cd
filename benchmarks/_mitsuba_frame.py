"""A frame of Mitsuba 3: a displaced mesh of 512² vertices under a clear sky, one sample in each pixel."""

import importlib
import importlib.metadata
import importlib.util
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np

SIDE = 512
"""Vertices along each side of the mesh."""


def installed() -> str | None:
    """The version, or None."""
    return importlib.metadata.version("mitsuba") if importlib.util.find_spec("mitsuba") else None


def frame_times(size: tuple[int, int], frames: int) -> tuple[str, list[float]] | None:
    """The variant and milliseconds of each frame: with LLVM if that works here, else in plain C++; None if neither.

    In a process of its own: an LLVM of the wrong version ends the process that loads it.
    """
    for variant in ("llvm_ad_rgb", "scalar_rgb"):
        command = [sys.executable, __file__, variant, *map(str, (*size, frames))]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if run.returncode == 0:
            return variant, [float(word) for word in run.stdout.split()]
    return None


def _frame(
    variant: str, size: tuple[int, int], extent: float, height: float
) -> Callable[[np.ndarray], np.ndarray]:
    """What draws heights (512, 512) [m] over a square of side `extent` [m], from `height` [m] above its border."""
    mi = importlib.import_module("mitsuba")
    mi.set_variant(variant)
    mesh = mi.Mesh("sea", SIDE * SIDE, 2 * (SIDE - 1) ** 2)
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + SIDE + 1], axis=1),
            np.stack([corner, corner + SIDE + 1, corner + SIDE], axis=1),
        ]
    )
    rows, columns = size
    transform = mi.ScalarTransform4f().look_at(
        origin=[-extent / 2, 0.0, height], target=[0.0, 0.0, 0.0], up=[0.0, 0.0, 1.0]
    )
    parameters = mi.traverse(mesh)
    parameters["faces"] = faces.astype(np.uint32).ravel()
    x, y = np.meshgrid(*2 * [np.linspace(-extent / 2, extent / 2, SIDE)])
    flat = np.stack([x, y, np.zeros_like(x)], axis=-1).astype(np.float32)
    parameters["vertex_positions"] = flat.ravel()
    parameters.update()
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 3},
            "sea": mesh,
            "sky": {"type": "constant"},
            "sensor": {
                "type": "perspective",
                "fov": 60.0,
                "to_world": transform,
                "film": {"type": "hdrfilm", "width": columns, "height": rows},
            },
        }
    )
    moving = mi.traverse(scene)

    def frame(heights: np.ndarray) -> np.ndarray:
        flat[..., 2] = heights
        moving["sea.vertex_positions"] = flat.ravel()
        moving.update()
        return np.asarray(mi.render(scene, spp=1))

    return frame


def _print_times(variant: str, rows: int, columns: int, frames: int) -> None:
    frame = _frame(variant, (rows, columns), extent=200.0, height=9.0)
    line = np.linspace(0.0, 40.0, SIDE, dtype=np.float32)
    frame(np.zeros((SIDE, SIDE), np.float32))
    for number in range(frames):
        heights = np.sin(line + number)[:, None] * np.cos(0.7 * line)
        start = time.perf_counter()
        frame(heights)
        print(1e3 * (time.perf_counter() - start))


if __name__ == "__main__":
    _print_times(sys.argv[1], *map(int, sys.argv[2:]))
