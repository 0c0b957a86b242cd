"""A pinhole camera: where it stands, where it looks, and which pixel sees what."""

from collections.abc import Sequence

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import UPRIGHT, as_leaf, as_upright_angle, check_scalar, is_concrete, safe_angle, safe_norm
from .._types import PerPattern, Scalar, ScalarLike
from ..surface import Fields, Sea
from ..surface.fft._points import reduce_points
from ._bounds import highest_over

WIDEST = 3.0
"""Largest vertical field of view [rad]."""

LARGEST = 16384
"""Most pixels along one side of an image."""

Vector = Float[Array, "3"] | Float[np.ndarray, "3"] | Sequence[float | int]


def _as_vector(value: Vector) -> Float[Array, "3"]:
    return as_leaf(jnp.asarray(value))


class Camera(eqx.Module):
    """A pinhole camera over the sea. Pixels are square; the image's centre is where it looks.

    | leaf | unit | default | role |
    |---|---|---|---|
    | `position` (x, y, z) | m | | the pinhole; z above the rest plane |
    | `heading` | rad | 0 | where it looks to, counter-clockwise from +x |
    | `pitch` | rad | 0 | how far below the horizontal it looks; π/2 is straight down, negative is up |
    | `field_of_view` | rad | π/3 | from the lower to the upper edge of the image |
    | `roll` | rad | 0 | turn around the direction of view; positive lowers the left side of the image |

    All are differentiable.

    **Raises:** `ValueError` for numbers that are not finite, a field of view outside 0 to 3 rad, or a pitch beyond
    straight up or down (by more than a rounded π/2 is).
    """

    position: Float[Array, "3"] = eqx.field(converter=_as_vector)
    heading: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    pitch: Scalar = eqx.field(converter=as_upright_angle, default=0.0, kw_only=True)
    field_of_view: Scalar = eqx.field(converter=as_leaf, default=np.pi / 3, kw_only=True)
    roll: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)

    def __check_init__(self) -> None:
        if is_concrete(self.position) and not np.all(np.isfinite(self.position)):
            raise ValueError(f"Argument `position` must be finite, but is {self.position} m.")
        check_scalar("heading", self.heading, "rad")
        check_scalar("pitch", self.pitch, "rad", minimum=-UPRIGHT, maximum=UPRIGHT)
        check_scalar("field_of_view", self.field_of_view, "rad", positive=True, maximum=WIDEST)
        check_scalar("roll", self.roll, "rad")

    @classmethod
    def look_at(
        cls,
        position: Vector,
        target: Vector,
        *,
        field_of_view: ScalarLike = np.pi / 3,
        roll: ScalarLike = 0.0,
    ) -> "Camera":
        """The camera at `position` [m] that has the point `target` [m] in the middle of its image.

        A target exactly below or above is seen with the heading 0.

        **Raises:** `ValueError` if both are the same point.
        """
        start, end = _as_vector(position), _as_vector(target)
        away = end - start.astype(end.dtype)
        if is_concrete(away) and not np.any(np.asarray(away)):
            raise ValueError(f"Argument `target` must be apart from `position`, but both are {start} m.")
        flat = safe_norm(away[0], away[1])
        return cls(
            start,
            heading=safe_angle(away[0], away[1]),
            pitch=safe_angle(flat, -away[2]),
            field_of_view=as_leaf(field_of_view),
            roll=as_leaf(roll),
        )

    def astype(self, dtype: jnp.dtype | type) -> "Camera":
        """The same camera with all its numbers in one floating-point type."""
        return Camera(
            self.position.astype(dtype),
            heading=self.heading.astype(dtype),
            pitch=self.pitch.astype(dtype),
            field_of_view=self.field_of_view.astype(dtype),
            roll=self.roll.astype(dtype),
        )

    def axes(self) -> Float[Array, "3 3"]:
        """Unit vectors to the right of the image, up the image and along the direction of view, as rows."""
        ch, sh = jnp.cos(self.heading), jnp.sin(self.heading)
        cp, sp = jnp.cos(self.pitch), jnp.sin(self.pitch)
        cr, sr = jnp.cos(self.roll), jnp.sin(self.roll)
        right = jnp.stack([sh, -ch, jnp.zeros_like(ch)])
        up = jnp.stack([sp * ch, sp * sh, cp])
        forward = jnp.stack([cp * ch, cp * sh, -sp])
        return jnp.stack([cr * right + sr * up, cr * up - sr * right, forward])

    def focal_length(self, size: tuple[int, int]) -> Scalar:
        """Distance [pixels] of the image plane from the pinhole."""
        return 0.5 * size[0] / jnp.tan(0.5 * self.field_of_view)

    def rays(
        self,
        size: tuple[int, int],
        rows: Float[Array, " rows"] | None = None,
        columns: Float[Array, " columns"] | None = None,
    ) -> Float[Array, "rows columns 3"]:
        """Unit vectors from the pinhole through the centres of all pixels; the first row is the upper one.

        **Arguments:** `size` (rows, columns) of the image; `rows`, `columns`: numbers of those that are wanted, or all.
        """
        height, width = check_size(size)
        dtype = self.position.dtype
        focal = self.focal_length(size)
        rows = jnp.arange(height, dtype=dtype) if rows is None else rows
        columns = jnp.arange(width, dtype=dtype) if columns is None else columns
        x = (columns + (0.5 - 0.5 * width)) / focal
        y = ((0.5 * height - 0.5) - rows) / focal
        axes = self.axes()
        shorter = 1 / jnp.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)
        # Component by component: XLA on the CPU is slow with short last axes.
        parts = [(x[None, :] * axes[0, i] + y[:, None] * axes[1, i] + axes[2, i]) * shorter for i in range(3)]
        return jnp.stack(parts, axis=-1)

    def project(
        self, points: Float[Array, "*b 3"], size: tuple[int, int]
    ) -> tuple[Float[Array, "*b 2"], Float[Array, "*b"]]:
        """Where points of the world [m] are in the image.

        **Returns:** (column, row) in pixels, with pixel (0, 0) from 0 to 1 and its centre at ½; and how far [m] the
        points lie along the direction of view. What is not in front of the camera (0 or less) has no place.
        """
        seen = (points - self.position) @ self.axes().T
        ahead = seen[..., 2]
        focal = self.focal_length(check_size(size))
        flat = seen[..., :2] / jnp.where(ahead == 0, 1.0, ahead)[..., None]
        middle = jnp.asarray([0.5 * size[1], 0.5 * size[0]], points.dtype)
        return middle + focal * flat * jnp.asarray([1.0, -1.0], points.dtype), ahead


