"""Experiments on measured records."""
