"""Experiments: typed configs in, runs with tables, data and pictures out. Importing this imports no JAX."""
