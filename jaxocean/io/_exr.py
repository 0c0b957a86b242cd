"""OpenEXR files: floating-point images of named channels."""

import os
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

import numpy as np
from jaxtyping import Array, Float

from ._files import existing, written_whole

Plane = Float[Array, "y x"] | Float[np.ndarray, "y x"]
"""One channel of an image."""


def write_exr(path: str | os.PathLike, channels: Mapping[str, Plane]) -> Path:
    """Write an OpenEXR file of 32-bit channels, losslessly compressed. The file appears whole or not at all.

    **Arguments:** `path`: ends in `.exr`; `channels`: name → (height, width), all of one size. Viewers show `R`, `G`,
    `B`; further ones are named `layer.part`, such as `depth.Z` or `normal.X`.

    **Returns:** the path.

    **Raises:** `ValueError` for no channels, for a plane of another size or no pixels; `OSError` if the file cannot be
    written.
    """
    library = openexr()
    planes = {name: np.ascontiguousarray(plane, np.float32) for name, plane in channels.items()}
    shapes = {plane.shape for plane in planes.values()}
    if len(shapes) != 1 or any(len(shape) != 2 or 0 in shape for shape in shapes):
        found = {name: plane.shape for name, plane in planes.items()}
        raise ValueError(
            f"Argument `channels` must hold planes of one size (height, width), but holds {found}."
        )
    header = {"compression": library.ZIP_COMPRESSION, "type": library.scanlineimage}

    def write(target: Path) -> None:
        try:
            with library.File(header, planes) as file:
                file.write(str(target))
        except RuntimeError as problem:
            raise OSError(f"The image `{path}` cannot be written: {problem}.") from problem

    return written_whole(Path(path), write)


def read_exr(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """The channels of an OpenEXR file.

    **Arguments:** `path`: of the file.

    **Returns:** name → (height, width), float32.

    **Raises:** `FileNotFoundError` if there is no such file; `ValueError` if it is no OpenEXR file or is damaged.
    """
    library = openexr()
    source = existing(path)
    try:
        with library.File(str(source), separate_channels=True) as file:
            return {name: np.asarray(channel.pixels, np.float32) for name, channel in file.channels().items()}
    except (RuntimeError, ValueError) as problem:
        raise ValueError(f"The image `{source}` is damaged or no OpenEXR file.") from problem


def layer(
    name: str, parts: str, image: Float[Array, "y x c"] | Float[np.ndarray, "y x c"]
) -> dict[str, np.ndarray]:
    """The channels of one layer, for `write_exr`.

    **Arguments:** `name`: of the layer, or "" for the picture itself; `parts`: one letter for each channel of `image`,
    such as "RGB" or "XYZ".

    **Returns:** `name.part` → (height, width), float32.

    **Raises:** `ValueError` if there are not as many letters as channels.
    """
    planes = np.asarray(image, np.float32)
    if planes.shape[-1] != len(parts):
        raise ValueError(f"Argument `parts` must name {planes.shape[-1]} channels, but is {parts!r}.")
    return {f"{name}.{part}" if name else part: planes[..., i] for i, part in enumerate(parts)}


def openexr() -> ModuleType:
    """The library, or one sentence on how to get it."""
    try:
        import OpenEXR
    except ImportError as problem:
        raise ImportError("OpenEXR files need the package OpenEXR: `pip install OpenEXR`.") from problem
    return OpenEXR
