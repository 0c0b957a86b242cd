"""The Jacobian of the horizontal displacement, and what counts as breaking."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jax.scipy.special import ndtr
from jaxtyping import Array, Bool, Float

from .._numerics import as_leaf, check_last_axis, check_scalar
from .._types import FloatLike, Scalar


def jacobian(strain: Float[Array, "*b 3"]) -> Float[Array, "*b"]:
    """How much the choppy displacement stretches (j > 1), squeezes (j < 1) or folds (j < 0) the surface.

    $$ j = (1 + a)(1 + b) − c² $$

    **Arguments:** `strain`: (a, b, c) = λ(∂u/∂x, ∂v/∂y, ∂u/∂y) [-], summed over the patterns **before** the call.

    **Returns:** j [-].

    **Raises:** `ValueError` unless the last axis holds three numbers.

    **Source:** Dupuy & Bruneton 2012, eq. 4 with the lower-right entry 1 + Σλ∂v/∂y.
    """
    check_last_axis("strain", strain.shape, 3, "(a, b, c)")
    a, b, c = strain[..., 0], strain[..., 1], strain[..., 2]
    return (1 + a) * (1 + b) - c * c


class AbstractBreaking(eqx.Module):
    """Which points of the surface break, given their Jacobian."""

    @abc.abstractmethod
    def __call__(self, jacobian: Float[Array, "*b"], threshold: FloatLike) -> Float[Array, "*b"]:
        """1 where the surface breaks, 0 where it does not, from j [-] and the threshold ε [-]."""


class HardBreaking(AbstractBreaking):
    """The indicator 1{j < ε}; its derivative is zero everywhere, so that no fit can use it.

    **Source:** Dupuy & Bruneton 2012, eq. 3.
    """

    def __call__(self, jacobian: Float[Array, "*b"], threshold: FloatLike) -> Float[Array, "*b"]:
        breaks: Bool[Array, "*b"] = jacobian < threshold
        return breaks.astype(jacobian.dtype)


class SmoothBreaking(AbstractBreaking):
    """A differentiable indicator: the probability that j plus Gaussian noise of deviation `width` is below ε.

    $$ Φ((ε − j)/w) $$

    **Arguments:** `width` w [-] of the transition, greater than 0; about a tenth of the deviation of j keeps the
    bias of the coverage small.
    """

    width: Scalar = eqx.field(converter=as_leaf, default=0.02)

    def __check_init__(self) -> None:
        check_scalar("width", self.width, "", positive=True)

    def __call__(self, jacobian: Float[Array, "*b"], threshold: FloatLike) -> Float[Array, "*b"]:
        return ndtr((jnp.asarray(threshold, jacobian.dtype) - jacobian) / self.width)
