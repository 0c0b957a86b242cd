"""What a photograph of the sea may show: a scene whose waves are unknown and whose whitecaps follow a law."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float

from jaxocean._numerics import as_leaf, check_kind
from jaxocean._types import Scalar
from jaxocean.render import Raster, Rays
from jaxocean.surface import draw_noise
from jaxocean.whitecaps import breaking_threshold
from jaxocean.whitecaps.laws import AbstractLaw, Monahan1980

from ._scene_model import SceneModel

MOST = 0.9
"""Largest coverage [-] that a law may ask for."""


class Photograph(eqx.Module):
    """A scene that breaks as a law says, seen by a camera with a response of its own.

    $$ ε: W(ε) = 10^{δ}\\, W_{law}(U_{10}), \\quad L' = \\mathrm{blurred}_b(L)^{γ} $$

    Nothing in one picture of unknown waves tells ε from λ; how much foam there is at a wind, a law knows, up to what
    seas of the same wind differ by.

    | leaf | unit | default | role |
    |---|---|---|---|
    | leaves of `scene` | theirs | | all but its `threshold`, which follows |
    | leaves of `law` | theirs | Monahan 1980 | coverage of a wind |
    | `excess` δ | - | 0 | log10 of this sea's coverage over the law's |
    | `contrast` γ | - | 1 | of the camera, 1 for linear light |
    | `blur` b | - | 0 | share of its light that a pixel has from each of its neighbours; below 0 it is sharpened |

    **Raises:** `ValueError` for a scene or a law that is none.
    """

    scene: SceneModel
    law: AbstractLaw = eqx.field(default_factory=Monahan1980)
    excess: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)
    contrast: Scalar = eqx.field(converter=as_leaf, default=1.0, kw_only=True)
    blur: Scalar = eqx.field(converter=as_leaf, default=0.0, kw_only=True)

    def __check_init__(self) -> None:
        check_kind("scene", self.scene, SceneModel, "a `SceneModel`")
        check_kind("law", self.law, AbstractLaw, "a whitecap law such as `Monahan1980()`")

    def breaking(self) -> SceneModel:
        """The scene with the threshold that the law asks for, in the type of its noise."""
        scene = self.scene.computed()
        dtype = scene.noise.real.dtype
        share = self.law.coverage(scene.wind).astype(dtype) * 10.0 ** self.excess.astype(dtype)
        stats = scene.ocean().statistics()
        threshold = breaking_threshold(stats, jnp.clip(share, 1e-7, MOST))
        return eqx.tree_at(lambda s: s.threshold, scene, threshold)

    def picture(
        self, size: tuple[int, int], method: Raster | Rays | None = None, detail: int = 1
    ) -> Float[Array, "rows columns 3"]:
        """What the camera shows of the sea with the noise of the scene.

        **Arguments:** `size`, `method`: as for `SceneModel.picture`; `detail`: the picture is drawn with so many times
        the rows and columns, and averaged.
        """
        return self.pictures(self.scene.noise[None], size, method, detail)[0]

    def pictures(
        self,
        noises: Complex[Array, "sea pattern y x"],
        size: tuple[int, int],
        method: Raster | Rays | None = None,
        detail: int = 1,
    ) -> Float[Array, "sea rows columns 3"]:
        """Pictures of several seas of this state, one after the other."""
        scene = self.breaking()

        def of(noise: Array) -> Array:
            return self.seen(eqx.tree_at(lambda s: s.noise, scene, noise).picture(size, method, detail))

        return jax.lax.map(of, noises)

    def noises(self, count: int, seed: int) -> Complex[Array, "sea pattern y x"]:
        """Random numbers for so many seas."""
        keys = jax.random.split(jax.random.key(seed), count)
        drawn = [draw_noise(self.scene.cascade, key=key) for key in keys]
        return jnp.stack(drawn).astype(self.scene.noise.dtype)

    def seen(self, light: Float[Array, "rows columns 3"]) -> Float[Array, "rows columns 3"]:
        """What the camera makes of light."""
        for axis in (0, 1):
            share = self.blur.astype(light.dtype)
            # At the edges a pixel is its own neighbour.
            before, after = (jnp.concatenate(parts, axis) for parts in _shifted(light, axis))
            light = (1 - 2 * share) * light + share * (before + after)
        # No light at all has no logarithm, and no derivative of a power.
        return jnp.maximum(light, 1e-9) ** self.contrast.astype(light.dtype)


def _shifted(light: Array, axis: int) -> tuple[list[Array], list[Array]]:
    count = light.shape[axis]
    first, last = (jax.lax.slice_in_dim(light, i, i + 1, axis=axis) for i in (0, count - 1))
    body, rest = (jax.lax.slice_in_dim(light, i, i + count - 1, axis=axis) for i in (0, 1))
    return [first, body], [rest, last]
