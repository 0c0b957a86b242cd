"""What a model is held against: observed numbers, predictions and their scatter."""

import abc
from collections.abc import Sequence
from typing import Any, TypeAlias

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean import Wind
from jaxocean._numerics import as_leaf, check_scalar, is_concrete
from jaxocean._types import FloatLike, Scalar

Numbers: TypeAlias = FloatLike | Sequence[float | int]
"""A number, an array or a list of numbers."""


class AbstractScatter(eqx.Module):
    """One standard deviation of observations around the truth, in the unit of a target's residuals."""

    value: eqx.AbstractVar[Float[Array, "..."]]


class KnownScatter(AbstractScatter):
    """A scatter that is given: one number for all data of a target, or one for each."""

    value: Float[Array, "..."] = eqx.field(converter=as_leaf)

    def __check_init__(self) -> None:
        check_deviations("scatter", self.value)


class FreeScatter(AbstractScatter):
    """A scatter that is fitted with the other parameters, by maximum likelihood.

    The negative log likelihood Σ r²/2σ² + n log σ is then minimised, so that σ settles at the root mean
    square of the residuals (up to the pull of priors and other targets).

    **Arguments:** `value`: where to start, greater than 0.
    """

    value: Scalar = eqx.field(converter=as_leaf, default=0.5)

    def __check_init__(self) -> None:
        check_scalar("value", self.value, "", positive=True)


def as_row(numbers: Any) -> Float[Array, "..."]:
    """A number, an array or a list of numbers as a floating-point array."""
    return as_leaf(np.asarray(numbers, float) if isinstance(numbers, (list, tuple, range)) else numbers)


def as_scatter(scatter: Any) -> AbstractScatter:
    """A number or an array of numbers as a known scatter."""
    return scatter if isinstance(scatter, AbstractScatter) else KnownScatter(as_row(scatter))


def check_deviations(name: str, value: Float[Array, "..."]) -> None:
    """Raise unless all numbers are finite and positive; tracers pass."""
    if not is_concrete(value) or not isinstance(value, (jax.Array, np.ndarray)):
        return
    bad = ~(np.isfinite(value) & (np.asarray(value) > 0))
    if np.any(bad):
        worst = np.asarray(value)[bad].ravel()[0]
        raise ValueError(f"Argument `{name}` must be finite and greater than 0, but holds {worst:g}.")


def as_winds(winds: Any) -> Wind:
    """Winds as one batched `Wind`: from speeds [m/s], a `Wind`, or a sequence of `Wind`.

    **Raises:** `ValueError` if there is none, or for a negative or non-finite speed.
    """
    if isinstance(winds, Wind):
        batched = winds
        if winds.speed.ndim == 0:
            batched = jax.tree.map(lambda leaf: jnp.asarray(leaf)[None], winds)
    elif isinstance(winds, (list, tuple)) and winds and all(isinstance(one, Wind) for one in winds):
        batched = jax.tree.map(lambda *leaves: jnp.stack(leaves), *winds)
    else:
        speeds = jnp.atleast_1d(as_row(winds))
        if speeds.ndim != 1 or speeds.size == 0:
            raise ValueError(
                f"Argument `winds` must be a row of at least one wind, but has shape {speeds.shape}."
            )
        batched = eqx.filter_vmap(Wind)(speeds)
    speed = batched.speed
    if is_concrete(speed) and not np.all(np.isfinite(speed) & (np.asarray(speed) >= 0)):
        raise ValueError("Argument `winds` must hold finite speeds of at least 0 m/s.")
    return batched


Scatter: TypeAlias = Numbers | AbstractScatter
"""One standard deviation for all data, one for each, or one that is fitted."""

Winds: TypeAlias = Numbers | range | Wind | Sequence[Wind]
"""Wind speeds [m/s], or winds."""


class AbstractTarget(eqx.Module):
    """Observations at a row of winds. Targets add: `law + slopes` is held against both.

    The residual of one datum is (predicted − observed)/scatter, in transformed units (`unit`) where its
    scatter is the same for small and large values.
    """

    winds: eqx.AbstractVar[Wind]
    scatter: eqx.AbstractVar[AbstractScatter]

    @property
    @abc.abstractmethod
    def name(self) -> str:
        """What reports call the target."""

    @property
    @abc.abstractmethod
    def unit(self) -> str:
        """Unit of the residuals before they are divided by the scatter."""

    @abc.abstractmethod
    def observed(self) -> Float[Array, " n"]:
        """Observed numbers in transformed units."""

    @abc.abstractmethod
    def predict(self, model: Any, wind: Wind) -> Scalar:
        """What the model predicts at one wind, in transformed units."""

    @abc.abstractmethod
    def tabulated(self) -> "AbstractTarget":
        """An equal target that holds its observed numbers: fits to different laws then share one program."""

    @abc.abstractmethod
    def notes(self) -> tuple[str, ...]:
        """Sentences that belong into the report of a fit."""

    @property
    def size(self) -> int:
        """How many data there are."""
        return int(self.winds.speed.shape[0])

    def __add__(self, other: "AbstractTarget | TargetSum") -> "TargetSum":
        return TargetSum(flatten_targets([self, other]))


class TargetSum(eqx.Module):
    """Several targets at once: their negative log likelihoods add."""

    targets: tuple[AbstractTarget, ...]

    def __add__(self, other: "AbstractTarget | TargetSum") -> "TargetSum":
        return TargetSum(flatten_targets([self, other]))


def flatten_targets(targets: Any) -> tuple[AbstractTarget, ...]:
    """One target, a sum or a sequence of both as a flat tuple.

    **Raises:** `ValueError` if there is none or something else is among them.
    """
    if isinstance(targets, AbstractTarget):
        return (targets,)
    if isinstance(targets, TargetSum):
        return targets.targets
    flat = tuple(one for target in targets for one in flatten_targets(target)) if _is_row(targets) else ()
    if not flat:
        raise ValueError(f"Argument `targets` must hold at least one target, but is {targets!r}.")
    return flat


def _is_row(targets: Any) -> bool:
    return isinstance(targets, (list, tuple))


def unique_names(targets: Sequence[AbstractTarget]) -> list[str]:
    """The targets' names, numbered where two are alike."""
    names = [target.name for target in targets]
    return [
        name if names.count(name) == 1 else f"{name} ({names[: i + 1].count(name)})"
        for i, name in enumerate(names)
    ]