def check_size(size: tuple[int, int]) -> tuple[int, int]:
    """The size (rows, columns) of an image, or an error.

    **Raises:** `ValueError` for an image without pixels, with parts of them, or with more than 16384 along a side.
    """
    whole = isinstance(size, (tuple, list)) and all(isinstance(side, (int, np.integer)) for side in size)
    if not whole or len(size) != 2 or not all(1 <= side <= LARGEST for side in size):
        raise ValueError(
            f"Argument `size` must be (rows, columns) with 1 to {LARGEST} whole pixels each, but is {size!r}."
        )
    return size


def check_above(
    camera: Camera, sea: Sea, time: ScalarLike, choppiness: PerPattern = 1.0, fields: Fields | None = None
) -> None:
    """Raise unless the camera is above the water over which it stands, however that is displaced.

    **Arguments:** `time` t [s]; `choppiness` λ [-]; `fields` at that time, if they are there. Unless they show that no
    water can be so high nearby, the waves are summed exactly at this one place.

    **Raises:** `ValueError` if the camera is under water or inside a crest.
    """
    *place, height = np.asarray(camera.position, np.float64)
    place = np.asarray(place)
    if fields is not None:
        where = reduce_points(place, sea.cascade, fields.packed.real.dtype)
        if height > float(highest_over(fields, sea.cascade, where)):
            return
    water = float(sea.height_at(place, time, choppiness))
    if not height > water:
        raise ValueError(
            f"Argument `camera` must be above the water, but is at a height of {height:g} m where the water is at "
            f"{water:g} m: raise it, move it, or look at another time."
        )
