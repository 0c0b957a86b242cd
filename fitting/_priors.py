"""Priors: what is known about a parameter before the data, as one more residual."""

import abc
from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxocean._numerics import as_leaf, check_scalar
from jaxocean._types import Scalar


class AbstractPrior(eqx.Module):
    """Knowledge about one parameter; `where` picks its leaf when the prior stands in `fit(priors=…)`."""

    where: eqx.AbstractVar[Callable | None]

    @abc.abstractmethod
    def residual(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """Distance from what is expected, in standard deviations."""

    @abc.abstractmethod
    def log_measure(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """What must be added to −½ residual² for the log density of the value itself, up to a constant."""

    @abc.abstractmethod
    def draw(self, normal: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """Values of this distribution from standard normal numbers."""

    @abc.abstractmethod
    def __str__(self) -> str:
        """The prior in words."""


class Normal(AbstractPrior):
    """A Gaussian prior, residual (v − μ)/s.

    **Arguments:** `mean` μ and standard `deviation` s > 0 in the unit of the parameter; `where`: the leaf,
    for instance `lambda m: m.choppiness`.

    **Raises:** `ValueError` for a deviation that is not positive.
    """

    mean: Scalar = eqx.field(converter=as_leaf)
    deviation: Scalar = eqx.field(converter=as_leaf)
    where: Callable | None = eqx.field(static=True, default=None, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("mean", self.mean, "")
        check_scalar("deviation", self.deviation, "", positive=True)

    def residual(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return (value - self.mean) / self.deviation

    def log_measure(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return jnp.zeros_like(value)

    def draw(self, normal: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return self.mean + self.deviation * normal

    def __str__(self) -> str:
        return f"{float(self.mean):g} ± {float(self.deviation):g}"


class LogNormal(AbstractPrior):
    """A Gaussian prior on the logarithm, residual (ln v − ln m)/s (so the mode is that of ln v).

    **Arguments:** `median` m > 0 in the unit of the parameter; `deviation` s > 0 of ln v; `where`: the leaf.

    **Raises:** `ValueError` for a median or a deviation that is not positive.
    """

    median: Scalar = eqx.field(converter=as_leaf)
    deviation: Scalar = eqx.field(converter=as_leaf)
    where: Callable | None = eqx.field(static=True, default=None, kw_only=True)

    def __check_init__(self) -> None:
        check_scalar("median", self.median, "", positive=True)
        check_scalar("deviation", self.deviation, "", positive=True)

    def residual(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return (jnp.log(value) - jnp.log(self.median)) / self.deviation

    def log_measure(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        # d ln v = dv/v
        return -jnp.log(value)

    def draw(self, normal: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return self.median * jnp.exp(self.deviation * normal)

    def __str__(self) -> str:
        return f"{float(self.median):g} within a factor e^±{float(self.deviation):g}"
