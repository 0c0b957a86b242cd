"""The shape vocabulary: the few array types that the whole house speaks."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from jaxtyping import Array, Float, Inexact

Scalar: TypeAlias = Float[Array, ""]
"""A zero-dimensional floating-point array: a physical number that one may differentiate or fit."""

ScalarLike: TypeAlias = float | int | Float[Array, ""] | Float[np.ndarray, ""] | np.floating
"""What users may write where a scalar leaf is expected."""

FloatLike: TypeAlias = float | int | Float[Array, "..."] | Float[np.ndarray, "..."] | np.floating
"""A number or an array of numbers."""

PerPattern: TypeAlias = FloatLike | Sequence[float | int] | Sequence[Float[Array, ""]]
"""One number for all patterns of a cascade, or one for each."""

Complex: TypeAlias = Inexact[Array, "..."]
"""A complex (or real) array of any shape."""
