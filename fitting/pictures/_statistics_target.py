"""Statistics of a picture against those of scenes."""

from collections.abc import Callable
from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float, Key

from jaxocean.render import Raster, Rays

from ._image_statistics import ImageStatistics
from ._photograph import Photograph
from ._problem import PictureProblem
from ._summaries import Summaries

Vary = Callable[[Photograph, Key[Array, ""]], Photograph]


class Seas(eqx.Module):
    """Several seas of one state, each with its own waves and with its own of what is neither known nor sought.

    **Arguments:** `photograph`: the state; `noises`, `keys`: random numbers of each sea; `vary`: see `fit_photograph`.
    """

    photograph: Photograph
    noises: Complex[Array, "sea pattern y x"]
    keys: Key[Array, " sea"]
    vary: Vary | None = eqx.field(static=True)

    def picture(
        self, size: tuple[int, int], method: Raster | Rays, detail: int = 1
    ) -> Float[Array, "sea rows columns 3"]:
        """Their pictures, one after the other."""
        if self.vary is None:
            return self.photograph.pictures(self.noises, size, method, detail)

        def of(drawn):
            noise, key = drawn
            assert self.vary is not None
            return self.vary(self.photograph, key).pictures(noise[None], size, method, detail)[0]

        return jax.lax.map(of, (self.noises, self.keys))

    def some(self, count: int) -> "Seas":
        """The first of them."""
        return replace(self, noises=self.noises[:count], keys=self.keys[:count])

    def of(self, noise: Array, key: Key[Array, ""]) -> "Seas":
        """One sea of the same state."""
        return replace(self, noises=noise[None], keys=key[None])


class StatisticsTarget(eqx.Module):
    """Whitened differences of a picture's summaries and the mean of those of some seas.

    **Arguments:** `statistics`, `summaries`: from pictures to numbers; `observed`: those of the photograph;
    `whitening`: W with WᵀW = Σ⁻¹, of no weight for summaries that tell nothing.
    """

    statistics: ImageStatistics
    summaries: Summaries
    observed: Float[Array, " q"]
    whitening: Float[Array, "kept q"]

    @property
    def size(self) -> tuple[int, int]:
        return self.statistics.size

    def residuals(self, pictures: Float[Array, "sea rows columns 3"]) -> Float[Array, " q"]:
        seen = jnp.mean(self.summaries(jax.vmap(self.statistics)(pictures)), axis=0)
        return self.whitening.astype(seen.dtype) @ (seen - self.observed.astype(seen.dtype))


@eqx.filter_jit
def drawn_statistics(
    problem: PictureProblem, points: Float[Array, "sea p"], noises: Array, keys: Key[Array, " sea"]
) -> Float[Array, "sea m"]:
    """Statistics of one picture at each point of the free numbers."""

    def of(drawn):
        point, noise, key = drawn
        seas = problem.put(problem.constrain(point)).of(noise, key)
        return problem.target.statistics(seas.picture(problem.target.size, problem.method, problem.detail)[0])

    return jax.lax.map(of, (points, noises, keys))
