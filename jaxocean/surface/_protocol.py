"""What every surface can be asked, whether it is an FFT sea, a sum of trochoids or a noise."""

import abc

import equinox as eqx
import numpy as np
from jaxtyping import Array, Float

from .._types import Scalar, ScalarLike

Points = Float[Array, "*b 2"] | Float[np.ndarray, "*b 2"]
"""Places on the plane [m]."""


class AbstractSurface(eqx.Module):
    """A moving surface over the rest plane: the point at rest at p is displaced to (p + D(p, t), η(p, t)).

    All queries take points of any batch shape and are differentiable in the point, the time and every leaf.
    The displacement and its gradient, the strain, are those of the surface that is seen: any choppiness is
    in them. A surface whose choppiness is an argument instead of a part of it (`Sea`) answers here for λ = 1.
    """

    @abc.abstractmethod
    def height(self, p: Points, time: ScalarLike) -> Float[Array, "*b"]:
        """Height η [m] above the rest plane."""

    @abc.abstractmethod
    def displacement(self, p: Points, time: ScalarLike) -> Float[Array, "*b 2"]:
        """Horizontal displacement D = (u, v) [m]."""

    @abc.abstractmethod
    def slope(self, p: Points, time: ScalarLike) -> Float[Array, "*b 2"]:
        """Slope (∂η/∂x, ∂η/∂y) [-] on the rest plane."""

    @abc.abstractmethod
    def strain(self, p: Points, time: ScalarLike) -> Float[Array, "*b 3"]:
        """Strain (a, b, c) = (∂u/∂x, ∂v/∂y, ∂u/∂y) [-]; ∂u/∂y = ∂v/∂x."""

    @abc.abstractmethod
    def height_bound(self) -> Scalar:
        """A number [m] that |η| never exceeds, anywhere, at any time."""

    @abc.abstractmethod
    def slope_bound(self) -> Scalar:
        """A number [-] that the steepness |∇η| on the rest plane never exceeds."""
