"""Data sets that a model could have given: its own predictions with scatter."""

from collections.abc import Sequence
from typing import Any

import equinox as eqx
import jax
from jaxtyping import Array, Float, PRNGKeyArray, PyTree, UInt32

from jaxocean import Wind
from jaxocean._types import Scalar

from ._solve import lift
from ._target import AbstractScatter, AbstractTarget, Numbers, TargetSum, as_row, flatten_targets


class Replayed(AbstractTarget):
    """A target whose observed numbers are others: the same winds, scatter and predictions.

    **Arguments:** `target`; `numbers`: in its transformed unit, one for each of its winds.

    **Raises:** `ValueError` for another number of numbers.
    """

    target: AbstractTarget
    numbers: Float[Array, " n"]

    def __init__(self, target: AbstractTarget, numbers: Numbers) -> None:
        self.target = target
        self.numbers = as_row(numbers)

    def __check_init__(self) -> None:
        if self.numbers.shape != (self.target.size,):
            raise ValueError(
                f"Argument `numbers` must have one number for each of the {self.target.size} winds, but has "
                f"shape {self.numbers.shape}."
            )

    @property
    def winds(self) -> Wind:
        return self.target.winds

    @property
    def scatter(self) -> AbstractScatter:
        return self.target.scatter

    @property
    def name(self) -> str:
        return self.target.name

    @property
    def unit(self) -> str:
        return self.target.unit

    def observed(self) -> Float[Array, " n"]:
        return self.numbers

    def predict(self, model: Any, wind: Wind) -> Scalar:
        return self.target.predict(model, wind)

    def tabulated(self) -> "Replayed":
        return self

    def notes(self) -> tuple[str, ...]:
        return self.target.notes()


def synthetic(
    model: PyTree,
    targets: AbstractTarget | TargetSum | Sequence[AbstractTarget | TargetSum],
    *,
    count: int = 1,
    key: PRNGKeyArray | UInt32[Array, "2"],
) -> tuple[tuple[AbstractTarget, ...], ...]:
    """Draw data sets from a model: what these targets would have observed, were the model the truth.

    $$ y_i = f(m_i) + σ_i ξ_i $$

    with f the transform in which a target has its scatter (log10 of coverage, so that coverage scatters
    log-normally) and ξ standard normal.

    **Arguments:** `model`, `targets`: as for `fit`, of the targets only winds and scatter count (of a free
    scatter, its start); `count`: how many data sets; `key`.

    **Returns:** `count` data sets, each a tuple of targets to give to `fit`.

    **Raises:** `ValueError` for a count below 1.
    """
    if count < 1:
        raise ValueError(f"Argument `count` must be at least 1, but is {count}.")
    with jax.enable_x64(True):
        plain = tabulate(flatten_targets(targets))
        drawn = _draw(model, plain, key, count)
        sets = [[numbers[i] for numbers in drawn] for i in range(count)]
    return tuple(
        tuple(Replayed(target, one) for target, one in zip(plain, each, strict=True)) for each in sets
    )


@eqx.filter_jit
def tabulate(targets: tuple[AbstractTarget, ...]) -> tuple[AbstractTarget, ...]:
    """The targets in float64 with their observed numbers as data: problems of one kind share one program."""
    return tuple(target.tabulated() for target in lift(targets))


@eqx.filter_jit
def replay(targets: tuple[AbstractTarget, ...]) -> tuple[Replayed, ...]:
    """The targets with their own observed numbers, in a form that takes others."""
    return tuple(Replayed(target, target.observed()) for target in targets)


def scattered(predicted: Float[Array, " n"], scatter: Float[Array, "..."], key: Any) -> Float[Array, " n"]:
    """One observation of each number."""
    return predicted + scatter * jax.random.normal(key, predicted.shape, predicted.dtype)


@eqx.filter_jit
def _draw(model: PyTree, targets: tuple[AbstractTarget, ...], key: Any, count: int) -> tuple[Array, ...]:
    model, targets = lift((model, targets))
    drawn = []
    for target, one in zip(targets, jax.random.split(key, len(targets)), strict=True):
        predicted = jax.vmap(lambda wind, target=target: target.predict(model, wind))(target.winds)
        drawn.append(
            jax.vmap(lambda k, p=predicted, t=target: scattered(p, t.scatter.value, k))(
                jax.random.split(one, count)
            )
        )
    return tuple(drawn)
