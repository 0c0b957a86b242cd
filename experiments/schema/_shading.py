"""How the surface reflects and how whitecaps look, as configs say it."""

from typing import Literal

from ._base import Section, key


class ShadingConfig(Section):
    """`shading`: the models of what the surface does with light."""

    fresnel: Literal["exact", "schlick"] = key(
        "exact", meaning="reflectance of a facet: Fresnel's equations, or Schlick's polynomial"
    )
    refractive_index: float = key(
        1.34, unit="-", meaning="n of the water, for exact; 1.34 sea water in the visible", gt=1, le=10
    )
    extinction: float | None = key(
        None, unit="-", meaning="imaginary part of n, for exact; null: none", ge=0, le=100
    )
    normal_reflectance: float = key(
        0.02, unit="-", meaning="F₀ of straight incidence, for schlick", ge=0, le=1
    )
    sky_reflection: Literal["lobe", "facet", "bruneton"] = key(
        "lobe",
        meaning="mirrored sky: one widened look-up, one for each of many facets (slow), or Bruneton's fit (with a "
        "reflectance of its own)",
    )
    masking: Literal["height_correlated", "azimuth_correlated", "independent"] = key(
        "height_correlated", meaning="how masking from the viewer and shadow from the sun go together"
    )
    mixing: Literal["share", "additive"] = key(
        "share", meaning="W foam and 1 - W water, or W foam added to whole water (Dupuy & Bruneton, eq. 2)"
    )


class FoamLookConfig(Section):
    """`foam`: how whitecaps look."""

    reflectance: float = key(
        0.22,
        unit="-",
        meaning="0.22 effective for all ages (Koepke), 0.55 fresh, 0.4 in Dupuy & Bruneton",
        ge=0,
        le=1,
    )
    colour: Literal["white", "frouin"] = key(
        "white", meaning="the same at all wavelengths, or less towards the red (Frouin)"
    )
    age: float | None = key(
        None,
        unit="s",
        meaning="all foam is so old, and `reflectance` is that of fresh foam, which fades to 1/e in 2.35 s (Koepke's "
        "mean); null: no ageing",
        ge=0,
        le=1000,
    )
    view: Literal["even", "flat", "crest"] = key(
        "even",
        meaning="how waves inside a pixel hide foam: as they hide water, more (it lies flat; the paper's outlook), or "
        "less (it lies on crests)",
    )
    crest_preference: float = key(
        11.0,
        unit="-",
        meaning="κ of crest: foam lies higher than κ/(κ + 1) of all water on average",
        gt=0,
        le=1e4,
    )
