"""Foam and clear water in one pixel."""

import abc

import equinox as eqx
from jaxtyping import Array, Float


class AbstractMixing(eqx.Module):
    """The weights of clear water and of foam."""

    @abc.abstractmethod
    def __call__(self, coverage: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """Weights (clear, foam) of footprints with the visible coverage W, (*b)."""


class ShareMixing(AbstractMixing):
    """Each part of the sea shines once: (1 − W) clear water and W foam."""

    def __call__(self, coverage: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        return 1.0 - coverage, coverage


class AdditiveMixing(AbstractMixing):
    """Foam is added to water that shines as if there were no foam: energy comes from nothing.

    **Source:** Dupuy & Bruneton 2012, eq. 2.
    """

    def __call__(self, coverage: Float[Array, "*b"]) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        return coverage * 0.0 + 1.0, coverage
