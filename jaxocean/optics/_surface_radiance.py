"""All the light that leaves a piece of the sea towards a viewer."""

import math
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._elementary import inverse_root, once
from .._numerics import is_concrete
from ._foam import AbstractFoam
from ._foam_view import AbstractFoamView, EvenFoam
from ._mixing import AbstractMixing, ShareMixing
from ._water import AbstractWater
from .reflection import (
    AbstractFresnel,
    AbstractMasking,
    AbstractSkyReflection,
    ExactFresnel,
    HeightCorrelatedMasking,
    LobeReflection,
    sun_glitter,
)
from .reflection._facing import facing
from .sky import AbstractSky


class SurfaceRadiance(NamedTuple):
    """Radiance [that of the sky] towards the viewer, linear sRGB (*b, 3): `total` is the sum of the other four."""

    total: Float[Array, "*b 3"]
    sun: Float[Array, "*b 3"]
    sky: Float[Array, "*b 3"]
    water: Float[Array, "*b 3"]
    foam: Float[Array, "*b 3"]


class Shading(eqx.Module):
    """The choices behind `surface_radiance`; each may be differentiated in its own parameters.

    **Arguments:**

    - `fresnel`: `ExactFresnel` (default, n = 1.34) or `SchlickFresnel`.
    - `sky_reflection`: `LobeReflection` (default, one look-up), `FacetReflection` (a quadrature) or
      `BrunetonReflection`.
    - `masking`: `HeightCorrelatedMasking` (default), `AzimuthCorrelatedMasking` or `IndependentMasking`.
    - `foam_view`: `EvenFoam` (default), `CrestFoam` or `FlatFoam`.
    - `mixing`: `ShareMixing` (default) or `AdditiveMixing`.
    """

    fresnel: AbstractFresnel = eqx.field(default_factory=ExactFresnel)
    sky_reflection: AbstractSkyReflection = LobeReflection()
    masking: AbstractMasking = HeightCorrelatedMasking()
    foam_view: AbstractFoamView = EvenFoam()
    mixing: AbstractMixing = ShareMixing()


def surface_radiance(
    to_viewer: Float[Array, "*b 3"],
    slope: Float[Array, "*b 2"],
    slope_covariance: Float[Array, "*b 2 2"],
    coverage: Float[Array, "*b"],
    sky: AbstractSky,
    water: AbstractWater,
    foam: AbstractFoam,
    *,
    shading: Shading | None = None,
    foam_age: Float[Array, "*b"] | None = None,
) -> SurfaceRadiance:
    """Radiance of footprints of the sea: sun glitter, mirrored sky, light from the water, and foam.

    $$ L = (1 - W) \\left( L_{\\mathrm{sun}} + \\overline{F L_{\\mathrm{sky}}} +
    (1 - \\overline{F}) L_{\\mathrm{water}} \\right) + W \\frac{R}{π} \\left( (N·S)_+ E_{\\mathrm{sun}} +
    E_{\\mathrm{sky}} \\right) $$

    with W as the viewer sees it and the normal N of the mean facet. It is differentiable in everything, dark and
    finite when the sun is down.

    **Arguments:**

    - `to_viewer`: unit vectors from the surface, (*b, 3).
    - `slope`, `slope_covariance`: mean (*b, 2) and covariance (*b, 2, 2) of the slopes ∂z/∂(x, y) in the footprint:
      what it filters out and what no grid resolves.
    - `coverage`: share W of the footprint's horizontal area that is foam, 0 … 1, (*b).
    - `sky`, `water`, `foam`: where the light comes from and what becomes of it.
    - `shading`: the models; all defaults if None.
    - `foam_age`: time since the foam broke [s], (*b), for foam that ages.

    **Returns:** `SurfaceRadiance`, each (*b, 3), in the unit of the sky's radiance.

    **Raises:** `ValueError` for a coverage outside 0 … 1 that is known when called.

    **Source:** Dupuy & Bruneton 2012, eq. 2; Bruneton, Neyret & Holzschuch 2010, §4; the weights 1 − W are ours.
    """
    _check_coverage(coverage)
    shading = Shading() if shading is None else shading
    dtype = to_viewer.dtype
    to_sun, beam, dome = (
        each.astype(dtype) for each in (sky.sun_direction, sky.sun_irradiance, sky.irradiance())
    )

    glitter = once(sun_glitter(to_viewer, to_sun, slope, slope_covariance, shading.fresnel, shading.masking))
    mirrored = shading.sky_reflection(to_viewer, slope, slope_covariance, sky, shading.fresnel)
    upwelling = water.radiance(sky, shading.fresnel).astype(dtype)

    x, y = slope[..., 0], slope[..., 1]
    upright = inverse_root(1.0 + x * x + y * y)
    on_foam = once(jnp.maximum(to_sun[..., 2] - x * to_sun[..., 0] - y * to_sun[..., 1], 0.0) * upright)
    scattered = foam.reflectance(foam_age).astype(dtype) / math.pi

    clear, white = shading.mixing(
        foam_in_view(to_viewer, slope, slope_covariance, coverage, shading.foam_view)
    )
    clear, white = once(clear), once(white)
    # Channel by channel: XLA on the CPU is slow with short last axes.
    parts = [
        (
            clear * glitter * beam[..., k],
            clear * mirrored.radiance[..., k],
            clear * (1.0 - mirrored.reflectance) * upwelling[..., k],
            white * scattered[..., k] * (on_foam * beam[..., k] + dome[..., k]),
        )
        for k in range(3)
    ]
    total = jnp.stack([sun + mirror + deep + foamy for sun, mirror, deep, foamy in parts], axis=-1)
    return SurfaceRadiance(total, *(jnp.stack(each, axis=-1) for each in zip(*parts, strict=True)))


def foam_in_view(
    to_viewer: Float[Array, "*b 3"],
    slope: Float[Array, "*b 2"],
    slope_covariance: Float[Array, "*b 2 2"],
    coverage: Float[Array, "*b"],
    view: AbstractFoamView,
) -> Float[Array, "*b"]:
    """The share of what is seen of footprints that is foam, past the waves that are inside of them.

    **Arguments:** those of `surface_radiance`; `view`: how those waves hide foam.

    **Returns:** a share in 0 … 1, (*b).
    """
    return view(coverage, facing(to_viewer, slope, slope_covariance).hidden)


def _check_coverage(coverage: Float[Array, "*b"]) -> None:
    if not is_concrete(coverage) or coverage.size == 0:
        return
    low, high = float(np.min(coverage)), float(np.max(coverage))
    if not (low >= 0.0 and high <= 1.0):
        raise ValueError(
            f"Argument `coverage` must be from 0 to 1 everywhere, but goes from {low:g} to {high:g}."
        )
