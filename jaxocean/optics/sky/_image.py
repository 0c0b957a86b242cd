"""A sky given by a panorama."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..._numerics import UPRIGHT, as_leaf, as_upright_angle, check_scalar, is_concrete
from ..._types import Scalar
from ._abstract import AbstractSky
from ._blur import blurred_levels
from ._colour_leaf import as_colour, check_colour
from ._lobes import lobe_mean
from ._panorama import look_up, place
from ._sun import direction_of, even_disc, visible_fraction


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
    sun_elevation: Scalar = eqx.field(converter=as_upright_angle, default=math.pi / 4)
    sun_azimuth: Scalar = eqx.field(converter=as_leaf, default=0.0)

    def __check_init__(self) -> None:
        check_scalar("rotation", self.rotation, "rad")
        check_scalar("scale", self.scale, "", minimum=0.0)
        check_colour("sun", self.sun, "W m⁻² nm⁻¹")
        check_scalar("sun_elevation", self.sun_elevation, "rad", minimum=-UPRIGHT, maximum=UPRIGHT)
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
        upper = self.upper(direction.dtype)
        return look_up(upper, *place(direction, self.rotation))

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return even_disc(self.sun, self.sun_direction, direction)

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        upper = self.upper(direction.dtype)

        def sharp() -> Float[Array, "*b 3"]:
            return look_up(upper, *place(direction, self.rotation))

        return lobe_mean(sharp, blurred_levels(upper), direction, variance, self.rotation)

    def irradiance(self) -> Float[Array, "3"]:
        upper = self.upper(self.image.dtype)
        edges = np.sin(0.5 * np.pi * np.arange(upper.shape[0] + 1) / upper.shape[0]) ** 2
        return math.pi * jnp.asarray(np.diff(edges), upper.dtype) @ jnp.mean(upper, axis=1)

    def upper(self, dtype: jnp.dtype) -> Float[Array, "h w 3"]:
        """The upper half of the image in units of radiance."""
        half = self.image[: self.image.shape[0] // 2]
        return (half * self.scale.astype(half.dtype)).astype(dtype)
