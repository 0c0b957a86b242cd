"""A small sea, calm or in wind, and cameras that look at it: whatever finds visible points is held to them."""

import jax
import jax.numpy as jnp
import numpy as np
from _waves import wind_sea

from jaxocean.render import Camera
from jaxocean.surface import Cascade, Fields, Sea, realise

TIME = 3.0  # s

CAMERAS = {
    "oblique": Camera((3.0, 4.0, 20.0), heading=0.5, pitch=0.6),
    "rolled": Camera((3.0, 4.0, 20.0), heading=-2.0, pitch=0.3, roll=0.7, field_of_view=1.4),
    "straight down": Camera((0.0, 0.0, 5000.0), heading=1.0, pitch=np.pi / 2),
    "low": Camera((0.0, 0.0, 0.5), pitch=0.05),
    "from orbit": Camera((1e4, 0.0, 4e5), pitch=1.2),
}


def calm_fields(cascade: Cascade) -> Fields:
    """A flat sea."""
    n = cascade.resolution
    return Fields(jnp.zeros((cascade.count, 4, n, n), jnp.complex128))


def windy(cascade: Cascade, speed: float, seed: int = 3) -> Sea:
    """The same sea each time, in a wind of that speed [m/s]."""
    return realise(wind_sea(speed), cascade, key=jax.random.key(seed))


def place_on_plane(camera: Camera, size: tuple[int, int], pixel):
    """Where the ray through a place (x, y) [pixels] of the image meets the plane."""
    focal = camera.focal_length(size)
    right, up, forward = camera.axes()
    ray = (pixel[0] - size[1] / 2) / focal * right + (size[0] / 2 - pixel[1]) / focal * up + forward
    return camera.position[:2] - ray[:2] * camera.position[2] / ray[2]
