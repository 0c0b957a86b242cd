"""A sky with clouds, in the mean over where they are."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_kind, check_scalar
from ..._types import Scalar
from .._colour import luminance
from ._abstract import AbstractSky

TRANSMITTED = 0.25
"""Share of the clear sky's light that comes through a whole cover: 1 − 0.75 (Kasten & Czeplak 1980)."""


class CloudySky(AbstractSky):
    """A clear sky of which a share is hidden by grey clouds.

    $$ L = (1 - c)\\,L_{clear} + c\\,L_o, \\quad L_o = \\frac{3 E_o}{7π}\\,(1 + 2\\sin θ), \\quad E_o = t\\,E_{clear} $$

    with the overcast sky of Moon & Spencer, three times as bright overhead as at the horizon, whose irradiance E_o on
    the sea is the share t of what sun and sky would give without clouds. The sun's beam is (1 − c) times its own: the
    mean over where the clouds are. Broken clouds themselves are not drawn.

    **Arguments:**

    - `clear`: the sky between the clouds.
    - `cover`: c [-], from 0 to 1.
    - `transmitted`: t [-], 0.25 by default.

    All are differentiable. **Raises:** `ValueError` for numbers outside of their range or a `clear` that is no sky.

    **Source:** Moon & Spencer 1942; Kasten & Czeplak 1980 for t.
    """

    clear: AbstractSky
    cover: Scalar = eqx.field(converter=as_leaf, default=1.0)
    transmitted: Scalar = eqx.field(converter=as_leaf, default=TRANSMITTED)

    def __check_init__(self) -> None:
        check_kind("clear", self.clear, AbstractSky, "a sky such as `HosekWilkie()`")
        check_scalar("cover", self.cover, "", minimum=0.0, maximum=1.0)
        check_scalar("transmitted", self.transmitted, "", minimum=0.0, maximum=1.0)

    @property
    def sun_direction(self) -> Float[Array, "3"]:
        return self.clear.sun_direction

    @property
    def sun_irradiance(self) -> Float[Array, "3"]:
        return self._open(self.clear.sun_irradiance)

    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return self._open(self.clear.radiance(direction)) + self._overcast(jnp.abs(direction[..., 2]))

    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return self._open(self.clear.sun_radiance(direction))

    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        # Across two directions of variance σ² the mean of the axis itself is e^{-σ²} times as long.
        height = jnp.abs(direction[..., 2]) * jnp.exp(-variance.astype(direction.dtype))
        return self._open(self.clear.lobe_radiance(direction, variance)) + self._overcast(height)

    def irradiance(self) -> Float[Array, "3"]:
        return self._open(self.clear.irradiance()) + self._hidden()

    def _open(self, light: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        return (1 - self.cover.astype(light.dtype)) * light

    def _hidden(self) -> Float[Array, "3"]:
        """c E_o [W m⁻² nm⁻¹], grey."""
        height = jnp.maximum(self.clear.sun_direction[2], 0.0)
        clear = self.clear.irradiance() + self.clear.sun_irradiance * height
        share = (self.cover * self.transmitted.astype(self.cover.dtype)).astype(clear.dtype)
        return jnp.broadcast_to(share * luminance(clear), (3,))

    def _overcast(self, height: Float[Array, "*b"]) -> Float[Array, "*b 3"]:
        """c L_o towards directions with that sine of the elevation."""
        shape = 3 / (7 * jnp.pi) * (1 + 2 * height)
        return shape[..., None] * self._hidden().astype(height.dtype)
