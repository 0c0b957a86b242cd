"""What pixels see: the place, the footprint and the statistics of the surface in it."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .._types import Scalar
from ..filtering import Footprint, Moments, symmetric_matrix
from ..whitecaps import StrainStatistics, footprint_statistics
from ._camera import Camera
from ._footprint import Seen
from ._planet import Components, to_world, vertical


class Pixels(eqx.Module):
    """Pixels of an image in certain rows and columns.

    **Arguments:** `camera`, `size`: of the image, for several rays in each pixel of one with a row for each of theirs;
    `rows`, `columns`: their numbers, fractions if fewer rays go across than down; `curvature`: of the planet [1/m];
    `hit`: whether each pixel's centre sees water.
    """

    camera: Camera
    size: tuple[int, int] = eqx.field(static=True)
    rows: Float[Array, " rows"]
    columns: Float[Array, " columns"] | None
    curvature: Scalar
    hit: Bool[Array, "rows columns"]

    @property
    def rays(self) -> Float[Array, "rows columns 3"]:
        """Unit vectors from the camera through the pixels' centres."""
        return self.camera.rays(self.size, self.rows, self.columns)


class Visible(eqx.Module):
    """What some of the pixels of an image see: those in certain rows and columns.

    Where `hit` is false everything is finite, and means nothing. Under `jit` only what is used is computed.

    **Arguments:**

    - `camera`, `size`, `rows`, `columns`, `curvature`: as for `Pixels`; no columns for all of them.
    - `hit`: whether the pixel's centre sees water.
    - `depth`: distance of the seen point from the pinhole [m].
    - `place`: (x, y) of that point at rest, from the point below the camera [m].
    - `edges_of_footprint`: ∂x/∂column, ∂x/∂row, ∂y/∂column, ∂y/∂row [m] at rest.
    - `variance`: along each axis [m²], of the isotropic filter with which slopes and strain were looked up.
    - `area`: of the surface as it is drawn there, seen from above, over its area at rest [-].
    - `seen`: means and covariances of the displaced surface's slopes and of the strain in the footprint.
    """

    camera: Camera
    size: tuple[int, int] = eqx.field(static=True)
    rows: Float[Array, " rows"]
    curvature: Scalar
    hit: Bool[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    place: tuple[Float[Array, "rows columns"], ...]
    edges_of_footprint: tuple[Float[Array, "rows columns"], ...]
    variance: Float[Array, "rows columns"]
    area: Float[Array, "rows columns"]
    seen: Seen
    columns: Float[Array, " columns"] | None = None

    @property
    def pixels(self) -> Pixels:
        """The pixels themselves."""
        return Pixels(self.camera, self.size, self.rows, self.columns, self.curvature, self.hit)

    @property
    def rays(self) -> Float[Array, "rows columns 3"]:
        """Unit vectors from the camera to what each pixel sees."""
        return self.pixels.rays

    @property
    def position(self) -> Float[Array, "rows columns 3"]:
        """The seen point in the world [m]."""
        return self.camera.position + self.depth[..., None] * self.rays

    @property
    def up(self) -> Components:
        """Unit vectors away from the planet's centre at the seen point: (0, 0, 1) where it is flat."""
        rays = self.rays
        place = (self.depth * rays[..., 0], self.depth * rays[..., 1])
        return vertical((*place, self.camera.position[2] + self.depth * rays[..., 2]), self.curvature)

    @property
    def rest_point(self) -> Float[Array, "rows columns 2"]:
        """The seen point at rest (x, y) [m]."""
        return self.camera.position[:2] + jnp.stack(self.place, axis=-1)

    @property
    def footprint(self) -> Footprint:
        """What the pixels cover at rest, for the look-ups of `jaxocean.filtering`."""
        x_column, x_row, y_column, y_row = self.edges_of_footprint
        rows = jnp.stack([x_column, x_row], axis=-1), jnp.stack([y_column, y_row], axis=-1)
        return Footprint(self.rest_point, jnp.stack(rows, axis=-2))

    @property
    def slope(self) -> Float[Array, "rows columns 2"]:
        """Mean slope (∂w/∂x, ∂w/∂y) of the displaced surface over its own horizontal [-]."""
        return jnp.stack(self.seen.slope, axis=-1)

    @property
    def slope_covariance(self) -> Float[Array, "rows columns 2 2"]:
        """Covariance of those slopes inside the footprint [-]."""
        return symmetric_matrix(jnp.stack(self.seen.slopes, axis=-1))

    @property
    def normal(self) -> Float[Array, "rows columns 3"]:
        """Upward unit normal of the mean slope, in the world."""
        x, y = self.seen.slope
        length = jnp.sqrt(1 + x * x + y * y)
        return jnp.stack(to_world((-x / length, -y / length, 1 / length), self.up), axis=-1)

    @property
    def strain(self) -> StrainStatistics:
        """Mean and covariance of the strain in the footprint, for whitecap closures."""
        return footprint_statistics(
            Moments(
                self.slope,
                self.slope_covariance,
                jnp.stack(self.seen.strain, axis=-1),
                symmetric_matrix(jnp.stack(self.seen.strains, axis=-1)),
            )
        )
