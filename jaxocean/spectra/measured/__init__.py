"""Measured directional spectra: a table up to a cut-off, and an explicit tail above it."""

from ._measured import MeasuredSpectrum as MeasuredSpectrum
from ._tails import AbstractTail as AbstractTail
from ._tails import ElfouhailyTail as ElfouhailyTail
from ._tails import NoTail as NoTail
from ._tails import PowerTail as PowerTail
