"""From the rest plane to a round planet: the plane is wrapped around a sphere below the camera."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from .._types import Scalar

EARTH_CURVATURE = 1 / 6.371e6
"""Curvature [1/m] of a sphere as large as the Earth."""


def wrap(
    offset: Float[Array, "*b 2"], height: Float[Array, "*b"], curvature: Scalar
) -> tuple[Float[Array, "*b 2"], Float[Array, "*b"]]:
    """Distances along the sphere and heights above it, as places relative to the point below the camera.

    $$ x = p \\frac{\\sin κr}{κr} (1 + κη), \\quad z = η \\cos κr - 2 \\sin²(κr/2)/κ, \\quad r = |p| $$

    Without curvature both stay as they are, and the derivative with respect to κ is right there too.

    **Arguments:** `offset` p [m] from the point below the camera; `height` η [m]; `curvature` κ [1/m].
    """
    square = offset[..., 0] ** 2 + offset[..., 1] ** 2
    # Beyond the far side of the planet there is nothing more to come.
    turn_square = jnp.minimum(square * curvature**2, jnp.pi**2)
    half = _sinc(0.25 * turn_square)
    sine = _sinc(turn_square)
    drop = 0.5 * jnp.minimum(square * curvature, jnp.pi**2 / jnp.maximum(curvature, 1e-30)) * half**2
    cosine = 1 - 0.5 * turn_square * half**2
    stretch = sine * (1 + curvature * height)
    place = jnp.stack([offset[..., i] * stretch for i in (0, 1)], axis=-1)
    return place, height * cosine - drop


def _sinc(square: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """sin x / x as a function of x², smooth at 0."""
    small = square < 1e-4
    x = jnp.sqrt(jnp.where(small, 1.0, square))
    return jnp.where(small, 1 - square / 6, jnp.sin(x) / x)


Components = tuple[Float[Array, "*b"], Float[Array, "*b"], Float[Array, "*b"]]
"""Of vectors, one array each: XLA on the CPU is slow with short last axes."""


def vertical(place: Components, curvature: Scalar) -> Components:
    """Unit vectors away from the planet's centre.

    **Arguments:** `place` [m] from the point below the camera at height 0; `curvature` κ [1/m].
    """
    x, y, z = curvature * place[0], curvature * place[1], 1 + curvature * place[2]
    inverse = 1 / jnp.sqrt(x * x + y * y + z * z)
    return x * inverse, y * inverse, z * inverse


def to_local(vector: Components, up: Components) -> Components:
    """Vectors of the world in the frame of places with the vertical `up`.

    The turn that brings `up` u to the camera's vertical e the short way, as `wrap` bends the plane:

    $$ v - \\frac{(u + e)·v}{1 + u·e} (u + e) + 2 (u·v)\\, e $$
    """
    along = up[0] * vector[0] + up[1] * vector[1] + up[2] * vector[2]
    share = (along + vector[2]) / (1 + up[2])
    return vector[0] - share * up[0], vector[1] - share * up[1], along


def to_world(vector: Components, up: Components) -> Components:
    """The inverse of `to_local`."""
    along = up[0] * vector[0] + up[1] * vector[1] + up[2] * vector[2]
    share = 2 * vector[2] - (along + vector[2]) / (1 + up[2])
    flat = vector[0] + share * up[0], vector[1] + share * up[1]
    return *flat, up[2] * vector[2] - up[0] * vector[0] - up[1] * vector[1]
