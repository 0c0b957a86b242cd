"""Experiments on closures over the whole plane."""
