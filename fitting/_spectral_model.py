"""Whitecap coverage straight from a spectrum: no FFT, no sampling."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, PyTree

from jaxocean import Wind
from jaxocean._numerics import as_leaf, check_scalar, optional_leaf
from jaxocean._types import Scalar
from jaxocean.spectra import Elfouhaily, slope_variance
from jaxocean.surface import Cascade
from jaxocean.whitecaps import AbstractClosure, ExactClosure, StrainStatistics, strain_statistics

from ._model import AbstractPreparedModel
from ._slopes import Slopes

SLOPE_BAND = (1e-3, 2000.0)
"""Wavenumbers [rad/m] whose slopes the light sees, down to the capillary waves."""


class ElfouhailySea(eqx.Module):
    """Makes the Elfouhaily spectrum of a wind.

    **Arguments:** `inverse_wave_age` Ω [-], a leaf that can be fitted, or None for that of the wind's fetch.
    """

    inverse_wave_age: Scalar | None = eqx.field(converter=optional_leaf, default=None)

    def __check_init__(self) -> None:
        check_scalar("inverse_wave_age", self.inverse_wave_age, "", positive=True)

    def __call__(self, wind: Wind) -> Elfouhaily:
        """The spectrum."""
        return Elfouhaily(wind, self.inverse_wave_age)


class SeaMoments(eqx.Module):
    """What a spectrum says about breaking and slopes, for choppiness 1."""

    strain: Float[Array, "pattern 3 3"]
    slopes: Slopes


class SpectralModel(AbstractPreparedModel):
    """Wind → spectrum → strain statistics → closure → whitecap coverage.

    | leaf | unit | role |
    |---|---|---|
    | `threshold` ε | - | breaking where j < ε |
    | `choppiness` λ | - | one number, or one per pattern of the cascade |
    | `breaking_wavenumber` k_b | rad/m | low-pass of the strain that breaks; None for none |
    | leaves of `spectrum` | theirs | how a wind makes a spectrum |

    **Arguments:** the leaves above, and

    - `spectrum`: a function of a `Wind` that returns a spectrum; a module such as `ElfouhailySea(…)` where
      its own numbers shall be fitted.
    - `band` (lower, upper) [rad/m] or `cascade`: which waves count; give exactly one.
    - `closure`: `ExactClosure(measure="projected")` by default.

    **Raises:** `ValueError` if both or neither of band and cascade are given, or a leaf makes no sense.
    """

    threshold: Scalar = eqx.field(converter=as_leaf, default=0.5)
    choppiness: Float[Array, "..."] = eqx.field(converter=lambda x: as_leaf(jnp.asarray(x)), default=1.0)
    spectrum: Callable = eqx.field(default=ElfouhailySea(), kw_only=True)
    band: tuple[float, float] | None = eqx.field(static=True, default=None, kw_only=True)
    cascade: Cascade | None = eqx.field(static=True, default=None, kw_only=True)
    breaking_wavenumber: Scalar | None = eqx.field(converter=optional_leaf, default=None, kw_only=True)
    closure: AbstractClosure = eqx.field(default=ExactClosure(), kw_only=True)
    moments: SeaMoments | None = eqx.field(default=None, kw_only=True)

    def __check_init__(self) -> None:
        if (self.band is None) == (self.cascade is None):
            given = "neither is" if self.band is None else "both are"
            raise ValueError(f"Give exactly one of `band` and `cascade`, but {given} given.")
        check_scalar("threshold", self.threshold, "")
        check_scalar("breaking_wavenumber", self.breaking_wavenumber, "rad/m", positive=True)
        patterns = 1 if self.cascade is None else self.cascade.count
        if self.choppiness.ndim > 0 and self.choppiness.shape != (patterns,):
            raise ValueError(
                f"Argument `choppiness` must be one number or one for each of the {patterns} patterns, "
                f"but has shape {self.choppiness.shape}."
            )

    def coverage(self, wind: Wind) -> Scalar:
        """W [-], in the measure of the closure."""
        return jnp.exp(self.log_coverage(wind))

    def log_coverage(self, wind: Wind) -> Scalar:
        """log W."""
        return self.closure.log(self.statistics(wind), self.threshold)

    def statistics(self, wind: Wind) -> StrainStatistics:
        """Mean and covariance of the strain, choppiness included."""
        unit = self._moments(wind).strain
        patterns = self.choppiness[..., None, None] ** 2 * unit
        nothing = jnp.zeros_like(patterns[..., 0])
        return StrainStatistics(nothing[0], jnp.sum(patterns, axis=0), StrainStatistics(nothing, patterns))

    def slope_variance(self, wind: Wind) -> Slopes:
        """Slope variances along and across the wind [-], of all waves up to 2000 rad/m."""
        return self._moments(wind).slopes

    def mean_square_slope(self, wind: Wind) -> Scalar:
        """Total slope variance [-] of all waves up to 2000 rad/m."""
        slopes = self.slope_variance(wind)
        return slopes.upwind + slopes.crosswind

    def prepare(self, wind: Wind) -> SeaMoments:
        """Moments of the spectrum, which neither threshold nor choppiness change."""
        spectrum = self.spectrum(wind)
        stats = strain_statistics(
            spectrum, 1.0, band=self.band, cascade=self.cascade, breaking_wavenumber=self.breaking_wavenumber
        )
        assert stats.patterns is not None
        xx, yy, xy = slope_variance(spectrum, band=SLOPE_BAND)
        along, across = jnp.cos(wind.direction), jnp.sin(wind.direction)
        cross = 2 * along * across * xy
        upwind = along**2 * xx + across**2 * yy + cross
        crosswind = across**2 * xx + along**2 * yy - cross
        return SeaMoments(stats.patterns.covariance, Slopes(upwind, crosswind))

    def prepared(self, state: SeaMoments) -> "SpectralModel":
        return eqx.tree_at(lambda m: m.moments, self, state, is_leaf=lambda x: x is None)

    def preparation_leaves(self) -> PyTree:
        return self.spectrum, self.breaking_wavenumber

    def _moments(self, wind: Wind) -> SeaMoments:
        return self.prepare(wind) if self.moments is None else self.moments
