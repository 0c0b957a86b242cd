"""A picture's residuals as a function of the free numbers of a scene."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean.render import Raster, Rays

from .._bounds import AbstractBounds
from .._parameters import Slot, split
from .._priors import AbstractPrior
from .._target import AbstractTarget


class PictureProblem(eqx.Module):
    """Residuals of a flat vector of free numbers.

    **Arguments:** `model`: answers `picture(size, method)`, or with a `detail` above 1 `picture(size, method, detail)`;
    `target`: has a `size` and answers `residuals(picture)`.
    """

    model: Any
    target: Any
    beside: tuple[AbstractTarget, ...]
    priors: tuple[AbstractPrior | None, ...]
    slots: tuple[Slot, ...] = eqx.field(static=True)
    method: Raster | Rays = eqx.field(static=True)
    detail: int = eqx.field(static=True, default=1)

    def start(self) -> Float[Array, " p"]:
        leaves = jax.tree.leaves(self.model)
        values = jnp.concatenate([jnp.ravel(jnp.asarray(leaves[s.index], float)) for s in self.slots])
        return self.unconstrain(values)

    def unconstrain(self, values: Float[Array, " p"]) -> Float[Array, " p"]:
        return self._each(values, lambda bounds, x: bounds.unconstrain(x))

    def constrain(self, free: Float[Array, " p"]) -> Float[Array, " p"]:
        return self._each(free, lambda bounds, x: bounds.constrain(x))

    def stretch(self, free: Float[Array, " p"]) -> Float[Array, " p"]:
        """How fast values change with free numbers."""
        return jax.jvp(self.constrain, (free,), (jnp.ones_like(free),))[1]

    def rows(self, free: Float[Array, " p"]) -> Float[Array, " n"]:
        values = self.constrain(free)
        scene = self.put(values)
        detail = (self.detail,) if self.detail > 1 else ()
        picture = scene.picture(self.target.size, self.method, *detail)
        parts = [self.target.residuals(picture).astype(values.dtype)]
        for target in self.beside:
            predicted = jax.vmap(lambda wind, target=target: target.predict(scene, wind))(target.winds)
            parts.append(((predicted - target.observed()) / target.scatter.value).astype(values.dtype))
        for prior, part in zip(self.priors, split(self.slots, values), strict=True):
            if prior is not None:
                parts.append(prior.residual(part).ravel())
        return jnp.concatenate(parts)

    def against(self, target: Any) -> "PictureProblem":
        """The same with another target."""
        return replace(self, target=target)

    def by(self, method: Raster | Rays, detail: int = 1) -> "PictureProblem":
        """The same with pictures drawn in another way."""
        return replace(self, method=method, detail=detail)

    @property
    def size_beside(self) -> int:
        """How many residuals there are besides those of the picture."""
        priors = zip(self.slots, self.priors, strict=True)
        return sum(each.size for each in self.beside) + sum(
            slot.size for slot, prior in priors if prior is not None
        )

    def put(self, values: Any, *, as_given: bool = False) -> Any:
        """The scene with these numbers, in doubles or in the types that they came in."""
        leaves, treedef = jax.tree.flatten(self.model)
        for slot, part in zip(self.slots, split(self.slots, values), strict=True):
            leaves[slot.index] = jnp.asarray(part, leaves[slot.index].dtype) if as_given else part
        return treedef.unflatten(leaves)

    def named(self, values: np.ndarray) -> dict[str, Any]:
        parts = split(self.slots, values)
        return {
            slot.name: float(part) if part.ndim == 0 else part
            for slot, part in zip(self.slots, parts, strict=True)
        }

    def _each(self, values: Float[Array, " p"], change: Callable[[AbstractBounds, Any], Any]) -> Array:
        parts = zip(self.slots, split(self.slots, values), strict=True)
        return jnp.concatenate([change(slot.bounds, part).ravel() for slot, part in parts])


@eqx.filter_jit
def look(problem: PictureProblem, free: Float[Array, " p"]) -> tuple[Float[Array, " n"], Float[Array, "n p"]]:
    """Residuals and their derivatives, one direction after the other in a loop: one program to compile for all."""

    def along(direction):
        return jax.jvp(problem.rows, (free,), (direction,))

    rows, changes = jax.lax.map(along, jnp.eye(free.size))
    return rows[0], changes.T


@eqx.filter_jit
def look_once(
    problem: PictureProblem, free: Float[Array, " p"]
) -> tuple[Float[Array, " n"], Float[Array, "n p"]]:
    """The same from one picture, of which all is kept that its derivative needs: less time for more memory."""
    rows, change = jax.linearize(problem.rows, free)
    return rows, jax.lax.map(change, jnp.eye(free.size)).T


@eqx.filter_jit
def rows_of(problem: PictureProblem, free: Float[Array, " p"]) -> Float[Array, " n"]:
    return problem.rows(free)
