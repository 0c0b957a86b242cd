"""The sky and the sun over the sea."""

from ._abstract import AbstractSky as AbstractSky
from ._bake import bake as bake
from ._cloudy import CloudySky as CloudySky
from ._constant import ConstantSky as ConstantSky
from ._hosek_wilkie import HosekWilkie as HosekWilkie
from ._image import ImageSky as ImageSky
from ._local import LocalSky as LocalSky
from ._mirror import Mirror as Mirror
from ._spectral_hosek_wilkie import SpectralHosekWilkie as SpectralHosekWilkie
from ._sun import SUN_RADIUS as SUN_RADIUS
from ._tables import WAVELENGTHS as WAVELENGTHS
