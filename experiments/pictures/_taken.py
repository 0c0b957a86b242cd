"""An image made ready for a fit: linear, reduced, masked, and where its camera looked."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from fitting import FitError
from fitting.pictures import ImageStatistics, find_horizon
from jaxocean.io import read_image
from jaxocean.render import Camera

from .. import schema
from ..harness._errors import UserError


@dataclass(frozen=True)
class Taken:
    """An image made ready: `light`, linear, and `mask`, both reduced; `camera`; `shown`: the image as it came."""

    light: np.ndarray
    mask: np.ndarray | None
    camera: Camera
    shown: np.ndarray

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns that are compared."""
        rows, columns, _ = self.light.shape
        return rows, columns


def taken_from(
    image: Path, mask: Path | None, config: schema.PhotographCameraConfig, rows: int, key: str = "image"
) -> Taken:
    """Read an image, and where its camera looked.

    **Raises:** `UserError` for what is no colour image of the sea.
    """
    light = _read(image, key)
    height, width, _ = light.shape
    if min(height, width) < rows:
        raise UserError(
            f"Key `{key}`: `{image}` must have at least {rows}×{rows} pixels, but has {width}×{height}: give a larger "
            "one, or fewer `inference.rows`."
        )
    if not np.all(np.isfinite(light)):
        raise UserError(
            f"Key `{key}`: `{image}` holds light that is not finite: fill what is unknown and mask it."
        )
    if np.ptp(light) < 1e-6 * max(float(np.max(light)), 1e-9):
        raise UserError(
            f"Key `{key}`: `{image}` shows nothing, all its pixels are alike: give another image."
        )
    if _grey(light):
        raise UserError(
            f"Key `{key}`: `{image}` is grey, and what it made of colours is not known: give the colour image."
        )
    seen = None if mask is None else _mask(mask, image, (height, width))
    return made_ready(light, seen, config, rows, f"`{image}`", key, mask)


def made_ready(
    light: np.ndarray,
    seen: np.ndarray | None,
    config: schema.PhotographCameraConfig,
    rows: int,
    name: str,
    key: str = "image",
    mask: Path | None = None,
) -> Taken:
    """Reduce light and mask to so many rows, and find where the camera looked.

    **Arguments:** `name`, `key`, `mask`: of what an error speaks.

    **Raises:** `UserError` if no horizon is seen and none is given, or hardly any sea.
    """
    height, width, _ = light.shape
    view = config.vertical(height, width)
    if config.pitch is None or config.roll is None:
        try:
            pitch, roll = find_horizon(light, seen).angles(view)
        except FitError as problem:
            hidden = behind = ""
            if mask is not None:
                hidden, behind = ", or a mask that leaves it in view", f" where `{mask}` is white"
            elif key == "image":
                hidden = ", or a `mask` of what hides it"
            raise UserError(
                f"Key `{key}`: {name} shows no horizon{behind}: give `camera.pitch` and `camera.roll`{hidden}."
            ) from problem
    else:
        pitch, roll = config.pitch, config.roll
    camera = Camera((0.0, 0.0, config.height), pitch=float(pitch), roll=float(roll), field_of_view=view)
    columns = max(2 * round(rows * width / height / 2), 2)
    if seen is None:
        taken = Taken(_reduced(light, rows, columns), None, camera, light)
    else:
        share = _reduced(seen[..., None], rows, columns)
        # What is hidden has no part in a mean.
        whole = _reduced(light * seen[..., None], rows, columns) / np.maximum(share, 1e-3)
        taken = Taken(whole, share[..., 0], camera, light)
    _check_sea(taken, config, name, key, mask)
    return taken


def _check_sea(
    taken: Taken, config: schema.PhotographCameraConfig, name: str, key: str, mask: Path | None
) -> None:
    """Refuse an image in which next to no sea is seen."""
    try:
        ImageStatistics(taken.camera, taken.size)
    except ValueError as problem:
        if config.pitch is None:
            words = f"Key `{key}`: {name} shows hardly any sea below its horizon: give `camera.pitch` and `camera.roll`"
        else:
            words = f"Key `camera.pitch`: a camera that looks {-config.pitch:+.2f} rad up sees no sea: give another"
        raise UserError(f"{words}.") from problem
    if taken.mask is None:
        return
    try:
        ImageStatistics(taken.camera, taken.size, taken.mask)
    except ValueError as problem:
        raise UserError(f"Key `mask`: `{mask}` hides the sea: paint white what counts.") from problem


def _grey(light: np.ndarray) -> bool:
    """Whether all but single pixels have hardly any colour."""
    apart = np.ptp(light, axis=-1) / np.maximum(light.max(axis=-1), 1e-9)
    return float(np.quantile(apart, 0.99)) < 0.01


def _read(path: Path, key: str) -> np.ndarray:
    try:
        return np.asarray(read_image(path.expanduser()), np.float32)
    except FileNotFoundError as problem:
        raise UserError(
            f"Key `{key}`: there is no file `{path}`: give the path of one that exists."
        ) from problem
    except (ValueError, OSError) as problem:
        raise UserError(f"Key `{key}`: {problem}") from problem


def _mask(path: Path, image: Path, size: tuple[int, int]) -> np.ndarray:
    light = _read(path, "mask").mean(axis=-1)
    if light.shape != size:
        raise UserError(
            f"Key `mask`: `{path}` must have the {size[1]}×{size[0]} pixels of `{image}`, but has "
            f"{light.shape[1]}×{light.shape[0]}."
        )
    seen = (light > 0.2).astype(np.float32)
    if not np.any(seen):
        raise UserError(f"Key `mask`: `{path}` hides the whole image: paint white what counts.")
    return seen


def _reduced(planes: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Means over the area of each new pixel."""
    size = columns, rows
    parts = [
        np.asarray(Image.fromarray(np.ascontiguousarray(planes[..., i])).resize(size, Image.Resampling.BOX))
        for i in range(planes.shape[-1])
    ]
    return np.stack(parts, axis=-1).astype(np.float32)
