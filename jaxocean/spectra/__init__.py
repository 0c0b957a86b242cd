"""Directional wavenumber spectra Ψ(kx, ky) [m⁴], their dispersion relation, spreading and moments."""

from ._breaking import breaking_filter as breaking_filter
from ._dispersion import Dispersion as Dispersion
from ._elfouhaily import Elfouhaily as Elfouhaily
from ._moments import BAND as BAND
from ._moments import height_variance as height_variance
from ._moments import mean_square_slope as mean_square_slope
from ._moments import significant_wave_height as significant_wave_height
from ._moments import slope_variance as slope_variance
from ._spectrum import AbstractSpectrum as AbstractSpectrum
from ._spectrum import Harmonics as Harmonics
from ._spectrum import ScaledSpectrum as ScaledSpectrum
from ._spectrum import SumSpectrum as SumSpectrum
from ._spectrum import integrate_harmonics as integrate_harmonics
