"""Where silhouettes pass between neighbouring pixels: crest edges without stairs, and with a gradient."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class Edges(eqx.Module):
    """Silhouettes between the centres of neighbouring pixels.

    A number c from −½ to ½ says where: at the common border of the two pixels 0, at the centre of the left or upper
    one −½. The pixel on the side of which it passes gets the share |c| of the other's colour. 0 also stands for no
    silhouette.

    **Arguments:** `across`: between left and right neighbours; `down`: between upper and lower ones.
    """

    across: Float[Array, "rows columns_less_one"]
    down: Float[Array, "rows_less_one columns"]

    def blend(self, image: Float[Array, "rows columns *c"]) -> Float[Array, "rows columns *c"]:
        """The image with each silhouette's pixel mixed by the area on both of its sides."""
        extra = (1,) * (image.ndim - 2)
        across = self.across.reshape(self.across.shape + extra)
        down = self.down.reshape(self.down.shape + extra)
        return image + _mixed(image, across, 1) + _mixed(image, down, 0)


def _mixed(
    image: Float[Array, "rows columns *c"], place: Float[Array, "some more *#c"], axis: int
) -> Float[Array, "rows columns *c"]:
    """What each pixel gets from its two neighbours along an axis: one loop over all pixels, with nothing updated."""
    change = jnp.diff(image, axis=axis)

    def wider(values, before: int, after: int):
        return jnp.pad(values, [(before, after) if i == axis else (0, 0) for i in range(values.ndim)])

    return wider(jnp.maximum(-place, 0) * change, 0, 1) - wider(jnp.maximum(place, 0) * change, 1, 0)
