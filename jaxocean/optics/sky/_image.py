"""A sky given by a panorama."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar, is_concrete, safe_angle
from ..._types import Scalar
from ._abstract import AbstractSky
from ._blur import VARIANCES, blurred_levels
from ._colour_leaf import as_colour, check_colour
from ._dome import angle_between
from ._sun import direction_of, visible_fraction


class ImageSky(AbstractSky):
    """A sky read from an equirectangular image; a photograph of the dome, or another sky that was baked.

    Rows run from the zenith (first) to the nadir (last), columns to the right as one turns right: with rotation 0 the
    middle of the image looks north (+y), three quarters of its width east (+x). Only the upper half is used, the
    lower half is its mirror image. Between pixels it is bilinear. Lobes look into copies that are blurred on the
    sphere, made anew from the image at every call and so differentiable like everything else.

    A sun's disc that is in the image is as blurred as its pixels: better to paint it over and give it as `sun`.

    **Arguments:**

    - `image`: linear sRGB (H, W, 3), H even; times `scale` it is radiance [W m⁻² sr⁻¹ nm⁻¹].
    - `rotation`: turns the image counter-clockwise about the vertical [rad].
    - `scale`: factor on the image, at least 0.
    - `sun`: irradiance [W m⁻² nm⁻¹] of the sun's beam on a plane across it, one number or three.
    - `sun_elevation`, `sun_azimuth`: where the sun is [rad]; neither `rotation` nor `scale` touches the sun.

    All are differentiable. **Raises:** `ValueError` for a wrong shape or a number that is not finite.
    """

    image: Float[Array, "h w 3"] = eqx.field(converter=as_leaf)
    rotation: Scalar = eqx.field(converter=as_leaf, default=0.0)
    scale: Scalar = eqx.field(converter=as_leaf, default=1.0)
    sun: Float[Array, "3"] = eqx.field(converter=as_colour, default=0.0)
    sun_elevation: Scalar = eqx.field(converter=as_leaf, default=math.pi / 4)
    sun_azimuth: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def __check_init__(self) -> None:
        check_scalar("rotation", self.rotation, "rad")
        check_scalar("scale", self.scale, "", minimum=0.0)
        check_colour("sun", self.sun, "W m⁻² nm⁻¹")
        check_scalar("sun_elevation", self.sun_elevation, "rad", minimum=-math.pi / 2, maximum=math.pi / 2)
        check_scalar("sun_azimuth", self.sun_azimuth, "rad")
        image = self.image
        if not isinstance(image, jax.Array | np.ndarray):
            return
        if image.ndim != 3 or image.shape[2] != 3 or image.shape[0] % 2 or min(image.shape[:2]) < 2:
            raise ValueError(
                "Argument `image` must have the shape (height, width, 3) with an even height, "
                f"but has {image.shape}."
            )
        if is_concrete(image) and not bool(jnp.all(jnp.isfinite(image))):
            raise ValueError("Argument `image` must be finite everywhere, but has NaN or infinite pixels.")

    @property
    def sun_direction(self) -> Float[Array, "3"]:
        return direction_of(self.sun_elevation, self.sun_azimuth)

    @property
    def sun_irradiance(self) -> Float[Array, "3"]:
        return self.sun * visible_fraction(self.sun_elevation).astype(self.sun.dtype)

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        upper = self._upper(direction.dtype)
        down, across = self._place(direction)
        return _bilinear(upper, jnp.zeros(down.shape, jnp.int32), upper.shape[0], down, across)

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        """As in `AbstractSky`; between the levels it is linear in the variance, and above the widest it stays."""
        upper = self._upper(direction.dtype)
        levels = blurred_levels(upper)
        count, rows = levels.shape[0], levels.shape[1]
        atlas = levels.reshape(count * rows, *levels.shape[2:])
        down, across = self._place(direction)
        variances = jnp.asarray(np.concatenate([[0.0], VARIANCES]), direction.dtype)
        spread = jnp.clip(variance.astype(direction.dtype), 0.0, variances[-1])
        # Level 0 is the image itself, level k + 1 the k-th of the atlas.
        first = jnp.clip(jnp.floor(jnp.log2(jnp.maximum(spread, 1e-9) / variances[1])), -1.0, count - 2.0)
        lower = first.astype(jnp.int32) + 1
        share = (spread - variances[lower]) / (variances[lower + 1] - variances[lower])
        sharp = _bilinear(upper, jnp.zeros_like(lower), upper.shape[0], down, across)
        narrow = _bilinear(atlas, jnp.maximum(lower - 1, 0), rows, down, across)
        wide = _bilinear(atlas, lower, rows, down, across)
        start = jnp.where((lower == 0)[..., None], sharp, narrow)
        return start + share[..., None] * (wide - start)

    def irradiance(self) -> Float[Array, "3"]:
        upper = self._upper(self.image.dtype)
        edges = np.sin(0.5 * np.pi * np.arange(upper.shape[0] + 1) / upper.shape[0]) ** 2
        return math.pi * jnp.asarray(np.diff(edges), upper.dtype) @ jnp.mean(upper, axis=1)

    def _upper(self, dtype: jnp.dtype) -> Float[Array, "h w 3"]:
        """The upper half of the image in units of radiance."""
        half = self.image[: self.image.shape[0] // 2]
        return (half * self.scale.astype(half.dtype)).astype(dtype)

    def _place(self, direction: Float[Array, "*b 3"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """Where to look: the fraction of the way from the zenith to the horizon, and that across the image."""
        x, y, z = direction[..., 0], direction[..., 1], jnp.abs(direction[..., 2])
        half = 0.5 * (x * x + y * y + (1.0 - z) * (1.0 - z))
        azimuth = safe_angle(x, y) - self.rotation.astype(direction.dtype)
        turn = 0.75 - azimuth / (2.0 * math.pi)
        return angle_between(half) * (2.0 / math.pi), turn - jnp.floor(turn)


def _bilinear(
    texture: Float[Array, "y x 3"],
    page: jnp.ndarray,
    rows: int,
    down: Float[Array, "*b"],
    across: Float[Array, "*b"],
) -> Float[Array, "*b 3"]:
    """Bilinear look-up in the `page`-th block of `rows` rows; columns wrap, rows stop at both ends."""
    columns = texture.shape[1]
    v = jnp.clip(down * rows - 0.5, 0.0, rows - 1.0)
    u = across * columns - 0.5
    top, left = jnp.clip(jnp.floor(v), 0.0, max(rows - 2.0, 0.0)), jnp.floor(u)
    fv, fu = (v - top)[..., None], (u - left)[..., None]
    row = top.astype(jnp.int32) + page * rows
    below = row + (1 if rows > 1 else 0)
    column = left.astype(jnp.int32) % columns
    right = (column + 1) % columns
    flat = texture.reshape(-1, 3)
    upper = flat[row * columns + column] * (1.0 - fu) + flat[row * columns + right] * fu
    lower = flat[below * columns + column] * (1.0 - fu) + flat[below * columns + right] * fu
    return upper * (1.0 - fv) + lower * fv
