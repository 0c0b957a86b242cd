"""From an ocean and a camera to a picture."""

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._elementary import once
from .._numerics import as_leaf, check_kind, check_scalar, is_concrete
from .._types import FloatLike, Scalar, ScalarLike
from ..filtering import symmetric_matrix
from ..ocean import Ocean
from ..optics import SurfaceRadiance, foam_in_view, surface_radiance
from ..optics.sky import AbstractSky, ImageSky, LocalSky, Mirror, bake
from ..surface import Fields
from ..whitecaps import AbstractClosure, ExactClosure, FastClosure, StrainStatistics
from ._camera import Camera, check_above, check_size
from ._planet import Components, to_local
from ._rays import Rays
from ._visible import Raster, Visible, map_visible


class Layers(eqx.Module):
    """A picture and what it is made of; every array has the rows and columns of the image.

    | layer | unit | shape after rows, columns |
    |---|---|---|
    | `radiance` | that of the sky | 3, linear sRGB; the sum of the next five |
    | `sun`, `sky`, `water`, `foam` | that of the sky | 3: glitter, mirrored sky, light from the water, whitecaps |
    | `background` | that of the sky | 3: the sky above the horizon |
    | `sea` | - | share of the pixel that is sea |
    | `coverage` | - | share W of the visible sea that is foam |
    | `depth` | m | distance from the pinhole |
    | `rest_point` | m | 2: (x, y) at rest |
    | `normal` | - | 3: of the mean slope, upwards, in the world |
    | `slope_variance` | - | mean square slope inside the footprint, both directions together |
    | `jacobian_mean`, `jacobian_variance` | - | of j inside the footprint |

    Where no sea is seen the layers of the sea are 0.
    """

    radiance: Float[Array, "rows columns 3"]
    sun: Float[Array, "rows columns 3"]
    sky: Float[Array, "rows columns 3"]
    water: Float[Array, "rows columns 3"]
    foam: Float[Array, "rows columns 3"]
    background: Float[Array, "rows columns 3"]
    sea: Float[Array, "rows columns"]
    coverage: Float[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    rest_point: Float[Array, "rows columns 2"]
    normal: Float[Array, "rows columns 3"]
    slope_variance: Float[Array, "rows columns"]
    jacobian_mean: Float[Array, "rows columns"]
    jacobian_variance: Float[Array, "rows columns"]


def render(
    ocean: Ocean,
    camera: Camera,
    time: ScalarLike,
    size: tuple[int, int] = (720, 1280),
    *,
    method: Raster | Rays | None = None,
    curvature: ScalarLike = 0.0,
) -> Float[Array, "rows columns 3"]:
    """The picture of an ocean, as linear light.

    Every pixel sees a footprint of the surface. Waves larger than it are seen as such; smaller ones through the mean
    and the covariance of their slopes, which mirror the sky and the sun, and of their strain, from which the closure
    says how much of the pixel is foam. Differentiable in every leaf of ocean and camera, and in the time.

    **Arguments:**

    - `ocean`, `camera`: see there; `time`: t [s].
    - `size`: (rows, columns) of the image.
    - `method`: how the water that a pixel sees is found, `Raster()` or `Rays()`; `Raster()` if None.
    - `curvature`: of the planet [1/m], 0 for a plane; see `EARTH_CURVATURE`.

    **Returns:** radiance, linear with sRGB primaries, in the unit of the sky's radiance.

    **Raises:** `ValueError` for arguments of the wrong kind, a size or curvature that makes no sense, or a camera under
    water.

    **Source:** Dupuy & Bruneton 2012, with the exact closure in place of their eqs 6–8.
    """
    return _radiance(*_prepared(ocean, camera, time, size, method, curvature))


def render_layers(
    ocean: Ocean,
    camera: Camera,
    time: ScalarLike,
    size: tuple[int, int] = (720, 1280),
    *,
    method: Raster | Rays | None = None,
    curvature: ScalarLike = 0.0,
) -> Layers:
    """The picture with everything that it is made of.

    **Arguments**, **Raises:** those of `render`. **Returns:** `Layers`.
    """
    return _layers(*_prepared(ocean, camera, time, size, method, curvature))


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


def _prepared(ocean, camera, time, size, method, curvature) -> tuple:
    check_kind("ocean", ocean, Ocean, "an `Ocean`")
    check_kind("camera", camera, Camera, "a `Camera`")
    if method is not None:
        check_kind("method", method, (Raster, Rays), "`Raster()` or `Rays()`")
    check_size(size)
    # A plane that is known to be one has the same vertical everywhere, and its light costs less. Before it becomes an
    # array, which would not be known while a program is traced.
    flat = is_concrete(curvature) and float(curvature) == 0
    curvature = as_leaf(curvature)
    check_scalar("curvature", curvature, "1/m", minimum=0.0)
    # A plain number for the time keeps its double precision, and compiles nothing anew.
    fields = ocean.fields(time)
    if all(is_concrete(leaf) for leaf in jax.tree.leaves((camera, ocean.sea, ocean.choppiness, time))):
        check_above(camera, ocean.sea, time, ocean.choppiness, fields)
    return ocean, camera, fields, size, Raster() if method is None else method, curvature, flat


Colour = tuple[Float[Array, "rows columns"], ...]
"""One array for each channel: XLA on the CPU is slow with short last axes."""


class _Scene:
    """An ocean's light on what a camera sees, in the type of its fields."""

    def __init__(self, ocean: Ocean, dtype: jnp.dtype, flat: bool) -> None:
        def cast(x: Any) -> Any:
            return x.astype(dtype) if eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating) else x

        self.ocean, self.flat = jax.tree.map(cast, ocean), flat
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

    def background(self, visible: Visible) -> Colour:
        """The sky where no sea is seen, else 0."""
        sky, rays, above = self.ocean.sky, visible.rays, ~visible.hit

        def seen() -> Colour:
            dome = sky.radiance(rays) if self.flat else self.thin_air(visible)
            colours = zip(_channels(dome), _channels(sky.sun_radiance(rays)), strict=True)
            return tuple(jnp.where(above, dome + sun, 0.0) for dome, sun in colours)

        return jax.lax.cond(jnp.any(above), seen, lambda: (jnp.zeros(above.shape, rays.dtype),) * 3)

    def thin_air(self, visible: Visible) -> Float[Array, "rows columns 3"]:
        """The dome over a round planet: that over the lowest place of each ray, as dense as the air is there.

        The density is a mean over the heights that the pixel spans, lest the thin ring around the planet be dotted.
        """
        rays = visible.rays
        x, y, z = (rays[..., i] for i in range(3))
        curvature, height = visible.curvature, visible.camera.position[2]
        # In radii of the planet, from its centre.
        start = 1 + curvature * height
        way = start * jnp.maximum(-z, 0.0)
        lowest = way * x, way * y, start + way * z
        radius = jnp.sqrt(jnp.maximum(lowest[0] ** 2 + lowest[1] ** 2 + lowest[2] ** 2, 1e-12))
        up = lowest[0] / radius, lowest[1] / radius, lowest[2] / radius
        bent = curvature > 0
        above = jnp.where(bent, (radius - 1) / jnp.where(bent, curvature, 1.0), height)
        half = 0.5 * jnp.where(bent, way / jnp.where(bent, curvature, 1.0), 0.0)
        half = half / visible.camera.focal_length(visible.size)
        bottom = jnp.maximum(above - half, 0.0)
        thick = jnp.maximum(jnp.maximum(above, 0.0) + half - bottom, SCALE_HEIGHT * 1e-3) / SCALE_HEIGHT
        density = jnp.exp(-bottom / SCALE_HEIGHT) * -jnp.expm1(-thick) / thick
        dome = self.local(self.ocean.sky, up).radiance(jnp.stack(to_local((x, y, z), up), axis=-1))
        return jnp.stack([density * dome[..., i] for i in range(3)], axis=-1)


