"""What light does at the sea: sky, Fresnel reflection, slopes, water and foam."""

from . import sky as sky
from ._colour import light_to_srgb as light_to_srgb
from ._colour import luminance as luminance
from ._colour import matching_weights as matching_weights
from ._colour import reflectance_to_srgb as reflectance_to_srgb
from ._colour import reflectance_weights as reflectance_weights
from ._colour import srgb_to_xyz as srgb_to_xyz
from ._colour import xyz_to_srgb as xyz_to_srgb
