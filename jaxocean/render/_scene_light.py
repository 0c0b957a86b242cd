"""The light of an ocean on what a camera sees."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._elementary import once
from .._numerics import with_dtype
from .._types import FloatLike
from ..filtering import symmetric_matrix
from ..ocean import Ocean
from ..optics import SurfaceRadiance, foam_in_view, surface_radiance
from ..optics.sky import AbstractSky, ImageSky, LocalSky, Mirror, bake
from ..whitecaps import AbstractClosure, ExactClosure, FastClosure, StrainStatistics
from ._planet import Components, to_local
from ._visible import Pixels, Visible


def seen_coverage(
    strain: StrainStatistics,
    threshold: FloatLike,
    closure: AbstractClosure,
    area: Float[Array, "*b"] | None = None,
) -> Float[Array, "*b"]:
    """The share of a footprint's visible area that is foam.

    $$ W = E[j\\, 1_{j < ε}] / E[j] $$

    The closure in projected area counts foam per area at rest; E[j] is the footprint's own visible area by the same
    measure. A footprint that has shrunk to a point is foam or not, one that holds the whole sea has E[j] = 1. Where a
    mesh is drawn that does not follow every crest, its own area takes the place of E[j], so that all foam together
    covers what it should.

    **Arguments:** `strain` of the footprints; `threshold` ε [-]; `closure` in projected area; `area`: of the surface as
    it is drawn, seen from above, over its area at rest [-], E[j] if None.

    **Returns:** W [-], from 0 to 1.
    """
    drawn = strain.jacobian_mean() if area is None else area
    return jnp.clip(closure(strain, threshold) / jnp.maximum(drawn, SMALLEST_AREA), 0.0, 1.0)


SMALLEST_AREA = 1e-3
"""A footprint squeezed to less than this is edge-on or inside a fold."""

SCALE_HEIGHT = 8e3
"""Height [m] over which the air of a round planet thins out by a factor e."""


Colour = tuple[Float[Array, "rows columns"], ...]
"""One array for each channel: XLA on the CPU is slow with short last axes."""


class SceneLight:
    """An ocean's light on what a camera sees, in the type of its fields."""

    def __init__(self, ocean: Ocean, dtype: jnp.dtype, flat: bool) -> None:
        self.ocean, self.flat = with_dtype(ocean, dtype), flat
        self.unresolved = self.ocean.unresolved_slopes()
        # The mirrored sky is looked up in a table: its lobes cost the same however wide they are.
        sky = self.ocean.sky
        self.mirrored = Mirror.of_sky(sky if isinstance(sky, ImageSky) else bake(sky))

    def covariance(self, visible: Visible) -> Float[Array, "*b 2 2"]:
        pairs = ((0, 0), (1, 1), (0, 1))
        parts = [own + self.unresolved[at] for own, at in zip(visible.seen.slopes, pairs, strict=True)]
        return symmetric_matrix(jnp.stack(parts, axis=-1))

    def coverage(self, visible: Visible) -> Float[Array, "*b"]:
        return seen_coverage(visible.strain, self.ocean.threshold, _fast(self.ocean.closure), visible.area)

    def light(self, visible: Visible, coverage: Float[Array, "*b"]) -> SurfaceRadiance:
        ocean = self.ocean
        sky = self.mirrored if self.flat else self.local(self.mirrored, visible.up)
        return surface_radiance(
            self.to_viewer(visible),
            visible.slope,
            self.covariance(visible),
            coverage,
            sky,
            ocean.water,
            ocean.foam,
            shading=ocean.shading,
        )

    def local(self, sky: AbstractSky, up: Components) -> LocalSky:
        """The sky over places with the vertical `up`."""
        sun = sky.sun_direction.astype(up[0].dtype)
        x, y, z = (jnp.broadcast_to(sun[i], up[0].shape) for i in range(3))
        return LocalSky(sky, jnp.stack(to_local((x, y, z), up), axis=-1))

    def to_viewer(self, visible: Visible) -> Float[Array, "*b 3"]:
        """Unit vectors to the camera, relative to the vertical of each place."""
        rays = visible.rays
        # Component by component: XLA on the CPU is slow with short last axes.
        there = -rays[..., 0], -rays[..., 1], -rays[..., 2]
        return jnp.stack(there if self.flat else to_local(there, visible.up), axis=-1)

    def seen_foam(
        self, visible: Visible, covariance: Float[Array, "*b 2 2"], coverage: Float[Array, "*b"]
    ) -> Float[Array, "*b"]:
        """The coverage as it is seen past the waves inside the footprint."""
        view = self.ocean.shading.foam_view
        return foam_in_view(self.to_viewer(visible), visible.slope, covariance, coverage, view)

    def background(self, pixels: Pixels) -> Colour:
        """The sky where no sea is seen, else 0."""
        sky, rays, above = self.ocean.sky, pixels.rays, ~pixels.hit

        def seen() -> Colour:
            dome = sky.radiance(rays) if self.flat else self.thin_air(pixels)
            colours = zip(channels(dome), channels(sky.sun_radiance(rays)), strict=True)
            return tuple(jnp.where(above, dome + sun, 0.0) for dome, sun in colours)

        return jax.lax.cond(jnp.any(above), seen, lambda: (jnp.zeros(above.shape, rays.dtype),) * 3)

    def thin_air(self, pixels: Pixels) -> Float[Array, "rows columns 3"]:
        """The dome over a round planet: that over the lowest place of each ray, as dense as the air is there.

        The density is a mean over the heights that the pixel spans, lest the thin ring around the planet be dotted.
        """
        rays = pixels.rays
        x, y, z = (rays[..., i] for i in range(3))
        curvature, height = pixels.curvature, pixels.camera.position[2]
        # In radii of the planet, from its centre.
        start = 1 + curvature * height
        way = start * jnp.maximum(-z, 0.0)
        lowest = way * x, way * y, start + way * z
        radius = jnp.sqrt(jnp.maximum(lowest[0] ** 2 + lowest[1] ** 2 + lowest[2] ** 2, 1e-12))
        up = lowest[0] / radius, lowest[1] / radius, lowest[2] / radius
        bent = curvature > 0
        above = jnp.where(bent, (radius - 1) / jnp.where(bent, curvature, 1.0), height)
        half = 0.5 * jnp.where(bent, way / jnp.where(bent, curvature, 1.0), 0.0)
        half = half / pixels.camera.focal_length(pixels.size)
        bottom = jnp.maximum(above - half, 0.0)
        thick = jnp.maximum(jnp.maximum(above, 0.0) + half - bottom, SCALE_HEIGHT * 1e-3) / SCALE_HEIGHT
        density = jnp.exp(-bottom / SCALE_HEIGHT) * -jnp.expm1(-thick) / thick
        dome = self.local(self.ocean.sky, up).radiance(jnp.stack(to_local((x, y, z), up), axis=-1))
        return jnp.stack([density * dome[..., i] for i in range(3)], axis=-1)


def channels(colour: Float[Array, "rows columns 3"]) -> Colour:
    """Each channel by itself, computed once."""
    return tuple(once(colour[..., i]) for i in range(3))


def _fast(closure: AbstractClosure) -> AbstractClosure:
    """The form for millions of footprints, in projected area, of the closure that the whole sea has."""
    return FastClosure("projected") if isinstance(closure, ExactClosure) else closure
