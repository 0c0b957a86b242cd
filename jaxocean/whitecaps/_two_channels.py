"""Dupuy & Bruneton's closure over footprints, from the two channels k and k² that they filter."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jax.scipy.special import ndtr
from jaxtyping import Array, Bool, Float

from .._types import FloatLike
from ._jacobian import jacobian


def two_channels(strain: Float[Array, "*b 3"], patterns: int) -> Float[Array, "*b 2"]:
    """The channels (k_i, k_i²) of one of n patterns [-], to be filtered linearly.

    $$ k_i = 1/n + a_i + b_i + a_ib_i - c_i^2 $$

    **Arguments:** `strain`: (a, b, c) of each pattern by itself, λ included; `patterns`: n.

    **Source:** Dupuy & Bruneton 2012, eq. 7.
    """
    k = jacobian(strain) - (1 - 1 / patterns)
    return jnp.stack([k, k * k], axis=-1)


class AbstractTwoChannelClosure(eqx.Module):
    """Coverage of a footprint, at rest, from the means of k_i and k_i² in it: j is taken as Gaussian.

    $$ W = Φ((ε - μ)/σ), \\quad μ = Σ E[k_i] $$
    """

    @abc.abstractmethod
    def variance(self, means: Float[Array, "*b pattern 2"]) -> Float[Array, "*b"]:
        """σ² [-] from E[k_i] and E[k_i²]."""

    @abc.abstractmethod
    def __call__(self, means: Float[Array, "*b pattern 2"], threshold: FloatLike) -> Float[Array, "*b"]:
        """W [-] at the breaking threshold ε [-]; NaN where σ² < 0."""


class PrintedTwoChannelClosure(AbstractTwoChannelClosure):
    """The variance as printed, σ² = Σ E[k_i²] − μ²: negative, and W undefined, for most footprints of several patterns.

    **Source:** Dupuy & Bruneton 2012, eqs 6 to 8.
    """

    def variance(self, means: Float[Array, "*b pattern 2"]) -> Float[Array, "*b"]:
        return jnp.sum(means[..., 1], axis=-1) - jnp.sum(means[..., 0], axis=-1) ** 2

    def __call__(self, means: Float[Array, "*b pattern 2"], threshold: FloatLike) -> Float[Array, "*b"]:
        return _gaussian(means, self.variance(means), threshold)

    def defined(self, means: Float[Array, "*b pattern 2"]) -> Bool[Array, "*b"]:
        """Whether the printed variance is not negative."""
        return self.variance(means) >= 0


class ProgramTwoChannelClosure(AbstractTwoChannelClosure):
    """The variance as their program computes it, σ² = Σ (E[k_i²] − E[k_i]²): without the terms between patterns.

    **Source:** Dupuy & Bruneton 2012, the program published with the paper.
    """

    def variance(self, means: Float[Array, "*b pattern 2"]) -> Float[Array, "*b"]:
        spread = jnp.sum(means[..., 1] - means[..., 0] ** 2, axis=-1)
        return jnp.maximum(spread, 0)  # rounding alone makes it negative

    def __call__(self, means: Float[Array, "*b pattern 2"], threshold: FloatLike) -> Float[Array, "*b"]:
        return _gaussian(means, self.variance(means), threshold)


def _gaussian(means, variance, threshold: FloatLike) -> Float[Array, "*b"]:
    """Φ((ε − μ)/σ); the indicator where σ = 0, NaN where σ² < 0."""
    mean = jnp.sum(means[..., 0], axis=-1)
    level = jnp.asarray(threshold).astype(mean.dtype)
    spread = variance > 0
    deviation = jnp.sqrt(jnp.where(spread, variance, 1.0))
    still = jnp.where(variance < 0, jnp.nan, (mean < level).astype(mean.dtype))
    return jnp.where(spread, ndtr((level - mean) / deviation), still)
