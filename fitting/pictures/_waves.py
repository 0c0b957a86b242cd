"""The waves themselves from pictures of them: every random number of a sea is free."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Complex, Float

from jaxocean._numerics import as_leaf, check_kind
from jaxocean._types import Scalar
from jaxocean.render import Camera, Raster, Rays

from .._errors import FitError
from ._descent import PictureStep
from ._picture_target import PictureTarget
from ._scene_model import SceneModel

MEMORY = 20
"""Steps that L-BFGS remembers."""

FIRST = 0.3
"""The longest step [standard deviations] of a random number at first."""

PATIENCE = 10
"""Steps that must together lower the cost by more than the tolerance."""


class View(eqx.Module):
    """One picture of a sea: from where, when, and what is seen.

    **Arguments:** `camera`; `time` [s]; `target`: the picture, in which everything but the waves is as in the scene.
    """

    camera: Camera
    time: Scalar = eqx.field(converter=as_leaf)
    target: PictureTarget


@dataclass(frozen=True)
class WavesFit:
    """Waves that explain pictures.

    - `noise`: the random numbers of the waves, most probable given pictures and spectrum.
    - `cost`: ½ Σ r²/s² + Σ|ξ|² there; `steps`: each tenth of the way, the start first, with `values` of the cost's two
      parts, `pictures` and `waves`; `converged`: whether it came to rest before the last allowed step.
    - `model`: the scene with these waves.
    """

    noise: Complex[np.ndarray, "pattern y x"]
    cost: float
    steps: tuple[PictureStep, ...]
    converged: bool
    seconds: float
    model: SceneModel


class _Sought(eqx.Module):
    scene: SceneModel
    views: tuple[View, ...]
    scatter: Scalar
    scale: Scalar
    method: Raster | Rays = eqx.field(static=True)

    def model(self, z: Float[Array, "2 pattern y x"]) -> SceneModel:
        real, imaginary = z * np.sqrt(0.5).astype(z.dtype)
        return eqx.tree_at(lambda scene: scene.noise, self.scene, jax.lax.complex(real, imaginary))

    def parts(self, z: Float[Array, "2 pattern y x"]) -> tuple[Scalar, Scalar]:
        """Cost of the pictures and of the waves."""
        scene, pictures = self.model(z), jnp.zeros((), z.dtype)
        for view in self.views:
            seen = eqx.tree_at(lambda s: (s.camera, s.time), scene, (view.camera, view.time))
            rows = view.target.residuals(seen.picture(view.target.size, self.method))
            pictures += 0.5 * jnp.sum(jnp.square(rows / self.scatter.astype(rows.dtype)))
        return pictures, 0.5 * jnp.sum(jnp.square(z))


def recover_waves(
    scene: SceneModel,
    views: Sequence[View],
    *,
    scatter: float = 0.05,
    method: Raster | Rays | None = None,
    most_steps: int = 300,
    tolerance: float = 1e-3,
    report: Callable[[PictureStep], None] | None = None,
) -> WavesFit:
    """The most probable waves of a sea of which there are pictures.

    $$ \\min_ξ ½ \\sum_v \\sum_l |r_l(ξ)|²/s² + \\sum_k |ξ_k|² $$

    by L-BFGS, with one gradient of all pictures a step. The second sum is what the spectrum expects of its random
    numbers: it holds waves that no picture shows at their most probable size, 0. As the random numbers are alike for
    long and short waves, they are also a good scale for the way down.

    **Arguments:**

    - `scene`: everything but the waves; its `noise` is where the search begins: zeros are a good place.
    - `views`: the pictures.
    - `scatter`: s [-], how far pictures are off from what the right waves would give, in log light.
    - `method`: how pixels find the sea, `Raster()` if None.
    - `most_steps`: after which it stops, wherever it is.
    - `tolerance`: it is done when 10 steps together lower the cost by less than this share.
    - `report`: called with the start and with every tenth step.

    **Returns:** `WavesFit`; look at `converged`.

    **Raises:** `ValueError` for arguments that make no sense; `FitError` if the picture at the start is not finite.
    """
    check_kind("scene", scene, SceneModel, "a `SceneModel`")
    if not views:
        raise ValueError("Argument `views` must hold at least one `View`, but is empty.")
    if not scatter > 0:
        raise ValueError(f"Argument `scatter` must be above 0, but is {scatter:g}.")
    if most_steps < 1:
        raise ValueError(f"Argument `most_steps` must be at least 1, but is {most_steps}.")
    began = time.perf_counter()
    method = Raster() if method is None else method
    dtype = scene.noise.real.dtype
    sought = _Sought(scene, tuple(views), jnp.asarray(scatter, dtype), jnp.ones((), dtype), method)
    z = jnp.stack([scene.noise.real, scene.noise.imag]) * np.sqrt(2).astype(dtype)
    solver = optx.LBFGS(1e-12, 1e-12, history_length=MEMORY)
    value, parts = jax.eval_shape(_cost, z, sought)
    # Another state from `init` holds other functions, and its step would be compiled again.
    start = solver.init(_cost, z, sought, {}, value, parts, frozenset())
    # Its first step is as long as the slope: once to see that, and then from the start again with a fitting scale.
    _, state = _step(solver, z, start, sought)
    steepest = float(jnp.max(jnp.abs(state.f_info.grad)))
    if not np.isfinite(steepest):
        raise FitError(
            "The picture of the starting waves, or its derivative, is not finite",
            "a number that no scene has",
            "start from another scene",
        )
    scale = jnp.asarray(FIRST / steepest if steepest > 0 else 1.0, dtype)
    sought = eqx.tree_at(lambda s: s.scale, sought, scale)
    state = start
    steps, costs, converged = [], [], False
    for number in range(most_steps + 1):
        # What a step evaluates is where the one before it led; if that is no better, it goes back halfway.
        z, state = _step(solver, z, state, sought)
        costs.append(float(state.f_info.f / scale))
        if number % PATIENCE == 0:
            values: dict[str, Any] = dict(
                zip(("pictures", "waves"), (float(part) for part in state.aux), strict=True)
            )
            steps.append(PictureStep(number, 1, costs[-1], values))
            if report is not None:
                report(steps[-1])
            if number and costs[-1] > (1 - tolerance) * costs[-1 - PATIENCE]:
                converged = True
                break
    model = sought.model(z)
    return WavesFit(
        np.asarray(model.noise), costs[-1], tuple(steps), converged, time.perf_counter() - began, model
    )


def _cost(z: Array, sought: _Sought) -> tuple[Scalar, tuple[Scalar, Scalar]]:
    pictures, waves = sought.parts(z)
    return sought.scale * (pictures + waves), (pictures, waves)


@eqx.filter_jit
def _step(solver: optx.LBFGS, z: Array, state: Any, sought: _Sought) -> tuple[Array, Any]:
    return solver.step(_cost, z, sought, {}, state, frozenset())[:2]
