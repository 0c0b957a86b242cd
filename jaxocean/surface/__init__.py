"""Moving surfaces: what every surface can be asked, and the random sea on a cascade of periodic patterns."""

from ._inverse import RestPoint as RestPoint
from ._protocol import AbstractSurface as AbstractSurface
from .fft import Cascade as Cascade
from .fft import Fields as Fields
from .fft import Sea as Sea
from .fft import WorldTile as WorldTile
from .fft import cell_energy as cell_energy
from .fft import draw_noise as draw_noise
from .fft import pattern_choppiness as pattern_choppiness
from .fft import realise as realise
from .fft import tiling_cascade as tiling_cascade
