"""From active to total coverage of the whole plane: foam that decays after breaking, without a tile."""

import abc
import math

import equinox as eqx
import jax.numpy as jnp
from jax.scipy.special import log_ndtr
from jaxtyping import Array, Float

from ..._types import FloatLike
from .._closures import Measure, check_measure
from ._breaking import PointBreaking


class AbstractFoamClosure(eqx.Module):
    """An estimate of total coverage, breaking and decaying foam together, of an unbounded sea.

    With the law of `FoamModel` a point that last broke a time s ago has the coverage e^{−s/τ}, so that

    $$ W_{total} = E[e^{−age/τ}] = W + ντ(1 − E[e^{−D/τ}]) $$

    exactly: W and ν are the active coverage and the rate at which a point starts to break, and D is the time from
    the end of one breaker to the start of the next. The closures differ in what they know of D.
    In projected area decaying foam is as large as what does not break on the average:
    W_projected = W_active + (W_total − W)(1 − W_active)/(1 − W), with W_active in projected and the others in rest
    area.
    """

    measure: eqx.AbstractVar[Measure]

    @abc.abstractmethod
    def gap_transform(self, breaking: PointBreaking, decay_time: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """E[e^{−D/τ}] [-], between 0 and 1."""

    def __call__(self, breaking: PointBreaking, decay_time: FloatLike) -> Float[Array, "*b"]:
        """Total coverage W [-] of a sea at a decay time τ [s] of its foam."""
        tau = jnp.asarray(decay_time).astype(breaking.rest.dtype)
        fresh = breaking.rate * tau * (1 - self.gap_transform(breaking, tau))
        if self.measure == "rest":
            return breaking.rest + fresh
        return breaking.projected + fresh * (1 - breaking.projected) / (1 - breaking.rest)


class PoissonFoam(AbstractFoamClosure):
    """Total coverage as if a point that does not break started to break at any moment alike.

    $$ E[e^{−D/τ}] = \\frac{rτ}{1 + rτ}, \\quad W_{total} = \\frac{W + rτ}{1 + rτ}, \\quad r = \\frac{ν}{1 − W} $$

    Closed in W and ν alone. Where breaking is rare it is W + ντ. Real seas break more regularly than that (after a
    crest comes a trough), which makes it a little too low at high coverage, and in groups, which makes it a little
    too high at low coverage.

    **Arguments:** `measure`: "projected" (default) or "rest".
    """

    measure: Measure = eqx.field(static=True, default="projected")

    def __check_init__(self) -> None:
        check_measure(self.measure)

    def gap_transform(self, breaking: PointBreaking, decay_time: Float[Array, "*b"]) -> Float[Array, "*b"]:
        starts = breaking.rate * decay_time
        return starts / (1 - breaking.rest + starts)


class RenewalFoam(AbstractFoamClosure):
    """Total coverage as if the times for which a point breaks and does not were independent, and no more than that.

    The recurrence κ of breaking then fixes the Laplace transform ĝ of the gaps from f̂, that of the durations T:

    $$ ĝ = \\frac{1 − f̂ − q}{1 − f̂ − q f̂}, \\quad q = s \\bar T (1 − s \\hat κ(s)), \\quad s = 1/τ $$

    with T Rayleigh-distributed, as excursions of a smooth Gaussian process beyond a high level are, and
    sκ̂ = W + s∫(κ − W)e^{−st} dt. Unlike `PoissonFoam` it knows that a trough follows a crest, and that waves come in
    groups. It is meant for decay times longer than a point breaks.

    **Arguments:** `measure`: "projected" (default) or "rest".

    **Raises:** `ValueError` if called with a `PointBreaking` that was made without a horizon.

    **Source:** McFadden 1958, IRE Trans. Inf. Theory 4, for the method of independent intervals; here for two kinds
    of interval.
    """

    measure: Measure = eqx.field(static=True, default="projected")

    def __check_init__(self) -> None:
        check_measure(self.measure)

    def gap_transform(self, breaking: PointBreaking, decay_time: Float[Array, "*b"]) -> Float[Array, "*b"]:
        if breaking.recurrence is None or breaking.lags is None or breaking.weights is None:
            raise ValueError(
                "Argument `breaking` must know how soon a point breaks again: make it with "
                "`point_breaking(motion, threshold, horizon=…)`."
            )
        s = (1 / decay_time)[..., None]
        excess = breaking.weights * (breaking.recurrence - breaking.rest) * jnp.exp(-s * breaking.lags)
        s, recurrence = s[..., 0], breaking.rest + s[..., 0] * jnp.sum(excess, axis=-1)
        stretch = s * breaking.duration
        lasts = _rayleigh_transform(stretch)
        q = stretch * (1 - recurrence)
        return jnp.clip((1 - lasts - q) / (1 - lasts - q * lasts), 0.0, 1.0)


def _rayleigh_transform(stretch: Float[Array, "*b"]) -> Float[Array, "*b"]:
    """E[e^{−sT}] of a Rayleigh-distributed T from s times its mean."""
    x = stretch * math.sqrt(2 / math.pi)
    # ½ e^{x²/2} erfc(x/√2) = e^{x²/2} Φ(−x), which overflows and underflows only together.
    return 1 - x * math.sqrt(2 * math.pi) * jnp.exp(0.5 * x**2 + log_ndtr(-x))
