"""Whitecap coverage counted on random seas made by FFT, differentiable through a smooth indicator."""

from collections.abc import Callable
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float, PRNGKeyArray, PyTree, UInt32

from jaxocean import Wind
from jaxocean._numerics import as_leaf, check_scalar, optional_leaf
from jaxocean._types import Scalar
from jaxocean.surface import Cascade, draw_noise, realise
from jaxocean.whitecaps import AbstractBreaking, SmoothBreaking, realised_coverage

from ._model import AbstractPreparedModel
from ._spectral_model import ElfouhailySea


class RealisedModel(AbstractPreparedModel):
    """Wind → spectrum → FFT seas → Jacobian → counted coverage.

    The random numbers are drawn once: every wind, every threshold and every step of a solver sees the same seas,
    so that coverage is a smooth function and noise does not drown its slope. Samples and folds are counted by
    `jaxocean.whitecaps.realised_coverage`.

    | leaf | unit | role |
    |---|---|---|
    | `threshold` ε | - | breaking where j < ε |
    | `choppiness` λ | - | one number, or one per pattern of the cascade |
    | `breaking_wavenumber` k_b | rad/m | low-pass of the strain that breaks; None for none |
    | leaves of `spectrum` | theirs | how a wind makes a spectrum |
    | `noise` | - | the random numbers (seed, pattern, y, x) |
    | leaves of `breaking` | - | width of the indicator |

    **Arguments:** the leaves above, and

    - `cascade`: sizes, bands, resolution.
    - `key` (with `seeds`, how many seas) or `noise`: exactly one.
    - `breaking`: the indicator, `SmoothBreaking(0.02)` by default; a hard one cannot be fitted.
    - `measure`: "projected" (default) or "rest" area.
    - `shifts`: how many arrangements of the patterns are counted for each sea.

    **Raises:** `ValueError` unless exactly one of `key` and `noise` is given, or for leaves that make no sense.
    """

    threshold: Scalar
    choppiness: Float[Array, "..."]
    spectrum: Callable
    breaking_wavenumber: Scalar | None
    breaking: AbstractBreaking
    noise: Complex[Array, "seed pattern y x"]
    strain: Float[Array, "seed pattern y x 3"] | None
    cascade: Cascade = eqx.field(static=True)
    measure: Literal["projected", "rest"] = eqx.field(static=True)
    shifts: int = eqx.field(static=True)

    def __init__(
        self,
        threshold: float | Scalar = 0.5,
        choppiness: float | Float[Array, "..."] = 1.0,
        *,
        cascade: Cascade,
        spectrum: Callable | None = None,
        key: PRNGKeyArray | UInt32[Array, "2"] | None = None,
        noise: Complex[Array, "seed pattern y x"] | None = None,
        seeds: int = 8,
        breaking_wavenumber: float | Scalar | None = None,
        breaking: AbstractBreaking | None = None,
        measure: Literal["projected", "rest"] = "projected",
        shifts: int = 1,
    ) -> None:
        if seeds < 1:
            raise ValueError(f"Argument `seeds` must be at least 1, but is {seeds}.")
        if key is not None and noise is None:
            noise = jax.vmap(lambda k: draw_noise(cascade, k))(jax.random.split(key, seeds))
        elif key is not None or noise is None:
            given = "neither is" if key is None else "both are"
            raise ValueError(f"Give exactly one of `key` and `noise`, but {given} given.")
        self.threshold = as_leaf(threshold)
        self.choppiness = as_leaf(jnp.asarray(choppiness))
        self.spectrum = ElfouhailySea() if spectrum is None else spectrum
        self.breaking_wavenumber = optional_leaf(breaking_wavenumber)
        self.breaking = SmoothBreaking() if breaking is None else breaking
        self.noise = noise
        self.strain = None
        self.cascade = cascade
        self.measure = measure
        self.shifts = shifts
        check_scalar("threshold", self.threshold, "")
        check_scalar("breaking_wavenumber", self.breaking_wavenumber, "rad/m", positive=True)

    def coverage(self, wind: Wind) -> Scalar:
        """W [-], the mean over all seas."""
        return jnp.mean(self.coverages(wind))

    def log_coverage(self, wind: Wind) -> Scalar:
        """log W; −∞ where no sample breaks."""
        w = self.coverage(wind)
        breaks = w > 0
        return jnp.where(breaks, jnp.log(jnp.where(breaks, w, 1.0)), -jnp.inf)

    def coverages(self, wind: Wind) -> Float[Array, " seed"]:
        """W [-] of each sea: their spread is the error of the mean."""
        strain = self.prepare(wind) if self.strain is None else self.strain
        weight = jnp.broadcast_to(self.choppiness, (self.cascade.count,))[:, None, None, None]
        return jax.vmap(
            lambda one: realised_coverage(
                weight * one, self.threshold, breaking=self.breaking, measure=self.measure, shifts=self.shifts
            )
        )(strain)

    def prepare(self, wind: Wind) -> Float[Array, "seed pattern y x 3"]:
        """Strain of every sea at choppiness 1."""
        spectrum = self.spectrum(wind)

        def strain(noise: Complex[Array, "pattern y x"]) -> Float[Array, "pattern y x 3"]:
            sea = realise(spectrum, self.cascade, noise=noise)
            return sea.strains(0.0, 1.0, self.breaking_wavenumber)

        return jax.lax.map(strain, self.noise)

    def prepared(self, state: Float[Array, "seed pattern y x 3"]) -> "RealisedModel":
        return eqx.tree_at(lambda m: m.strain, self, state, is_leaf=lambda x: x is None)

    def preparation_leaves(self) -> PyTree:
        return self.spectrum, self.breaking_wavenumber, self.noise
