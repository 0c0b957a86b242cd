"""Empirical laws of whitecap coverage, each with its range and source."""

from ._coare import COARE36 as COARE36
from ._cubic import Callaghan2008 as Callaghan2008
from ._cubic import StramskaPetelski2003Developed as StramskaPetelski2003Developed
from ._cubic import StramskaPetelski2003Undeveloped as StramskaPetelski2003Undeveloped
from ._law import AbstractLaw as AbstractLaw
from ._law import RangeWarning as RangeWarning
from ._monahan import Monahan1980 as Monahan1980
from ._monahan import Monahan1980LeastSquares as Monahan1980LeastSquares
from ._monahan import MonahanLu1990StageA as MonahanLu1990StageA
from ._monahan import MonahanLu1990StageB as MonahanLu1990StageB
from ._monahan import MonahanOMuircheartaigh1986 as MonahanOMuircheartaigh1986
from ._power import GoddijnMurphy2011 as GoddijnMurphy2011
from ._power import Salisbury2013 as Salisbury2013
from ._zhao_toba import ZhaoToba2001 as ZhaoToba2001

ALL: tuple[AbstractLaw, ...] = (
    Monahan1980(),
    Monahan1980LeastSquares(),
    MonahanOMuircheartaigh1986(),
    MonahanLu1990StageA(),
    MonahanLu1990StageB(),
    ZhaoToba2001(),
    StramskaPetelski2003Undeveloped(),
    StramskaPetelski2003Developed(),
    Callaghan2008(),
    GoddijnMurphy2011(),
    Salisbury2013(),
    COARE36(),
)
"""Every law with its default constants, by year."""
