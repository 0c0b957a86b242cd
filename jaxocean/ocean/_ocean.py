"""Where the sea, its whitecaps and the light meet."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._constants import BREAKING_WAVENUMBER
from .._numerics import as_leaf, check_kind, check_scalar, optional_leaf
from .._types import Scalar, ScalarLike
from ..filtering import symmetric_matrix
from ..optics import AbstractFoam, AbstractWater, Foam, Shading, Water
from ..optics.sky import AbstractSky, HosekWilkie
from ..spectra import AbstractSpectrum, slope_variance
from ..surface import Fields, Sea, pattern_choppiness
from ..whitecaps import (
    AbstractBreaking,
    AbstractClosure,
    ExactClosure,
    HardBreaking,
    StrainStatistics,
    strain_statistics,
)
from ..whitecaps import jacobian as strain_jacobian

SHORTEST = 2000.0
"""Wavenumber [rad/m] of the shortest waves that reflect light (Cox & Munk 1954 saw no shorter ones)."""


class Ocean(eqx.Module):
    """A realised sea, how choppy it is, where it breaks, and the light on it.

    | leaf | unit | default | role |
    |---|---|---|---|
    | `sea` | | | spectrum and noise, see `jaxocean.surface.realise` |
    | `choppiness` λ | - | 1 | horizontal displacement, one number or one per pattern |
    | `threshold` ε | - | 0.5 | breaking where j < ε |
    | `breaking_wavenumber` k_b | rad/m | 73.1 | waves shorter than this do not count for breaking; None: all do |
    | `unresolved` | | that of `sea` | spectrum of the waves too short for the patterns, which only glitter |
    | `closure` | | exact, projected | from strain statistics to coverage |
    | `breaking` | | hard | the indicator at a point |
    | `sky` | | clear, sun 0.7 rad up | where the light comes from |
    | `water` | | clear ocean | the colour of the water body |
    | `foam` | | white, R = 0.22 | what whitecaps reflect |
    | `shading` | | see `optics.Shading` | how the surface reflects |

    **Raises:** `ValueError` for more λ than patterns, or a k_b that is not positive.
    """

    sea: Sea
    choppiness: Float[Array, "..."] = eqx.field(
        converter=lambda x: as_leaf(jnp.asarray(x)), default=1.0, kw_only=True
    )
    threshold: Scalar = eqx.field(converter=as_leaf, default=0.5, kw_only=True)
    breaking_wavenumber: Scalar | None = eqx.field(
        converter=optional_leaf, default=BREAKING_WAVENUMBER, kw_only=True
    )
    unresolved: AbstractSpectrum | None = eqx.field(default=None, kw_only=True)
    closure: AbstractClosure = eqx.field(default=ExactClosure(), kw_only=True)
    breaking: AbstractBreaking = eqx.field(default=HardBreaking(), kw_only=True)
    sky: AbstractSky = eqx.field(default_factory=HosekWilkie, kw_only=True)
    water: AbstractWater = eqx.field(default_factory=Water, kw_only=True)
    foam: AbstractFoam = eqx.field(default_factory=Foam, kw_only=True)
    shading: Shading = eqx.field(default_factory=Shading, kw_only=True)

    def __check_init__(self) -> None:
        check_kind("sea", self.sea, Sea, "a sea made by `surface.realise`")
        if self.unresolved is not None:
            check_kind(
                "unresolved", self.unresolved, AbstractSpectrum, "a spectrum such as `Elfouhaily(wind)`"
            )
        check_kind("closure", self.closure, AbstractClosure, "a closure such as `ExactClosure()`")
        check_kind("breaking", self.breaking, AbstractBreaking, "an indicator such as `HardBreaking()`")
        check_kind("sky", self.sky, AbstractSky, "a sky such as `HosekWilkie()`")
        check_kind("water", self.water, AbstractWater, "a water body such as `Water()`")
        check_kind("foam", self.foam, AbstractFoam, "foam such as `Foam()`")
        check_kind("shading", self.shading, Shading, "a `Shading()`")
        check_scalar("threshold", self.threshold, "")
        check_scalar("breaking_wavenumber", self.breaking_wavenumber, "rad/m", positive=True)
        pattern_choppiness(self.choppiness, self.sea.cascade.count)

    def fields(self, time: ScalarLike) -> Fields:
        """Height, displacement, slope and low-passed strain of every pattern at time t [s]."""
        return self.sea.fields(time, self.choppiness, self.breaking_wavenumber)

    def jacobian(self, p: Float[Array, "*b 2"], time: ScalarLike) -> Float[Array, "*b"]:
        """j [-] that foam sees at rest points p [m] and time t [s]."""
        return strain_jacobian(self.sea.strain(p, time, self.choppiness, self.breaking_wavenumber))

    def whitecaps(self, p: Float[Array, "*b 2"], time: ScalarLike) -> Float[Array, "*b"]:
        """1 where the surface breaks at rest points p [m] and time t [s], else 0; in between for a smooth indicator."""
        return self.breaking(self.jacobian(p, time), self.threshold)

    def statistics(self) -> StrainStatistics:
        """Mean and covariance of the strain that foam sees on the whole plane, from the spectrum."""
        return strain_statistics(
            self.sea.spectrum,
            self.choppiness,
            cascade=self.sea.cascade,
            breaking_wavenumber=self.breaking_wavenumber,
        )

    def coverage(self) -> Scalar:
        """Whitecap coverage W [-] of the whole plane by the closure."""
        return self.closure(self.statistics(), self.threshold)

    def unresolved_slopes(self) -> Float[Array, "2 2"]:
        """Covariance of the slopes [-] of all waves that are too short for the patterns, from their spectrum.

        They make no picture, but glitter: light meets waves of up to 2000 rad/m, as Cox & Munk's slopes do.
        """
        limit = self.sea.cascade.wavenumber_limit
        if limit >= SHORTEST:
            return jnp.zeros((2, 2), self.sea.waves.rate.dtype)
        spectrum = self.sea.spectrum if self.unresolved is None else self.unresolved
        return symmetric_matrix(jnp.stack(slope_variance(spectrum, band=(limit, SHORTEST))))
