"""From an ocean and a camera to a picture."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._elementary import once
from .._numerics import as_leaf, check_kind, check_scalar, is_concrete
from .._types import Scalar, ScalarLike
from ..ocean import Ocean
from ..surface import Fields
from ._camera import Camera, check_above, check_size
from ._map_visible import Raster, map_image
from ._rays import Rays
from ._scene_light import Colour, SceneLight, channels
from ._visible import Pixels, Visible


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


@eqx.filter_jit
def _radiance(
    ocean: Ocean, camera: Camera, fields: Fields, size, method: Raster | Rays, curvature: Scalar, flat: bool
) -> Array:
    scene = SceneLight(ocean, fields.packed.real.dtype, flat)

    def shade(visible: Visible) -> Colour:
        def sea() -> Colour:
            return channels(scene.light(visible, once(scene.coverage(visible))).total)

        # Bands without sea, or without sky, cost no more than the other half.
        return jax.lax.cond(jnp.any(visible.hit), sea, lambda: (jnp.zeros_like(visible.depth),) * 3)

    colours, edges = map_image(
        shade, scene.background, fields, ocean.sea.cascade, camera, size, method=method, curvature=curvature
    )
    return jnp.stack([edges.blend(each) for each in colours], axis=-1)


@eqx.filter_jit
def _layers(
    ocean: Ocean, camera: Camera, fields: Fields, size, method: Raster | Rays, curvature: Scalar, flat: bool
) -> Layers:
    scene = SceneLight(ocean, fields.packed.real.dtype, flat)

    def shade(visible: Visible) -> Layers:
        strain, nothing = visible.strain, jnp.zeros((*visible.depth.shape, 3), visible.depth.dtype)
        covariance, coverage = scene.covariance(visible), scene.coverage(visible)
        light = scene.light(visible, coverage)
        return Layers(
            radiance=light.total,
            sun=light.sun,
            sky=light.sky,
            water=light.water,
            foam=light.foam,
            background=nothing,
            sea=jnp.ones_like(visible.depth),
            coverage=scene.seen_foam(visible, covariance, coverage),
            depth=visible.depth,
            rest_point=visible.rest_point,
            normal=visible.normal,
            slope_variance=covariance[..., 0, 0] + covariance[..., 1, 1],
            jacobian_mean=strain.jacobian_mean(),
            jacobian_variance=strain.jacobian_variance(),
        )

    def beyond(pixels: Pixels) -> Layers:
        sky = jnp.stack(scene.background(pixels), axis=-1)
        dark, none = jnp.zeros_like(sky), jnp.zeros(sky.shape[:-1], sky.dtype)
        return Layers(
            radiance=sky,
            sun=dark,
            sky=dark,
            water=dark,
            foam=dark,
            background=sky,
            sea=none,
            coverage=none,
            depth=none,
            rest_point=dark[..., :2],
            normal=dark,
            slope_variance=none,
            jacobian_mean=none,
            jacobian_variance=none,
        )

    layers, edges = map_image(
        shade, beyond, fields, ocean.sea.cascade, camera, size, method=method, curvature=curvature
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
