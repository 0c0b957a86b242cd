"""A differentiable ocean: wind → spectrum → surface → whitecaps, and its gradient back."""

from . import spectra as spectra
from . import surface as surface
from .wind import Wind as Wind
