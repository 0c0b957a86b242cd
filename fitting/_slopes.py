"""Slope variance as a target: what the sun's glitter says."""

import abc
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxocean import Wind
from jaxocean._constants import VON_KARMAN
from jaxocean._types import Scalar

from ._target import AbstractScatter, AbstractTarget, Scatter, Winds, as_scatter, as_winds


class Slopes(NamedTuple):
    """Slope variance along and across the wind [-]."""

    upwind: Scalar
    crosswind: Scalar


class CoxMunk1954(eqx.Module):
    """Slope variance of a clean sea from photographs of the sun's glitter.

    $$ σ_c² = 0.003 + 1.92·10^{-3} U, \\quad σ_u² = 3.16·10^{-3} U $$

    with U at 12.5 m, which the neutral logarithmic profile gives from U10 and u*. Data from 1 to 14 m/s.

    **Source:** Cox & Munk 1954, J. Opt. Soc. Am. 44.
    """

    upwind: float | Scalar = 3.16e-3
    crosswind: float | Scalar = 1.92e-3
    crosswind_calm: float | Scalar = 0.003

    def __call__(self, wind: Wind) -> Slopes:
        """Slope variances [-] of a wind."""
        u = wind_at(wind, 12.5)
        return Slopes(self.upwind * u, self.crosswind_calm + self.crosswind * u)


def wind_at(wind: Wind, height: float) -> Scalar:
    """Wind speed [m/s] at a height [m], along the neutral profile U(z) = U10 + (u*/κ) ln(z/10)."""
    friction = wind.friction_velocity(wind.inverse_wave_age())
    return wind.speed + friction / VON_KARMAN * math.log(height / 10.0)


class AbstractComponent(eqx.Module):
    """Which slope variance is compared."""

    @abc.abstractmethod
    def __call__(self, slopes: Slopes) -> Scalar:
        """The number to compare [-]."""

    @abc.abstractmethod
    def __str__(self) -> str:
        """Its name."""


class Total(AbstractComponent):
    """The mean-square slope, both directions together."""

    def __call__(self, slopes: Slopes) -> Scalar:
        return slopes.upwind + slopes.crosswind

    def __str__(self) -> str:
        return "mean-square slope"


class Upwind(AbstractComponent):
    """The variance of the slope along the wind."""

    def __call__(self, slopes: Slopes) -> Scalar:
        return slopes.upwind

    def __str__(self) -> str:
        return "upwind slope variance"


class Crosswind(AbstractComponent):
    """The variance of the slope across the wind."""

    def __call__(self, slopes: Slopes) -> Scalar:
        return slopes.crosswind

    def __str__(self) -> str:
        return "crosswind slope variance"


class SlopeVariance(AbstractTarget):
    """The model's slopes shall follow a law.

    $$ r = (\\ln σ²_{model}(U) − \\ln σ²_{law}(U))/s $$

    **Arguments:**

    - `winds`: speeds [m/s], or winds.
    - `law`: a function of the wind that returns `Slopes`, `CoxMunk1954()` by default.
    - `component`: `Total()`, `Upwind()` or `Crosswind()`.
    - `scatter`: s, the relative scatter, or `FreeScatter(start)`.
    - `label`: what reports call the law.

    The model needs `slope_variance(wind)`, the variances along and across the wind. Slopes of the undisplaced
    surface know neither choppiness nor threshold: this target informs about the spectrum.
    """

    winds: Wind
    law: Callable
    component: AbstractComponent
    scatter: AbstractScatter
    label: str = eqx.field(static=True)

    def __init__(
        self,
        winds: Winds,
        law: Callable | None = None,
        component: AbstractComponent | None = None,
        scatter: Scatter = 0.1,
        label: str = "Cox & Munk 1954",
    ) -> None:
        self.winds = as_winds(winds)
        self.law = CoxMunk1954() if law is None else law
        self.component = Total() if component is None else component
        self.scatter = as_scatter(scatter)
        self.label = label

    @property
    def name(self) -> str:
        return f"{self.component} ({self.label})"

    @property
    def unit(self) -> str:
        return "ln"

    def observed(self) -> Float[Array, " n"]:
        return jnp.log(jax.vmap(lambda wind: self.component(self.law(wind)))(self.winds))

    def predict(self, model: Any, wind: Wind) -> Scalar:
        if not hasattr(model, "slope_variance"):
            raise ValueError(
                "Argument `model` must have a method `slope_variance(wind)` for a slope target, "
                f"but a {type(model).__name__} has none."
            )
        return jnp.log(self.component(Slopes(*model.slope_variance(wind))))

    def tabulated(self) -> "SlopeVariance":
        return self

    def notes(self) -> tuple[str, ...]:
        return ()