def _channels(colour: Float[Array, "rows columns 3"]) -> Colour:
    return tuple(once(colour[..., i]) for i in range(3))


@eqx.filter_jit
def _radiance(
    ocean: Ocean, camera: Camera, fields: Fields, size, method: Raster | Rays, curvature: Scalar, flat: bool
) -> Array:
    scene = _Scene(ocean, fields.packed.real.dtype, flat)

    def shade(visible: Visible) -> Colour:
        hit = visible.hit

        def sea() -> Colour:
            total = _channels(scene.light(visible, once(scene.coverage(visible))).total)
            return tuple(jnp.where(hit, each, 0.0) for each in total)

        # Bands without sea, or without sky, cost no more than the other half.
        below = jax.lax.cond(jnp.any(hit), sea, lambda: (jnp.zeros_like(visible.depth),) * 3)
        return tuple(a + b for a, b in zip(below, scene.background(visible), strict=True))

    channels, edges = map_visible(
        shade, fields, ocean.sea.cascade, camera, size, method=method, curvature=curvature
    )
    return jnp.stack([edges.blend(each) for each in channels], axis=-1)


@eqx.filter_jit
def _layers(
    ocean: Ocean, camera: Camera, fields: Fields, size, method: Raster | Rays, curvature: Scalar, flat: bool
) -> Layers:
    scene = _Scene(ocean, fields.packed.real.dtype, flat)

    def shade(visible: Visible) -> Layers:
        hit, strain = visible.hit, visible.strain
        covariance, coverage = scene.covariance(visible), scene.coverage(visible)
        light, background = scene.light(visible, coverage), jnp.stack(scene.background(visible), axis=-1)

        def sea(x: Array) -> Array:
            return jnp.where(hit.reshape(hit.shape + (1,) * (x.ndim - 2)), x, 0.0)

        return Layers(
            radiance=sea(light.total) + background,
            sun=sea(light.sun),
            sky=sea(light.sky),
            water=sea(light.water),
            foam=sea(light.foam),
            background=background,
            sea=hit.astype(covariance.dtype),
            coverage=sea(scene.seen_foam(visible, covariance, coverage)),
            depth=sea(visible.depth),
            rest_point=sea(visible.rest_point),
            normal=sea(visible.normal),
            slope_variance=sea(covariance[..., 0, 0] + covariance[..., 1, 1]),
            jacobian_mean=sea(strain.jacobian_mean()),
            jacobian_variance=sea(strain.jacobian_variance()),
        )

    layers, edges = map_visible(
        shade, fields, ocean.sea.cascade, camera, size, method=method, curvature=curvature
    )
    if isinstance(method, Rays):
        layers = _of_the_sea(layers)
    # Only light and shares mix along silhouettes; the mean of two distances is the distance of nothing.
    mixed = ("radiance", "sun", "sky", "water", "foam", "background", "sea", "coverage")
    return eqx.tree_at(
        lambda picture: [getattr(picture, name) for name in mixed],
        layers,
        [edges.blend(getattr(layers, name)) for name in mixed],
    )


def _of_the_sea(layers: Layers) -> Layers:
    """The same with what only the sea has as means over those rays of each pixel that see it."""
    own = ("depth", "rest_point", "normal", "slope_variance", "jacobian_mean", "jacobian_variance")
    share = jnp.where(layers.sea > 0, layers.sea, 1.0)

    def mean(name: str) -> Array:
        values = getattr(layers, name)
        return values / share.reshape(share.shape + (1,) * (values.ndim - 2))

    return eqx.tree_at(lambda each: [getattr(each, n) for n in own], layers, [mean(n) for n in own])


def _fast(closure: AbstractClosure) -> AbstractClosure:
    """The form for millions of footprints, in projected area, of the closure that the whole sea has."""
    return FastClosure("projected") if isinstance(closure, ExactClosure) else closure
