"""Foam in time: born where the surface breaks, decaying, carried with the water; on a tile and in closed form."""

from ._breaking import PointBreaking as PointBreaking
from ._breaking import point_breaking as point_breaking
from ._evolve import Coverage as Coverage
from ._evolve import Moment as Moment
from ._evolve import evolve as evolve
from ._evolve import observe_coverage as observe_coverage
from ._foam import Foam as Foam
from ._foam import FoamModel as FoamModel
from ._motion import StrainMotion as StrainMotion
from ._motion import strain_motion as strain_motion
from ._pyramid import coverage_pyramid as coverage_pyramid
from ._rate import breaking_rate as breaking_rate
from ._total import AbstractFoamClosure as AbstractFoamClosure
from ._total import PoissonFoam as PoissonFoam
from ._total import RenewalFoam as RenewalFoam
