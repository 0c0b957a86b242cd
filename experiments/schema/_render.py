"""What a picture is made from, and the config of `render`."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ._base import QUARTER_TURN, TURN, ExperimentConfig, Section, key, wrong
from ._camera import CameraConfig
from ._sea import (
    CascadeConfig,
    Choppiness,
    WindConfig,
    breaking_wavenumber_key,
    check_choppiness,
    choppiness_key,
    threshold_key,
)
from ._shading import FoamLookConfig, ShadingConfig
from ._spectra import ElfouhailyConfig, SpectrumConfig

Colour = tuple[float, float, float]


def _sun_elevation(default: float = 0.7):
    return key(
        default,
        unit="rad",
        meaning="of the sun above the horizon",
        within="-π/2 to π/2",
        ge=-QUARTER_TURN,
        le=QUARTER_TURN,
    )


def _sun_azimuth():
    return key(
        0.0,
        unit="rad",
        meaning="towards the sun, counter-clockwise from +x (east)",
        within="-2π to 2π",
        ge=-TURN,
        le=TURN,
    )


def _turbidity():
    return key(3.0, unit="-", meaning="haze; 2 to 3 over a clear ocean", ge=1, le=10)


def _albedo():
    return key(0.06, unit="-", meaning="of what lies below; 0.06 for the sea", ge=0, le=1)


class ClearSkyConfig(Section):
    """`sky` of kind `clear`: Hošek & Wilkie's, with its sun."""

    kind: Literal["clear"] = key("clear", meaning="what sky")
    turbidity: float = _turbidity()
    albedo: float = _albedo()
    sun_elevation: float = _sun_elevation()
    sun_azimuth: float = _sun_azimuth()
    cover: float = key(0.0, unit="-", meaning="share of clouds, in the mean over where they are", ge=0, le=1)


class SpectralSkyConfig(Section):
    """`sky` of kind `spectral`: the clear sky at eleven wavelengths, seen through the CIE observer; slower."""

    kind: Literal["spectral"] = key("spectral", meaning="what sky")
    turbidity: float = _turbidity()
    albedo: float = _albedo()
    sun_elevation: float = _sun_elevation()
    sun_azimuth: float = _sun_azimuth()


class EvenSkyConfig(Section):
    """`sky` of kind `even`: one colour everywhere, and a sun or none."""

    kind: Literal["even"] = key("even", meaning="what sky")
    radiance: Colour = key((0.3, 0.3, 0.3), unit="W m-2 sr-1 nm-1", meaning="linear red, green, blue")
    sun: Colour = key((0.0, 0.0, 0.0), unit="W m-2 nm-1", meaning="irradiance of its beam, linear")
    sun_elevation: float = _sun_elevation()
    sun_azimuth: float = _sun_azimuth()

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name, colour in (("radiance", self.radiance), ("sun", self.sun)):
            if min(colour) < 0:
                raise wrong(name, f"hold no number below 0, but holds {min(colour):g}")
        return self


class PanoramaSkyConfig(Section):
    """`sky` of kind `panorama`: an equirectangular picture, and a sun or none."""

    kind: Literal["panorama"] = key("panorama", meaning="what sky")
    file: str = key(meaning="PNG, JPEG or EXR; the upper half is the sky", min_length=1)
    rotation: float = key(
        0.0, unit="rad", meaning="turn around the vertical", within="-2π to 2π", ge=-TURN, le=TURN
    )
    scale: float = key(1.0, unit="-", meaning="factor of its light", gt=0, le=1e6)
    sun: Colour = key((0.0, 0.0, 0.0), unit="W m-2 nm-1", meaning="irradiance of a sun it does not hold")
    sun_elevation: float = _sun_elevation()
    sun_azimuth: float = _sun_azimuth()


SkyConfig = Annotated[
    ClearSkyConfig | SpectralSkyConfig | EvenSkyConfig | PanoramaSkyConfig, Field(discriminator="kind")
]


class WaterConfig(Section):
    """`water`: the colour of the water body."""

    chlorophyll: float = key(
        0.1, unit="mg/m^3", meaning="of the water; ocean 0.03 to 1, coast more", ge=0.01, le=50
    )
    colour: Colour | None = key(
        None, unit="-", meaning="reflectance, linear red, green, blue; null: from the chlorophyll"
    )
    sunlit: bool = key(True, meaning="whether the sun lights the water of `colour`, or (false) the sky alone")


