"""Experiments made cheap for tests."""

from collections.abc import Iterator
from contextlib import contextmanager

import equinox as eqx
import pytest

import jaxocean as jo
from experiments.common import _calibrated_sea


@contextmanager
def gaussian_closure() -> Iterator[None]:
    """Calibrated seas have the Gaussian closure, which compiles in a third of the exact one's time."""
    exact = _calibrated_sea.model

    def gaussian(config):
        return eqx.tree_at(lambda m: m.closure, exact(config), jo.whitecaps.GaussianClosure(config.measure))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_calibrated_sea, "model", gaussian)
        yield
