"""Experiments on the patterns of a cascade: the paper's scenes, and how a sea repeats."""
