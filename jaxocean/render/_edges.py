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
        left, right = image[:, :-1], image[:, 1:]
        across = self.across.reshape(self.across.shape + extra)
        change = right - left
        result = image.at[:, 1:].add(-jnp.maximum(across, 0) * change)
        result = result.at[:, :-1].add(jnp.maximum(-across, 0) * change)
        down = self.down.reshape(self.down.shape + extra)
        change = image[1:] - image[:-1]
        result = result.at[1:].add(-jnp.maximum(down, 0) * change)
        return result.at[:-1].add(jnp.maximum(-down, 0) * change)
