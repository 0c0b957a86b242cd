"""The promise of a model whose costly part can be computed once, before a solver starts."""

import abc
from typing import Any

import equinox as eqx
from jaxtyping import PyTree

from jaxocean import Wind


class AbstractPreparedModel(eqx.Module):
    """A model that splits into what depends on the wind alone and what a solver varies.

    A fit whose free leaves are none of `preparation_leaves` calls `prepare` once per wind and solves with
    `prepared(state)`; any other fit calls the model as it is. Both give the same numbers.
    """

    @abc.abstractmethod
    def prepare(self, wind: Wind) -> PyTree:
        """The costly part at one wind."""

    @abc.abstractmethod
    def prepared(self, state: PyTree) -> Any:
        """The same model with its costly part known, for that one wind."""

    @abc.abstractmethod
    def preparation_leaves(self) -> PyTree:
        """The leaves that `prepare` depends on."""
