"""What a pixel's footprint on the rest plane sees of slopes and strain."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._numerics import safe_norm
from ..surface import Cascade, Fields
from ._atlas import Atlas
from ._residual import Residual

STEEPEST = 0.1
"""Jacobian [-] below which slopes of the displaced surface stop growing."""

LEAST_SHARPNESS = 1e-5
"""v^(−1/4) [m^(−1/2)] of the widest filter there is: any wider one finds the same."""

SHARPNESS = 2.0
"""How much narrower than the longer axis of a footprint its isotropic filter may be."""


class SurfaceMoments(eqx.Module):
    """Footprint means of slopes and strain by one isotropic look-up, and what it leaves out as covariances.

    Made for images: five textures, read once. `jaxocean.filtering.MomentPyramid` is slower and takes second moments
    from the very place that is looked at.

    **Arguments:** `atlas` of (a, b, c, ∂η/∂x, ∂η/∂y); `residual`: what it leaves out; `short`: (a, b, c) of the waves
    that the breaking wavenumber keeps from the strain, if there is one: the surface is deformed by all of them.
    """

    atlas: Atlas
    residual: Residual
    short: Atlas | None = None

    @classmethod
    def from_fields(cls, fields: Fields, cascade: Cascade) -> "SurfaceMoments":
        """The textures of a sea's fields at one time."""
        strain, slope, short = fields.strain, fields.slope, fields.short_strain
        atlas = _atlas(
            [strain[..., 0], strain[..., 1], strain[..., 2], slope[..., 0], slope[..., 1]], cascade
        )
        if short is not None:
            short = _atlas([short[..., 0], short[..., 1], short[..., 2]], cascade)
        return cls(atlas, Residual.of_atlas(atlas), short)

    def __call__(
        self,
        centre: Float[Array, "2"],
        x: Float[Array, "*b"],
        y: Float[Array, "*b"],
        variance: Float[Array, "*b"],
    ) -> "Seen":
        """Moments on the rest plane at centre + (x, y) [m] under filters with this variance [m²] along each axis."""
        means = self.atlas(centre, x, y, variance)
        spread = self.residual(variance)
        return Seen(
            means[3:], spread[6:], means[:3], spread[:6], self._deformation(means[:3], centre, x, y, variance)
        )

    def tangents(
        self,
        centre: Float[Array, "2"],
        x: Float[Array, "*b"],
        y: Float[Array, "*b"],
        variance: Float[Array, "*b"],
    ) -> tuple[Float[Array, "*b"], ...]:
        """Means of (a, b, c) of all waves, and of ∂η/∂(x, y), at the same points."""
        means = self.atlas(centre, x, y, variance)
        return *self._deformation(means[:3], centre, x, y, variance), *means[3:]

    def _deformation(self, strain, centre, x, y, variance) -> tuple[Float[Array, "*b"], ...]:
        if self.short is None:
            return strain
        return tuple(
            long + short for long, short in zip(strain, self.short(centre, x, y, variance), strict=True)
        )


def _atlas(channels: list[Float[Array, "pattern y x"]], cascade: Cascade) -> Atlas:
    return Atlas.from_channels(jnp.stack(channels), cascade.sizes, rounded=True)


class Seen(NamedTuple):
    """Footprint moments, one array for each number: XLA on the CPU is slow with short last axes.

    **Arguments:** `slope` ∂η/∂(x, y); `slopes`: their covariances xx, yy, xy; `strain` (a, b, c); `strains`: their
    covariances aa, bb, cc, ab, bc, ca; `deformation`: (a, b, c) of all waves, where `strain` is that of the waves which
    foam sees.
    """

    slope: tuple[Float[Array, "*b"], ...]
    slopes: tuple[Float[Array, "*b"], ...]
    strain: tuple[Float[Array, "*b"], ...]
    strains: tuple[Float[Array, "*b"], ...]
    deformation: tuple[Float[Array, "*b"], ...]


def displaced(seen: Seen) -> Seen:
    """The same with the mean and covariance of the slopes (∂w/∂x, ∂w/∂y) of the displaced surface.

    $$ s = M^{-1} ∇η, \\quad Σ_s = M^{-1} Σ M^{-1}, \\quad M = 1 + \\begin{pmatrix} a & c \\\\ c & b \\end{pmatrix} $$

    with the footprint's mean deformation. Where the surface stands upright, j = 0, slopes have no bound: 1/j is
    replaced by j/(j² + δ²) with δ = 0.1.
    """
    a, b, c = seen.deformation
    j = (1 + a) * (1 + b) - c * c
    inverse = j / (j * j + STEEPEST**2)
    xx, yy, xy = (1 + b) * inverse, (1 + a) * inverse, -c * inverse
    sx, sy = seen.slope
    kxx, kyy, kxy = seen.slopes
    first = xx * kxx + xy * kxy, xx * kxy + xy * kyy
    second = xy * kxx + yy * kxy, xy * kxy + yy * kyy
    covariance = (
        first[0] * xx + first[1] * xy,
        second[0] * xy + second[1] * yy,
        first[0] * xy + first[1] * yy,
    )
    return seen._replace(slope=(xx * sx + xy * sy, xy * sx + yy * sy), slopes=covariance)


def filter_variance(axes: tuple[Float[Array, "*b"], ...]) -> Float[Array, "*b"]:
    """The variance [m²] of the isotropic filter that stands for footprints F, given row by row.

    Of the principal variances V ≥ v of F Fᵀ/12 it is max(v, V/4): what is long and narrow is filtered a little too
    little along, and too much across, so that distant crests stay crests.
    """
    x_column, x_row, y_column, y_row = axes
    xx, yy = x_column**2 + x_row**2, y_column**2 + y_row**2
    xy = x_column * y_column + x_row * y_row
    middle, half = 0.5 * (xx + yy), safe_norm(0.5 * (xx - yy), xy)
    return jnp.maximum(jnp.maximum(middle - half, 0.0), (middle + half) / SHARPNESS**2) / 12