class ImageConfig(Section):
    """`image`: its size, and how light becomes code values."""

    height: int = key(720, unit="pixels", meaning="rows", ge=2, le=8192)
    width: int = key(1280, unit="pixels", meaning="columns", ge=2, le=8192)
    tone: Literal["exposure", "filmic", "bruneton"] = key("filmic", meaning="tone mapping")
    white_balance: Literal["none", "sun_and_sky"] | None = key(
        None,
        meaning="what is white: sRGB's (1, 1, 1), or a level white plate in the light of sun and sky; null: the latter "
        "under a clear or spectral sky",
        within="none | sun_and_sky | null",
    )
    exposure: float | None = key(
        None,
        unit="-",
        meaning="factor of the light before it; null: from the picture, and no brighter than dusk is",
        gt=0,
        le=1e9,
    )
    vertex_spacing: float = key(
        4.0, unit="pixels", meaning="from one vertex of the mesh to the next", ge=0.5, le=64
    )
    shading_rate: tuple[int, int] = key(
        (1, 1),
        unit="pixels",
        meaning="rows and columns that share one shaded point of the mesh; (2, 2) takes six tenths of the time",
        within="1 to 4 each",
    )

    @model_validator(mode="after")
    def _check_rate(self) -> Self:
        if not all(1 <= side <= 4 for side in self.shading_rate):
            raise wrong("shading_rate", f"hold 1 to 4 rows and columns, but holds {list(self.shading_rate)}")
        return self


class RayImageConfig(ImageConfig):
    """`image` where rays are an alternative to the mesh."""

    method: Literal["raster", "rays"] = key("raster", meaning="how pixels find the sea: a mesh, or rays")
    samples: int = key(
        1, unit="-", meaning="rays along each side of a pixel, with the method rays", ge=1, le=16
    )

    @model_validator(mode="after")
    def _check_samples(self) -> Self:
        if self.samples > 1 and self.method != "rays":
            raise wrong("samples", f"be 1 unless `method` is rays, but is {self.samples}")
        return self


class SceneConfig(ExperimentConfig):
    """What every picture is made from: a sea, a camera, the light, the image."""

    wind: WindConfig = key(WindConfig(), meaning="the wind")
    spectrum: SpectrumConfig = key(ElfouhailyConfig(), meaning="the wave spectrum")
    cascade: CascadeConfig = key(CascadeConfig(), meaning="the periodic patterns")
    choppiness: Choppiness = choppiness_key()
    threshold: float = threshold_key(0.65)
    unresolved_scale: float | None = key(
        None,
        unit="-",
        meaning="factor on the variance of waves too short for the cascade, which only glitter; null: spectrum.scale",
        ge=0,
        le=1e4,
    )
    breaking_wavenumber: float | None = breaking_wavenumber_key()
    camera: CameraConfig = key(CameraConfig(), meaning="the camera")
    sky: SkyConfig = key(ClearSkyConfig(), meaning="where the light comes from")
    water: WaterConfig = key(WaterConfig(), meaning="the colour of the water body")
    foam: FoamLookConfig = key(FoamLookConfig(), meaning="the look of whitecaps")
    shading: ShadingConfig = key(ShadingConfig(), meaning="how the surface reflects")
    image: ImageConfig = key(ImageConfig(), meaning="the image")
    planet: bool = key(False, meaning="whether the sea curves with the earth: for views from high above")

    @model_validator(mode="after")
    def _check_choppiness(self) -> Self:
        check_choppiness(self.choppiness, len(self.cascade.sizes))
        return self

    def inputs(self) -> tuple[str, ...]:
        return (self.sky.file,) if isinstance(self.sky, PanoramaSkyConfig) else ()


class RenderConfig(SceneConfig):
    """`render`: a picture of a sea, with everything that it is made of."""

    experiment: Literal["render"] = key("render", meaning="which experiment this config runs")
    time: float = key(0.0, unit="s", meaning="time of the picture", ge=0, le=1e9)
    image: RayImageConfig = key(RayImageConfig(), meaning="the image")
