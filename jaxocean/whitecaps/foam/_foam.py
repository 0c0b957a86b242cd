"""Foam that outlives the breaking that made it: its state, and the law by which it ages."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..._numerics import as_leaf, check_scalar
from ..._types import Scalar, ScalarLike
from .._closures import FOLD, Measure, check_measure
from .._jacobian import AbstractBreaking, HardBreaking


class Foam(eqx.Module):
    """Foam on the rest plane, point by point.

    Rest coordinates name parcels of water: a parcel rests at p and floats at p + D(p, t). The orbital motion of the
    waves carries foam with the parcels, so that on rest coordinates it stays where it is, and no advection smears
    it. It is displaced with the surface when it is drawn. Drift past the parcels (Stokes, wind) is left out.

    **Arguments:**

    - `coverage`: A [-], the part of the surface around a point that is white, 0 to 1.
    - `age`: time [s] since the point last broke, or since the start where it has not.
    """

    coverage: Float[Array, "*s"]
    age: Float[Array, "*s"]

    @classmethod
    def bare(cls, *shape: int) -> "Foam":
        """No foam yet, of the default floating-point type."""
        return cls(jnp.zeros(shape), jnp.zeros(shape))


class FoamModel(eqx.Module):
    """How foam is born and decays.

    $$ A(t + Δt) = \\max(A(t) e^{−Δt/τ}, I), \\quad age(t + Δt) = (1 − I)(age(t) + Δt) $$

    with the breaking indicator I at t + Δt. A breaking point is white, whatever it was before; nothing is added
    up, so that the outcome does not depend on into how many steps one breaker falls. With the hard indicator
    A = exp(−age/τ) where the point has broken at all.

    | leaf | unit | role |
    |---|---|---|
    | `threshold` ε | - | breaking where j < ε |
    | `decay_time` τ | s | of the foam, greater than 0; it is *not* how long a breaker lasts |
    | leaves of `breaking` | theirs | `HardBreaking()` has no derivative in ε, λ and wind, `SmoothBreaking(w)` has |

    **Source:** A = A₀ exp(−t/τ) with τ = 3.53 s after Monahan (year unverified); Callaghan et al. 2012 give
    area-weighted 1.4 to 4.8 s, larger breakers slower.
    """

    threshold: Scalar = eqx.field(converter=as_leaf, default=0.5)
    decay_time: Scalar = eqx.field(converter=as_leaf, default=3.53)
    breaking: AbstractBreaking = eqx.field(default=HardBreaking(), kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("threshold", self.threshold, "")
        check_scalar("decay_time", self.decay_time, "s", positive=True)

    def step(self, foam: Foam, jacobian: Float[Array, "*s"], step: ScalarLike) -> Foam:
        """The foam after one step.

        **Arguments:** `foam` now; `jacobian` j [-] at the end of the step; `step` Δt [s].
        """
        dtype = jacobian.dtype
        dt = as_leaf(step).astype(dtype)
        breaks = self.breaking(jacobian, self.threshold.astype(dtype))
        kept = foam.coverage * jnp.exp(-dt / self.decay_time.astype(dtype))
        return Foam(jnp.maximum(kept, breaks), (1 - breaks) * (foam.age + dt))

    def active_coverage(self, jacobian: Float[Array, "*s"], measure: Measure = "projected") -> Scalar:
        """The part of the plane [-] that breaks now; folds count as in `ExactClosure`."""
        check_measure(measure)
        level = self.threshold.astype(jacobian.dtype)
        breaks = self.breaking(jacobian, level)
        if measure == "rest":
            return jnp.mean(breaks)
        foam = jnp.mean(jacobian * breaks)
        deep = jnp.mean(jacobian * self.breaking(jacobian, -FOLD * jnp.abs(level)))
        return jnp.where(level > 0, foam - 2 * deep, -foam)

    def total_coverage(
        self, foam: Foam, jacobian: Float[Array, "*s"], measure: Measure = "projected"
    ) -> Scalar:
        """The part of the plane [-] that is white, breaking or decaying.

        $$ W_{rest} = E[A], \\quad W_{projected} = W_{active} + E[\\max(j, 0) (A − I)] $$

        Foam that decays is seen as large as the surface around it is stretched (j); sheets that are folded under
        hide it.

        **Arguments:** `foam` and `jacobian` j [-] at one time; `measure`: "projected" or "rest" area.
        """
        breaks = self.breaking(jacobian, self.threshold.astype(jacobian.dtype))
        seen = jnp.ones_like(jacobian) if measure == "rest" else jnp.maximum(jacobian, 0.0)
        return self.active_coverage(jacobian, measure) + jnp.mean(seen * (foam.coverage - breaks))
