"""The FFT sea: a random linear sea on a cascade of periodic patterns."""

from ._autocorrelation import autocovariance as autocovariance
from ._autocorrelation import strain_autocovariance as strain_autocovariance
from ._cascade import Cascade as Cascade
from ._cells import cell_energy as cell_energy
from ._choppiness import pattern_choppiness as pattern_choppiness
from ._fields import Fields as Fields
from ._noise import draw_noise as draw_noise
from ._realise import realise as realise
from ._recommend import recommend_cascade as recommend_cascade
from ._recommend import spread_sizes as spread_sizes
from ._sea import Sea as Sea
from ._tile import WorldTile as WorldTile
from ._tile import tiling_cascade as tiling_cascade
