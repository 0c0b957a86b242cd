"""The ocean: a sea and its whitecaps together."""

from ._ocean import Ocean as Ocean
