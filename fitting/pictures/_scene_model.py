"""A scene that can be asked for its picture: wind, sea, light, camera and exposure, every number a leaf."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float

from jaxocean import Ocean, Wind
from jaxocean._constants import BREAKING_WAVENUMBER
from jaxocean._numerics import as_leaf, check_kind, check_scalar, optional_leaf, with_dtype
from jaxocean._types import Scalar
from jaxocean.optics import AbstractFoam, AbstractWater, Foam, Shading, Water
from jaxocean.optics.sky import AbstractSky, HosekWilkie
from jaxocean.render import Camera, Raster, Rays, render
from jaxocean.render._rays import average
from jaxocean.surface import Cascade, Fields, realise

from .._slopes import Slopes
from .._spectral_model import ElfouhailySea, SpectralModel


class SceneModel(eqx.Module):
    """Wind → spectrum → surface → whitecaps → radiance → picture, with the random numbers of the waves held.

    | leaf | unit | default | role |
    |---|---|---|---|
    | leaves of `wind` | theirs | | speed, direction, … |
    | leaves of `camera` | theirs | | where the picture is taken from |
    | `noise` | - | | random numbers of the waves (pattern, y, x), see `surface.draw_noise` |
    | `choppiness` λ | - | 1 | one number, or one per pattern |
    | `threshold` ε | - | 0.65 | breaking where j < ε |
    | `breaking_wavenumber` k_b | rad/m | 73.1 | low-pass of the strain that breaks; None for none |
    | leaves of `spectrum` | theirs | Elfouhaily, Ω = 0.84 | how a wind makes a spectrum |
    | leaves of `sky`, `water`, `foam`, `shading` | theirs | as in `jaxocean.Ocean` | the light |
    | `exposure` | stops | 0 | the picture is 2^exposure times the radiance |
    | `time` | s | 0 | |

    **Arguments:** the leaves above, and

    - `cascade`: sizes, bands, resolution.
    - `afloat`: whether the camera rides on the water, as on a buoy: its position then counts from the piece of water
      that rests at the origin, wherever the waves have moved that.

    **Raises:** `ValueError` for noise that does not fit the cascade, or leaves that make no sense.
    """

    wind: Wind
    camera: Camera
    cascade: Cascade = eqx.field(static=True, kw_only=True)
    noise: Complex[Array, "pattern y x"] = eqx.field(kw_only=True)
    choppiness: Float[Array, "..."] = eqx.field(
        converter=lambda x: as_leaf(jnp.asarray(x)), default=1.0, kw_only=True
    )
    threshold: Scalar = eqx.field(converter=as_leaf, default=0.65, kw_only=True)
    breaking_wavenumber: Scalar | None = eqx.field(
        converter=optional_leaf, default=BREAKING_WAVENUMBER, kw_only=True
    )
    spectrum: Callable = eqx.field(default_factory=ElfouhailySea, kw_only=True)
    sky: AbstractSky = eqx.field(default_factory=HosekWilkie, kw_only=True)
    water: AbstractWater = eqx.field(default_factory=Water, kw_only=True)
    foam: AbstractFoam = eqx.field(default_factory=Foam, kw_only=True)
    shading: Shading = eqx.field(default_factory=Shading, kw_only=True)
    exposure: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    time: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    afloat: bool = eqx.field(static=True, default=False, kw_only=True)

    def __check_init__(self) -> None:
        check_kind("wind", self.wind, Wind, "a `Wind`")
        check_kind("camera", self.camera, Camera, "a `Camera`")
        shape = (self.cascade.count, self.cascade.resolution, self.cascade.resolution)
        if self.noise.shape != shape:
            raise ValueError(
                f"Argument `noise` must have the shape {shape} of the cascade, but has {self.noise.shape}."
            )
        check_scalar("threshold", self.threshold, "")
        check_scalar("exposure", self.exposure, "stops")

    def ocean(self) -> Ocean:
        """The sea and its light, in the type of the noise."""
        scene = self.computed()
        return Ocean(
            realise(scene.spectrum(scene.wind), scene.cascade, noise=scene.noise),
            choppiness=scene.choppiness,
            threshold=scene.threshold,
            breaking_wavenumber=scene.breaking_wavenumber,
            sky=scene.sky,
            water=scene.water,
            foam=scene.foam,
            shading=scene.shading,
        )

    def computed(self) -> "SceneModel":
        """The same with every real number in the type of the noise: a fit varies doubles, pictures need none."""
        return with_dtype(self, self.noise.real.dtype)

    def statistics(self) -> SpectralModel:
        """The same sea without its waves: coverage and slopes in closed form."""
        return SpectralModel(
            self.threshold,
            self.choppiness,
            spectrum=self.spectrum,
            cascade=self.cascade,
            breaking_wavenumber=self.breaking_wavenumber,
        )

    def log_coverage(self, wind: Wind) -> Scalar:
        """log W of a plane, projected area, under any wind."""
        return self.statistics().log_coverage(wind)

    def slope_variance(self, wind: Wind) -> Slopes:
        """Slope variances along and across any wind [-], of all waves up to 2000 rad/m."""
        return self.statistics().slope_variance(wind)

    def picture(
        self, size: tuple[int, int], method: Raster | Rays | None = None, detail: int = 1
    ) -> Float[Array, "rows columns 3"]:
        """2^exposure times the radiance, linear with sRGB primaries.

        **Arguments:** `size`: rows and columns; `method`: see `jaxocean.render.render`; `detail`: the picture is drawn
        with so many times the rows and columns, and averaged.

        **Raises:** what `render` raises.
        """
        scene, ocean = self.computed(), self.ocean()
        camera = _on_the_water(scene.camera, ocean.fields(scene.time)) if self.afloat else scene.camera
        rows, columns = size
        light = render(ocean, camera, scene.time, (detail * rows, detail * columns), method=method)
        return average(light, (detail, detail)) * jnp.exp2(scene.exposure)


def _on_the_water(camera: Camera, fields: Fields) -> Camera:
    """The camera moved as the water at the origin is."""
    moved = jnp.sum(fields.displacement[:, 0, 0], axis=0), jnp.sum(fields.height[:, 0, 0], keepdims=True)
    shift = jnp.concatenate(moved).astype(camera.position.dtype)
    return eqx.tree_at(lambda c: c.position, camera, camera.position + shift)
