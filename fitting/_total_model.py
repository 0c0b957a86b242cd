"""Total whitecap coverage straight from a spectrum: breaking, and foam that decays after it."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import PyTree

from jaxocean import Wind
from jaxocean._numerics import as_leaf, check_scalar
from jaxocean._types import Scalar
from jaxocean.spectra import Dispersion
from jaxocean.whitecaps import foam

from ._model import AbstractPreparedModel
from ._spectral_model import SpectralModel


class TotalCoverageModel(AbstractPreparedModel):
    """Wind → spectrum → breaking at a point → foam that decays → total coverage, the link from stage A to laws.

    | leaf | unit | role |
    |---|---|---|
    | leaves of `active` | theirs | what breaks now; calibrate its ε to active coverage first |
    | `decay_time` τ | s | of the foam, greater than 0 |

    **Arguments:** the leaves above, and

    - `closure`: `RenewalFoam()` by default; its measure is that of the result.
    - `horizon` [s]: the longest time after which breaking again matters, several τ; static.
    - `dispersion`: how fast waves travel; deep water by default.

    `active.closure` is not used: what breaks now comes from the exact closure.

    **Raises:** `ValueError` for a decay time or a horizon that is not positive.
    """

    active: SpectralModel
    decay_time: Scalar = eqx.field(converter=as_leaf, default=3.53)
    closure: foam.AbstractFoamClosure = eqx.field(default=foam.RenewalFoam(), kw_only=True)
    horizon: float = eqx.field(static=True, default=30.0, kw_only=True)
    dispersion: Dispersion | None = eqx.field(default=None, kw_only=True)
    point: foam.PointBreaking | None = eqx.field(default=None, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("decay_time", self.decay_time, "s", positive=True)
        if not self.horizon > 0:
            raise ValueError(f"Argument `horizon` must be greater than 0 s, but is {self.horizon:g}.")

    def coverage(self, wind: Wind) -> Scalar:
        """Total W [-], in the measure of the closure."""
        return self.closure(self._point(wind), self.decay_time)

    def log_coverage(self, wind: Wind) -> Scalar:
        """log of total W."""
        return jnp.log(self.coverage(wind))

    def prepare(self, wind: Wind) -> foam.PointBreaking:
        """Everything but the decay."""
        model = self.active
        motion = foam.strain_motion(
            model.spectrum(wind),
            model.choppiness,
            band=model.band,
            cascade=model.cascade,
            breaking_wavenumber=model.breaking_wavenumber,
            dispersion=self.dispersion,
        )
        return foam.point_breaking(motion, model.threshold, horizon=self.horizon)

    def prepared(self, state: foam.PointBreaking) -> "TotalCoverageModel":
        return eqx.tree_at(lambda m: m.point, self, state, is_leaf=lambda x: x is None)

    def preparation_leaves(self) -> PyTree:
        return self.active, self.dispersion

    def _point(self, wind: Wind) -> foam.PointBreaking:
        return self.prepare(wind) if self.point is None else self.point
