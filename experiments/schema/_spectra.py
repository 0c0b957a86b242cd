"""The section `spectrum`: one family of wave spectra, each with keys of its own."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ._base import TURN, Section, key, wrong


class CosineSpreading(Section):
    """cos²ˢ(θ/2) with one exponent for all waves."""

    law: Literal["cosine"] = key("cosine", meaning="directional spreading law")
    s: float = key(10.0, unit="-", meaning="exponent: 0 isotropic, 10 wind sea, 75 long swell", ge=0, le=1e4)


class MitsuyasuSpreading(Section):
    """cos²ˢ(θ/2), narrowest at the peak."""

    law: Literal["mitsuyasu"] = key("mitsuyasu", meaning="directional spreading law")
    s_max: float = key(10.0, unit="-", meaning="exponent at the peak: 10 wind sea, 25-75 swell", ge=0, le=1e4)


class HasselmannSpreading(Section):
    """Hasselmann et al. 1980."""

    law: Literal["hasselmann"] = key("hasselmann", meaning="directional spreading law")
    inverse_wave_age: float = key(1.17, unit="-", meaning="U10/c_p", gt=0, le=10)


class DonelanBannerSpreading(Section):
    """sech² of Donelan and Banner."""

    law: Literal["donelan_banner"] = key("donelan_banner", meaning="directional spreading law")


class ElfouhailySpreading(Section):
    """1 + Δ cos 2θ of Elfouhaily et al. 1997."""

    law: Literal["elfouhaily"] = key("elfouhaily", meaning="directional spreading law")


SpreadingConfig = Annotated[
    CosineSpreading | MitsuyasuSpreading | HasselmannSpreading | DonelanBannerSpreading | ElfouhailySpreading,
    Field(discriminator="law"),
]


def _spreading():
    return key(MitsuyasuSpreading(), meaning="how energy spreads over directions")


class SwellConfig(Section):
    """A second wave system, narrow and without a tail, that is added to the spectrum."""

    significant_wave_height: float = key(2.0, unit="m", meaning="Hs of the swell; 0: none", ge=0, le=50)
    peak_period: float = key(12.0, unit="s", meaning="Tp of the swell", gt=0, le=60)
    direction: float = key(
        0.0,
        unit="rad",
        meaning="travels towards, counter-clockwise from +x (east), like `wind.direction`",
        within="-2π to 2π",
        ge=-TURN,
        le=TURN,
    )
    width: float = key(0.1, unit="-", meaning="σ/f_p of the bell in frequency", ge=0.01, le=0.3)
    spreading: SpreadingConfig = key(
        MitsuyasuSpreading(s_max=75.0), meaning="how its energy spreads over directions"
    )


def _scale():
    return key(1.0, unit="-", meaning="factor on the variance, without the swell", ge=0, le=1e4)


def _swell():
    return key(
        None,
        meaning="swell besides it (significant_wave_height, peak_period, direction, width, spreading); null: none",
    )


class ElfouhailyConfig(Section):
    """Elfouhaily et al. 1997: swell to ripples."""

    family: Literal["elfouhaily"] = key("elfouhaily", meaning="family of spectra")
    inverse_wave_age: float | None = key(
        None, unit="-", meaning="Ω = U10/c_p; null: from the wind's fetch, 0.84 without one", ge=0.5, le=10
    )
    half_plane: bool = key(False, meaning="only waves that travel downwind, energy unchanged")
    scale: float = _scale()
    swell: SwellConfig | None = _swell()


class PiersonMoskowitzConfig(Section):
    """Pierson-Moskowitz: a fully developed sea from the wind."""

    family: Literal["pierson_moskowitz"] = key("pierson_moskowitz", meaning="family of spectra")
    spreading: SpreadingConfig = _spreading()
    scale: float = _scale()
    swell: SwellConfig | None = _swell()


class JonswapConfig(Section):
    """JONSWAP: from height and period, or from the wind and `wind.fetch`."""

    family: Literal["jonswap"] = key("jonswap", meaning="family of spectra")
    significant_wave_height: float | None = key(
        None, unit="m", meaning="Hs; null: from the wind and wind.fetch", gt=0, le=50
    )
    peak_period: float | None = key(
        None, unit="s", meaning="Tp; null: from the wind and wind.fetch", gt=0, le=60
    )
    peak_enhancement: float = key(3.3, unit="-", meaning="peak enhancement γ", ge=1, le=20)
    spreading: SpreadingConfig = _spreading()
    scale: float = _scale()
    swell: SwellConfig | None = _swell()

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.significant_wave_height is None) != (self.peak_period is None):
            given, absent = "significant_wave_height", "peak_period"
            if self.significant_wave_height is None:
                given, absent = absent, given
            raise wrong(absent, f"be given together with `{given}` (or neither, with `wind.fetch`)")
        return self


class TmaConfig(Section):
    """TMA: JONSWAP in water of finite depth."""

    family: Literal["tma"] = key("tma", meaning="family of spectra")
    depth: float = key(20.0, unit="m", meaning="water depth", gt=0, le=12000)
    significant_wave_height: float = key(2.0, unit="m", meaning="Hs", gt=0, le=50)
    peak_period: float = key(8.0, unit="s", meaning="Tp of the JONSWAP factor", gt=0, le=60)
    peak_enhancement: float = key(3.3, unit="-", meaning="peak enhancement γ", ge=1, le=20)
    spreading: SpreadingConfig = _spreading()
    scale: float = _scale()
    swell: SwellConfig | None = _swell()


class PhillipsConfig(Section):
    """Phillips: saturated below the waves that the wind can raise."""

    family: Literal["phillips"] = key("phillips", meaning="family of spectra")
    amplitude: float = key(
        0.0081, unit="-", meaning="A of Ψ = A exp(-1/(kL)²)/k⁴ |cos|^exponent", gt=0, le=10
    )
    exponent: float = key(
        2.0, unit="-", meaning="of the cosine to the wind; larger is narrower", ge=0, le=100
    )
    smallest_wave: float = key(
        0.0, unit="m", meaning="waves much shorter are damped; 0 keeps all", ge=0, le=1e3
    )
    opposing: float = key(1.0, unit="-", meaning="share that waves against the wind keep", ge=0, le=1)
    scale: float = _scale()
    swell: SwellConfig | None = _swell()


class TessendorfConfig(Section):
    """Phillips with the amplitude of Tessendorf's program, whose sea depends on the size of its patch."""

    family: Literal["tessendorf"] = key("tessendorf", meaning="family of spectra")
    amplitude: float = key(
        6e-7, unit="m^-2", meaning="A of Tessendorf's notes, per mode of his patch", gt=0, le=10
    )
    size: float = key(
        1000.0, unit="m", meaning="side of the patch that the amplitude belongs to", gt=0, le=1e7
    )
    exponent: float = key(
        2.0, unit="-", meaning="of the cosine to the wind; larger is narrower", ge=0, le=100
    )
    smallest_wave: float = key(
        0.0, unit="m", meaning="waves much shorter are damped; 0 keeps all", ge=0, le=1e3
    )
    opposing: float = key(1.0, unit="-", meaning="share that waves against the wind keep", ge=0, le=1)
    scale: float = _scale()
    swell: SwellConfig | None = _swell()


SpectrumConfig = Annotated[
    ElfouhailyConfig | PiersonMoskowitzConfig | JonswapConfig | TmaConfig | PhillipsConfig | TessendorfConfig,
    Field(discriminator="family"),
]
