"""Experiments on states of the sea."""
