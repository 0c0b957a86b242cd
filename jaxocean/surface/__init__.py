"""Moving surfaces: what every surface can be asked, and the random sea on a cascade of periodic patterns."""

from ._inverse import RestPoint as RestPoint
from ._protocol import AbstractSurface as AbstractSurface
from .fft import Cascade as Cascade
from .fft import Fields as Fields
from .fft import Sea as Sea
from .fft import WorldTile as WorldTile
from .fft import autocovariance as autocovariance
from .fft import cell_energy as cell_energy
from .fft import draw_noise as draw_noise
from .fft import pattern_choppiness as pattern_choppiness
from .fft import realise as realise
from .fft import recommend_cascade as recommend_cascade
from .fft import spread_sizes as spread_sizes
from .fft import strain_autocovariance as strain_autocovariance
from .fft import tiling_cascade as tiling_cascade
