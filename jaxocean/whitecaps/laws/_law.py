"""What a whitecap law is: the fraction of the sea that is white, from the wind."""

import abc
import warnings
from typing import ClassVar, Literal, TypeAlias

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from equinox import AbstractClassVar
from jaxtyping import Array, Bool, Float

from ..._numerics import check_kind, is_concrete
from ..._types import Scalar
from ...wind import Wind

Constant: TypeAlias = float | int | Float[Array, ""]
"""A constant of a law: a Python number, or an array where one differentiates in it."""


class RangeWarning(UserWarning):
    """A law is used where it has no data behind it."""


class AbstractLaw(eqx.Module):
    """Whitecap coverage W (a fraction, not percent) as an empirical function of the wind.

    The constants of a law are its fields. They are Python numbers, so that a law takes the precision of the
    wind that it is given; pass arrays to differentiate in them. Observed coverage scatters by about a factor
    of ten at one wind speed, and most laws count total foam, active and decaying.

    **Class attributes:** `name`, what tables and plots call the law; `citation`, its source; `range`, the
    lowest and highest U10 [m/s] of the data behind it; `foam`, what it counts: all of it, or only what
    breaks now, or only what is left of it.
    """

    name: AbstractClassVar[str]
    citation: AbstractClassVar[str]
    range: AbstractClassVar[tuple[float, float]]
    foam: ClassVar[Literal["total", "active", "decaying"]] = "total"

    @abc.abstractmethod
    def coverage(self, wind: Wind) -> Scalar:
        """W [-] from the wind, without a look at the range; finite derivatives everywhere."""

    def __call__(self, wind: Wind) -> Scalar:
        """W [-] from the wind; warns (`RangeWarning`) if its speed is known and outside the range."""
        self._warn(wind)
        return self.coverage(wind)

    def log(self, wind: Wind) -> Scalar:
        """log W; −∞ with derivative 0 where the law gives no whitecaps. Warns like a call."""
        self._warn(wind)
        w = self.coverage(wind)
        white = w > 0
        return jnp.where(white, jnp.log(jnp.where(white, w, 1.0)), -jnp.inf)

    def in_range(self, wind: Wind) -> Bool[Array, ""]:
        """Whether there are data behind the law at this wind speed."""
        lower, upper = self.range
        return (wind.speed >= lower) & (wind.speed <= upper)

    def _warn(self, wind: Wind) -> None:
        check_kind("wind", wind, Wind, "a `Wind`")
        if not is_concrete(wind.speed):
            return
        lower, upper = self.range
        speed = float(np.asarray(wind.speed))
        # A bound such as 23.09 m/s is not a float32 number: forgive its rounding.
        slack = 1e-6 * upper
        if not lower - slack <= speed <= upper + slack:
            warnings.warn(
                f"The wind of {speed:g} m/s is outside the range of {self.name}, {lower:g} to {upper:g} m/s: "
                "its coverage there is an extrapolation.",
                RangeWarning,
                stacklevel=3,
            )
