"""A differentiable ocean: wind → spectrum → surface → whitecaps, and its gradient back."""

from . import filtering as filtering
from . import imagery as imagery
from . import io as io
from . import optics as optics
from . import render as render
from . import spectra as spectra
from . import surface as surface
from . import whitecaps as whitecaps
from .ocean import Ocean as Ocean
from .wind import Wind as Wind
