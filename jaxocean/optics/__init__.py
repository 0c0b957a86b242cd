"""What light does at the sea: sky, Fresnel reflection, slopes, water and foam."""

from . import sky as sky
