"""Bounds as bijections: a solver moves freely over the real line, its parameter never leaves its range."""

import abc
import math
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

EDGE = 1e-3
"""A fitted value within this fraction of an interval (or of 1) from a bound counts as being at the bound."""


INSIDE = 1 - 1e-7
"""How much of an interval can be reached: its ends themselves may be singular (a sea of choppiness 0)."""


class AbstractBounds(abc.ABC):
    """A smooth map from the real line onto the range of a parameter, and its inverse."""

    @abc.abstractmethod
    def constrain(self, free: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """The parameter from a point on the real line."""

    @abc.abstractmethod
    def unconstrain(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """The point on the real line from a parameter inside the range."""

    @abc.abstractmethod
    def stretch(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """The point of a sampler's real line; unlike `unconstrain`, a bound lies at infinity."""

    @abc.abstractmethod
    def shrink(self, line: Float[Array, "*s"]) -> tuple[Float[Array, "*s"], Float[Array, "*s"]]:
        """The inverse of `stretch`, one to one from the whole line, and the logarithm of its derivative."""

    @abc.abstractmethod
    def contains(self, value: Float[np.ndarray, "*s"]) -> bool:
        """Whether every number lies strictly inside the range."""

    @abc.abstractmethod
    def draw(self, normal: Float[Array, "*s"], start: Float[Array, "*s"]) -> Float[Array, "*s"]:
        """Another sensible starting value, from standard normal numbers and the first start."""

    @abc.abstractmethod
    def touched(self, value: float) -> float | None:
        """The bound that a value lies at, or None."""

    @abc.abstractmethod
    def __str__(self) -> str:
        """The range in words."""


@dataclass(frozen=True)
class Real(AbstractBounds):
    """No bounds: x ↦ x."""

    def constrain(self, free: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return free

    def unconstrain(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return value

    def stretch(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return value

    def shrink(self, line: Float[Array, "*s"]) -> tuple[Float[Array, "*s"], Float[Array, "*s"]]:
        return line, jnp.zeros_like(line)

    def contains(self, value: Float[np.ndarray, "*s"]) -> bool:
        return bool(np.all(np.isfinite(value)))

    def draw(self, normal: Float[Array, "*s"], start: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return start + 0.5 * jnp.maximum(jnp.abs(start), 0.5) * normal

    def touched(self, value: float) -> float | None:
        return None

    def __str__(self) -> str:
        return "any real number"


@dataclass(frozen=True)
class Positive(AbstractBounds):
    """Greater than a lower bound.

    $$ v = v_{lower} + e^x $$

    **Arguments:** `lower`, 0 by default, in the unit of the parameter.
    """

    lower: float | int = 0.0

    def constrain(self, free: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return self.lower + jnp.exp(free)

    def unconstrain(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return jnp.log(value - self.lower)

    def stretch(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return self.unconstrain(value)

    def shrink(self, line: Float[Array, "*s"]) -> tuple[Float[Array, "*s"], Float[Array, "*s"]]:
        return self.constrain(line), line

    def contains(self, value: Float[np.ndarray, "*s"]) -> bool:
        return bool(np.all(np.isfinite(value) & (value > self.lower)))

    def draw(self, normal: Float[Array, "*s"], start: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return self.lower + (start - self.lower) * jnp.exp(0.7 * normal)

    def touched(self, value: float) -> float | None:
        scale = abs(self.lower) if self.lower != 0 else 1e-6
        return float(self.lower) if value - self.lower < EDGE * scale else None

    def __str__(self) -> str:
        return f"greater than {self.lower:g}"


@dataclass(frozen=True)
class Interval(AbstractBounds):
    """Between two bounds.

    $$ v = ½(v_{upper} + v_{lower}) + ½(v_{upper} − v_{lower}) \\sin x $$

    One to one for |x| ≤ π/2 and reflected beyond, so that a solver that is drawn to a bound arrives there: on
    a logistic curve it would crawl for ever. A sampler moves along that logistic curve instead,
    v = v_lower + (v_upper − v_lower)/(1 + e^−y), which is one to one everywhere.

    **Arguments:** `lower` < `upper`, in the unit of the parameter.

    **Raises:** `ValueError` if they are not finite and in order.
    """

    lower: float | int
    upper: float | int

    def __post_init__(self) -> None:
        if not -np.inf < self.lower < self.upper < np.inf:
            raise ValueError(
                "Arguments `lower` and `upper` of an interval must be finite with lower < upper, "
                f"but are {self.lower:g} and {self.upper:g}."
            )

    def constrain(self, free: Float[Array, "*s"]) -> Float[Array, "*s"]:
        return 0.5 * (self.upper + self.lower) + 0.5 * INSIDE * (self.upper - self.lower) * jnp.sin(free)

    def unconstrain(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        part = (2 * value - self.upper - self.lower) / (INSIDE * (self.upper - self.lower))
        return jnp.arcsin(jnp.clip(part, -1.0, 1.0))

    def stretch(self, value: Float[Array, "*s"]) -> Float[Array, "*s"]:
        part = jnp.clip(
            (value - self.lower) / (self.upper - self.lower), 0.5 * (1 - INSIDE), 0.5 * (1 + INSIDE)
        )
        return jnp.log(part) - jnp.log1p(-part)

    def shrink(self, line: Float[Array, "*s"]) -> tuple[Float[Array, "*s"], Float[Array, "*s"]]:
        width = self.upper - self.lower
        value = self.lower + width * jax.nn.sigmoid(line)
        return value, math.log(width) + jax.nn.log_sigmoid(line) + jax.nn.log_sigmoid(-line)

    def contains(self, value: Float[np.ndarray, "*s"]) -> bool:
        return bool(np.all((value > self.lower) & (value < self.upper)))

    def draw(self, normal: Float[Array, "*s"], start: Float[Array, "*s"]) -> Float[Array, "*s"]:
        # Φ of a standard normal number is uniform; the ends themselves are no starting points.
        uniform = jnp.clip(jax.scipy.special.ndtr(normal), 0.02, 0.98)
        return self.lower + (self.upper - self.lower) * uniform

    def touched(self, value: float) -> float | None:
        near = EDGE * (self.upper - self.lower)
        if value - self.lower < near:
            return float(self.lower)
        return float(self.upper) if self.upper - value < near else None

    def __str__(self) -> str:
        return f"between {self.lower:g} and {self.upper:g}"
