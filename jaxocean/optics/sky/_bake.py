"""Any sky as an image."""

import jax.numpy as jnp

from ..._numerics import leaf_dtype, safe_angle, safe_divide, safe_norm
from ._abstract import AbstractSky
from ._image import ImageSky
from ._panorama import pixel_directions
from ._sun import visible_fraction


def bake(sky: AbstractSky, rows: int = 256) -> ImageSky:
    """The sky as a table: looked up instead of computed, and with wide lobes at no more cost than narrow ones.

    **Arguments:** `sky`: any sky; `rows`: height of the image, even; it is twice as wide.

    **Returns:** an `ImageSky` whose pixels hold the radiance at their centres; it is differentiable in `sky`. The sun's
    beam is carried over as it is.

    **Raises:** `ValueError` if `rows` is not even and positive.
    """
    if rows < 2 or rows % 2:
        raise ValueError(f"Argument `rows` must be even and at least 2, but is {rows}.")
    upper = sky.radiance(pixel_directions(rows, leaf_dtype(sky)))
    x, y, z = sky.sun_direction
    elevation = safe_angle(safe_norm(x, y), z)
    # An `ImageSky` lets its sun set by itself; what is left of the beam here has set already.
    beam = safe_divide(sky.sun_irradiance, jnp.broadcast_to(visible_fraction(elevation), (3,)))
    return ImageSky(
        jnp.concatenate([upper, upper[::-1]], axis=0),
        sun=beam,
        sun_elevation=elevation,
        sun_azimuth=safe_angle(x, y),
    )
