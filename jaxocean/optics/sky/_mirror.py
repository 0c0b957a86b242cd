"""A panorama made ready for many look-ups."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ._abstract import AbstractSky
from ._blur import blurred_levels
from ._image import ImageSky
from ._lobes import lobe_mean
from ._panorama import look_up, place


class Mirror(AbstractSky):
    """What an `ImageSky` would answer, with everything that does not depend on the direction computed beforehand.

    **Arguments:** `sky`: the panorama; `upper`, `levels`: its upper half and the blurred copies, channels first;
    `diffuse`: its irradiance.
    """

    sky: ImageSky
    upper: Float[Array, "3 h w"]
    levels: Float[Array, "3 level y x"]
    diffuse: Float[Array, "3"]

    @classmethod
    def of_sky(cls, sky: ImageSky) -> "Mirror":
        """The mirror of a panorama."""
        upper = sky.upper(sky.image.dtype)
        levels = jnp.moveaxis(blurred_levels(upper), -1, 0)
        return cls(sky, jnp.moveaxis(upper, -1, 0), levels, sky.irradiance())

    @property
    def sun_direction(self) -> Float[Array, "3"]:
        return self.sky.sun_direction

    @property
    def sun_irradiance(self) -> Float[Array, "3"]:
        return self.sky.sun_irradiance

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return look_up(jnp.moveaxis(self.upper, 0, -1), *place(direction, self.sky.rotation))

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return self.sky.sun_radiance(direction)

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        levels = jnp.moveaxis(self.levels, 0, -1)
        return lobe_mean(lambda: self.radiance(direction), levels, direction, variance, self.sky.rotation)

    def irradiance(self) -> Float[Array, "3"]:
        return self.diffuse
