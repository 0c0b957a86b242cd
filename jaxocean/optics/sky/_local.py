"""One sky over many places of a round planet."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._elementary import once
from ..._numerics import safe_angle, safe_divide, safe_norm
from ._abstract import AbstractSky
from ._sun import even_disc, visible_fraction
from ._twilight import twilight


class LocalSky(AbstractSky):
    """The sky of one place as it stands over others, each of which has a vertical of its own.

    Directions, the sun's too, are relative to that vertical. An approximation, for a sky is known at one place alone:
    everywhere the dome is that of `sky`, and so is the beam as long as the sun is up. Where the sun has set by itself
    the beam is gone, and the dome darkens as `twilight` says. Of a `sky` without a beam (at night, say) nobody has one.

    **Arguments:** `sky`: over its own place; `to_sun`: unit vectors (*b, 3) towards the sun, one for each place.
    """

    sky: AbstractSky
    to_sun: Float[Array, "*b 3"]

    @property
    def sun_direction(self) -> Float[Array, "*b 3"]:
        return self.to_sun

    @property
    def sun_irradiance(self) -> Float[Array, "*b 3"]:
        return _times(visible_fraction(_elevation(self.to_sun)), self._whole_beam())

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return _times(self._day(), self.sky.radiance(direction))

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return even_disc(self._whole_beam(), self.to_sun, direction)

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        return _times(self._day(), self.sky.lobe_radiance(direction, variance))

    def irradiance(self) -> Float[Array, "*b 3"]:
        return _times(self._day(), self.sky.irradiance())

    def _whole_beam(self) -> Float[Array, "3"]:
        share = visible_fraction(_elevation(self.sky.sun_direction))
        return safe_divide(self.sky.sun_irradiance, jnp.broadcast_to(share, (3,)))

    def _day(self) -> Float[Array, "*b"]:
        """How bright the dome is over each place, relative to its own."""
        own = twilight(_elevation(self.sky.sun_direction))
        return once(twilight(_elevation(self.to_sun)) / own.astype(self.to_sun.dtype))


def _elevation(direction: Float[Array, "*b 3"]) -> Float[Array, "*b"]:
    return safe_angle(safe_norm(direction[..., 0], direction[..., 1]), direction[..., 2])


def _times(factor: Float[Array, "*b"], colour: Float[Array, "*#b 3"]) -> Float[Array, "*b 3"]:
    return jnp.stack([factor * colour[..., i].astype(factor.dtype) for i in range(3)], axis=-1)
