"""The surface that rays meet: every wave that a pixel can resolve at that distance, and no other."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._types import Scalar
from ._atlas import Atlas
from ._footprint import LEAST_SHARPNESS, SHARPNESS
from ._planet import wrap

LEAST_VIEW = 1e-6
"""Sine of the angle of view below which, at a planet's horizon, footprints stop growing."""


class RaySurface(eqx.Module):
    """The displaced surface, filtered as wide as the footprint of a pixel on a plane at the same place.

    The filter depends on the place alone and not on the ray, so that all rays see one and the same surface, without
    jumps.

    **Arguments:** `atlas` of (u, v, η); `centre`: the point below the camera [m]; `level`: the camera's height above
    the plane whose footprints are taken [m]; `angle`: between neighbouring rows of pixels [rad]; `curvature` [1/m];
    `stride`: how far apart columns are over that.
    """

    atlas: Atlas
    centre: Float[Array, "2"]
    level: Scalar
    angle: Scalar
    curvature: Scalar
    stride: float = eqx.field(static=True, default=1.0)

    def view(
        self, x: Float[Array, "*b"], y: Float[Array, "*b"]
    ) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """Distance [m] to the plane at rest points (x, y) from the point below the camera, and the sine of the angle
        between it and the line of sight."""
        offset = jnp.stack([x, y], axis=-1)
        flat, drop = wrap(offset, jnp.zeros_like(x), self.curvature)
        _, above = wrap(offset, jnp.broadcast_to(self.level, x.shape), self.curvature)
        distance = jnp.sqrt(flat[..., 0] ** 2 + flat[..., 1] ** 2 + (self.level - drop) ** 2)
        return distance, jnp.maximum(above / distance, LEAST_VIEW)

    def variance(self, x: Float[Array, "*b"], y: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Of the filter [m²] along each axis, at rest points (x, y) from the point below the camera.

        That of `filter_variance` for a footprint of dφ across and dφ/s along, with the distance d, the angle φ between
        pixels (across times the stride), and the sine s of the angle between the plane and the line of sight.
        """
        distance, sine = self.view(x, y)
        if self.stride == 1:
            across = distance * self.angle
            width = jnp.maximum(across, across / (SHARPNESS * sine))
        else:
            across, along = distance * self.angle * self.stride, distance * self.angle / sine
            shorter, longer = jnp.minimum(across, along), jnp.maximum(across, along)
            width = jnp.maximum(shorter, longer / SHARPNESS)
        return jnp.minimum(width**2 / 12, LEAST_SHARPNESS**-4)

    def __call__(
        self, x: Float[Array, "*b"], y: Float[Array, "*b"], variance: Float[Array, "*b"] | None = None
    ) -> tuple[Float[Array, "*b"], Float[Array, "*b"], Float[Array, "*b"]]:
        """Where the rest points (x, y) are in the world, from the point below the camera at height 0 [m]."""
        u, v, height = self.atlas(self.centre, x, y, self.variance(x, y) if variance is None else variance)
        flat, level = wrap(jnp.stack([x + u, y + v], axis=-1), height, self.curvature)
        return flat[..., 0], flat[..., 1], level
