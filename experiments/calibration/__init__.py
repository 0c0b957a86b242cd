"""Experiments that fit a sea to whitecap laws, and ask how sure the fit is."""
