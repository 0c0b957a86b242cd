"""The sky and the sun over the sea."""

from ._abstract import AbstractSky as AbstractSky
from ._constant import ConstantSky as ConstantSky
