"""How the rest point that a ray meets moves from pixel to pixel."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ._camera import Camera
from ._footprint import SurfaceMoments
from ._planet import wrap
from ._ray_root import EDGE_ON, Triple
from ._ray_surface import RaySurface

UPRIGHT = 1e-6
"""Least square of the area [-] of the displaced surface over that at rest."""


def footprint_axes(
    surface: RaySurface,
    moments: SurfaceMoments,
    camera: Camera,
    size: tuple[int, int],
    rays: Float[Array, "rows columns 3"],
    met: Triple,
) -> tuple[Float[Array, "rows columns"], ...]:
    """∂x/∂column, ∂x/∂row, ∂y/∂column and ∂y/∂row [m] of the rest point (x, y) at depth d along the ray.

    $$ T_1\\,∂x + T_2\\,∂y = q\\,∂A + A\\,∂q, \\quad T_1 = (1 + a, c, ∂_x η), \\; T_2 = (c, 1 + b, ∂_y η) $$

    with q the ray of length 1 along the direction of view and A how far the point lies ahead. Slopes and strain are
    read from the textures that the shading reads, which have no jumps between texels. Where the surface is seen edge
    on, N · q = 0 with N = T₁ × T₂, a footprint has no bound: 1/(N · q) is replaced as in `PerPixel`.
    """
    x, y, depth = met
    right, up, forward = camera.axes()
    across, focal = rays @ forward, camera.focal_length(size)
    through, ahead = rays / across[..., None], depth * across
    a, b, c, east, north = moments.tangents(surface.centre, x, y, surface.variance(x, y))
    first = _tangent(surface, x, y, (1 + a, c), east)
    second = _tangent(surface, x, y, (c, 1 + b), north)
    normal = jnp.cross(first, second)
    square = jnp.sum(normal**2, axis=-1) + UPRIGHT
    facing = jnp.sum(normal * through, axis=-1)
    least = EDGE_ON * surface.view(x, y)[1] * jnp.sqrt(square) / across
    inverse = facing / (facing**2 + least**2)
    columns = []
    for turned in (right * (surface.stride / focal), -up / focal):
        further = -ahead * (normal @ turned) * inverse
        moved = ahead[..., None] * turned + further[..., None] * through
        columns.append(
            tuple(
                jnp.sum(jnp.cross(*pair) * normal, axis=-1) / square
                for pair in ((moved, second), (first, moved))
            )
        )
    (x_column, y_column), (x_row, y_row) = columns
    return x_column, x_row, y_column, y_row


def _tangent(surface: RaySurface, x, y, moved, raised) -> Float[Array, "rows columns 3"]:
    """A tangent of the surface, wrapped around the planet."""
    place = jnp.stack([x, y], axis=-1), jnp.zeros_like(x)
    tangent = jnp.stack(moved, axis=-1), raised
    flat, level = jax.jvp(lambda p, h: wrap(p, h, surface.curvature), place, tangent)[1]
    return jnp.concatenate([flat, level[..., None]], axis=-1)
