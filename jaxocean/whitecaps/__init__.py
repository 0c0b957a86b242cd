"""Whitecaps: the Jacobian, statistics of the strain, closures and empirical laws."""

from . import foam as foam
from . import laws as laws
from ._closures import AbstractClosure as AbstractClosure
from ._closures import ExactClosure as ExactClosure
from ._closures import GaussianClosure as GaussianClosure
from ._closures import Measure as Measure
from ._closures import PublishedClosure as PublishedClosure
from ._fast_closure import FastClosure as FastClosure
from ._footprints import footprint_statistics as footprint_statistics
from ._jacobian import AbstractBreaking as AbstractBreaking
from ._jacobian import HardBreaking as HardBreaking
from ._jacobian import SmoothBreaking as SmoothBreaking
from ._jacobian import jacobian as jacobian
from ._published_sea import PublishedSea as PublishedSea
from ._realised import realised_coverage as realised_coverage
from ._statistics import StrainStatistics as StrainStatistics
from ._statistics import strain_covariance as strain_covariance
from ._statistics import strain_statistics as strain_statistics
from ._threshold import breaking_threshold as breaking_threshold
from ._two_channels import AbstractTwoChannelClosure as AbstractTwoChannelClosure
from ._two_channels import PrintedTwoChannelClosure as PrintedTwoChannelClosure
from ._two_channels import ProgramTwoChannelClosure as ProgramTwoChannelClosure
from ._two_channels import two_channels as two_channels
