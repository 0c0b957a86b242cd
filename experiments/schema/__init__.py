"""What may stand in a config: typed sections with units, ranges and meanings. No JAX here."""

from ._base import ExperimentConfig as ExperimentConfig
from ._base import Section as Section
from ._base import key as key
from ._base import wrong as wrong
from ._experiments import SeaStateConfig as SeaStateConfig
from ._sea import DEFAULT_BREAKING_WAVENUMBER as DEFAULT_BREAKING_WAVENUMBER
from ._sea import CascadeConfig as CascadeConfig
from ._sea import Choppiness as Choppiness
from ._sea import WindConfig as WindConfig
from ._sea import breaking_wavenumber_key as breaking_wavenumber_key
from ._sea import check_choppiness as check_choppiness
from ._sea import choppiness_key as choppiness_key
from ._sea import threshold_key as threshold_key
from ._spectra import CosineSpreading as CosineSpreading
from ._spectra import DonelanBannerSpreading as DonelanBannerSpreading
from ._spectra import ElfouhailyConfig as ElfouhailyConfig
from ._spectra import ElfouhailySpreading as ElfouhailySpreading
from ._spectra import HasselmannSpreading as HasselmannSpreading
from ._spectra import JonswapConfig as JonswapConfig
from ._spectra import MitsuyasuSpreading as MitsuyasuSpreading
from ._spectra import PhillipsConfig as PhillipsConfig
from ._spectra import PiersonMoskowitzConfig as PiersonMoskowitzConfig
from ._spectra import SpectrumConfig as SpectrumConfig
from ._spectra import SpreadingConfig as SpreadingConfig
from ._spectra import TessendorfConfig as TessendorfConfig
from ._spectra import TmaConfig as TmaConfig
