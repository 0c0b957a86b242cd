"""The ocean: a sea, its whitecaps and its light together."""

from ._ocean import Ocean as Ocean
