"""Means of any channels of the patterns over footprints."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ._boxes import Levels
from ._footprint import DEFAULT_PROBES, Footprint, check_probes
from ._look_up import average_probes, computing_type, look_up, reduce_centres


class MeanPyramid(eqx.Module):
    """Channels of every pattern, box-filtered to all levels: linear, and nothing but.

    **Arguments:** `sizes` L_i [m] and `resolution`, samples a side; `texture`: all levels of each pattern.

    `from_channels` makes one.
    """

    sizes: tuple[float, ...] = eqx.field(static=True)
    resolution: int = eqx.field(static=True)
    texture: Float[Array, "pattern texel channel"]

    @classmethod
    def from_channels(
        cls, channels: Float[Array, "pattern y x channel"], sizes: tuple[float, ...]
    ) -> "MeanPyramid":
        """The pyramid of fields sampled on the patterns' grids; at most eight channels are read at full speed."""
        resolution = channels.shape[-2]
        return cls(sizes, resolution, Levels(resolution).build(channels))

    def stored_as(self, dtype: jnp.dtype | type) -> "MeanPyramid":
        """The same rounded to another floating-point type; look-ups compute in that of the footprint."""
        return MeanPyramid(self.sizes, self.resolution, self.texture.astype(dtype))

    def __call__(
        self, footprint: Footprint, probes: int = DEFAULT_PROBES
    ) -> Float[Array, "*b pattern channel"]:
        """Means over footprints, per pattern.

        **Arguments:** `footprint`: see `Footprint`; `probes`: isotropic probes along its longer axis.
        """
        check_probes(probes)
        dtype = computing_type(self.texture.dtype)
        centres = reduce_centres(footprint, self.sizes, self.resolution, dtype)
        return _means(self, centres, jnp.asarray(footprint.axes, dtype), probes)


@eqx.filter_jit
def _means(
    pyramid: MeanPyramid, centres: Float[Array, "n *b 2"], axes: Float[Array, "*c 2 2"], probes: int
) -> Float[Array, "*b n channel"]:
    batch = jnp.broadcast_shapes(centres.shape[1:-1], axes.shape[:-2])
    means = []
    for texture, centre, size in zip(pyramid.texture, centres, pyramid.sizes, strict=True):

        def look(place, variance, texture=texture):
            return tuple(look_up((texture,), pyramid.resolution, place, variance)[0])

        shape = jnp.broadcast_to(axes * (pyramid.resolution / size), (*batch, 2, 2))
        means += average_probes(look, jnp.broadcast_to(centre, (*batch, 2)), shape, probes)
    return jnp.stack(means, axis=-2)
