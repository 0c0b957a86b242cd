"""PNG files, and linear images from files of either kind."""

import os
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..imagery import decode_srgb, to_bytes
from ..optics.sky import ImageSky
from ._exr import read_exr
from ._files import existing, written_whole


def write_png(path: str | os.PathLike, code: Float[Array, "y x 3"] | Float[np.ndarray, "y x 3"]) -> Path:
    """Write sRGB code values as a PNG of 8 bits. The file appears whole or not at all.

    **Arguments:** `path`: of the file; `code`: from 0 to 1, what a tone mapping returns; outside of that it is clipped.

    **Returns:** the path.

    **Raises:** `ValueError` for an image without pixels; `OSError` if the file cannot be written.
    """
    import imageio.v3 as imageio

    if 0 in code.shape:
        raise ValueError(f"Argument `code` must have pixels, but has shape {code.shape}.")
    pixels = np.asarray(to_bytes(jnp.asarray(code)))
    return written_whole(Path(path), lambda target: imageio.imwrite(target, pixels, extension=".png"))


def read_image(path: str | os.PathLike) -> np.ndarray:
    """A linear image from an OpenEXR file (its channels R, G, B) or from a picture in sRGB such as a PNG.

    **Arguments:** `path`: ends in `.exr` for OpenEXR; anything else is read as a picture.

    **Returns:** (height, width, 3), float32, linear with sRGB primaries; transparency is left out, grey becomes three
    equal channels.

    **Raises:** `FileNotFoundError` if there is no such file; `ValueError` if it cannot be read as an image.
    """
    source = existing(path)
    if source.suffix.lower() == ".exr":
        channels = read_exr(source)
        if not {"R", "G", "B"} <= set(channels):
            raise ValueError(
                f"The image `{source}` must have channels R, G and B, but has {sorted(channels)}."
            )
        return np.stack([channels[part] for part in "RGB"], axis=-1)
    import imageio.v3 as imageio

    try:
        # Cameras say in the file which side is up; inks and single bits are no colours yet.
        mode = {"CMYK": "RGB", "1": "L"}.get(_mode(source))
        pixels = np.asarray(imageio.imread(source, plugin="pillow", rotate=True, mode=mode))  # pyright: ignore[reportCallIssue]
    except (OSError, ValueError, SyntaxError) as problem:
        raise ValueError(
            f"The image `{source}` cannot be read, it is damaged or of an unknown format: give a PNG, JPEG or EXR."
        ) from problem
    if pixels.dtype.kind != "u" or pixels.ndim not in (2, 3):
        raise ValueError(
            f"The image `{source}` must be one picture of whole numbers, but is {pixels.dtype} {pixels.shape}: save "
            "one of its frames as a PNG."
        )
    planes = pixels[..., None] if pixels.ndim == 2 else pixels
    colours = planes[..., :3] if planes.shape[-1] >= 3 else np.repeat(planes[..., :1], 3, axis=-1)
    code = colours.astype(np.float32) / np.iinfo(pixels.dtype).max
    return np.asarray(decode_srgb(jnp.asarray(code)))


def _mode(source: Path) -> str:
    from PIL import Image

    with Image.open(source) as image:
        return image.mode


def read_panorama(path: str | os.PathLike, scale: float | int = 1.0) -> ImageSky:
    """An `ImageSky` from a file: an equirectangular panorama, twice as wide as it is high, zenith at the top.

    **Arguments:** `path`: as for `read_image`; `scale`: brings the image to radiance [W m⁻² sr⁻¹ nm⁻¹].

    **Returns:** the sky, without a sun and looking north in its middle; see `ImageSky`.

    **Raises:** `FileNotFoundError` if there is no such file; `ValueError` if it cannot be read, is not twice as wide
    as it is high, has an odd height, or has pixels that are not finite.
    """
    image = read_image(path)
    height, width = image.shape[:2]
    if width != 2 * height:
        raise ValueError(
            f"The panorama `{path}` must be twice as wide as it is high, but is {width} by {height}."
        )
    return ImageSky(image, scale=scale)
