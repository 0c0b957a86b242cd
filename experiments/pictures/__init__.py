"""Experiments whose result is a picture."""
