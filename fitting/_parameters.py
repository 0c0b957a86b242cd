"""Which leaves of a model are free, under which name, in which unit and within which bounds."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, PyTree

from jaxocean._numerics import is_concrete

from ._bounds import AbstractBounds, Interval, Positive, Real
from ._priors import AbstractPrior

VOCABULARY: dict[str, tuple[str, AbstractBounds]] = {
    "threshold": ("-", Real()),
    # From coverage alone a choppiness without bounds runs away along a ridge.
    "choppiness": ("-", Interval(0.0, 3.0)),
    "breaking_wavenumber": ("rad/m", Positive()),
    "inverse_wave_age": ("-", Interval(0.5, 6.0)),
    "speed": ("m/s", Positive()),
    "direction": ("rad", Real()),
    "fetch": ("m", Positive()),
    "sea_air_temperature_difference": ("K", Real()),
    "significant_wave_height": ("m", Positive()),
    "peak_period": ("s", Positive()),
    "peak_enhancement": ("-", Positive()),
    "decay_time": ("s", Positive()),
    "depth": ("m", Positive()),
    "factor": ("-", Positive()),
    "coefficient": ("-", Positive()),
    "exponent": ("-", Real()),
    "width": ("-", Positive()),
    "exposure": ("stops", Real()),
    "sun_elevation": ("rad", Interval(-math.pi / 2, math.pi / 2)),
    "sun_azimuth": ("rad", Real()),
    "turbidity": ("-", Interval(1.0, 10.0)),
    "cover": ("-", Interval(0.0, 1.0)),
    "excess": ("-", Real()),
    "contrast": ("-", Positive()),
    "reflectance": ("-", Interval(0.0, 1.0)),
    "chlorophyll": ("mg/m^3", Positive()),
    "heading": ("rad", Real()),
    "pitch": ("rad", Real()),
    "roll": ("rad", Real()),
    "field_of_view": ("rad", Interval(0.0, 3.0)),
}
"""Unit and default bounds by the name of the leaf; anything else is real and without a unit."""


@dataclass(frozen=True)
class Parameter:
    """A free leaf, with more to say about it than a plain function in `free=`.

    **Arguments:**

    - `where`: picks the leaf, `lambda m: m.threshold`.
    - `name`, `unit`: for reports; by default the name of the leaf and the unit that the house uses for it.
    - `bounds`: `Real()`, `Positive()` or `Interval(lower, upper)`; by default those that suit the name
      (a choppiness lies between 0 and 3).
    - `prior`: `Normal` or `LogNormal`.
    - `per_wind`: one value for each wind speed of the targets, instead of one shared by all.
    """

    where: Callable
    name: str | None = None
    unit: str | None = None
    bounds: AbstractBounds | None = None
    prior: AbstractPrior | None = None
    per_wind: bool = False


@dataclass(frozen=True)
class Slot:
    """One free leaf, resolved: hashable, so that two fits of the same kind share their compiled program."""

    name: str
    unit: str
    index: int
    shape: tuple[int, ...]
    bounds: AbstractBounds
    per_wind: bool
    is_scatter: bool = False

    @property
    def size(self) -> int:
        """How many numbers this leaf holds."""
        return math.prod(self.shape)

    def labels(self, winds: Sequence[float]) -> list[str]:
        """A name for each of its numbers."""
        if self.per_wind:
            inner = self.shape[1:]
            at = [f"{self.name}({speed:g} m/s)" for speed in winds]
            return [f"{a}{_subscript(i)}" for a in at for i in np.ndindex(*inner)]
        return [f"{self.name}{_subscript(i)}" for i in np.ndindex(*self.shape)]


def split(slots: Sequence[Slot], values: Any) -> list[Any]:
    """A flat vector cut into one array per slot."""
    parts, position = [], 0
    for slot in slots:
        parts.append(values[position : position + slot.size].reshape(slot.shape))
        position += slot.size
    return parts


def _subscript(index: tuple[int, ...]) -> str:
    return f"[{', '.join(map(str, index))}]" if index else ""


class _Marker:
    """Stands in a leaf's place while a user's function picks it."""

    def __init__(self, index: int) -> None:
        self.index = index


def locate(tree: PyTree, where: Callable, argument: str) -> list[int]:
    """Positions among the flattened leaves of `tree` that `where` picks.

    **Raises:** `ValueError` that says how to pick a leaf.
    """
    leaves, treedef = jax.tree.flatten(tree)
    marked = treedef.unflatten([_Marker(i) for i in range(len(leaves))])
    hint = f"Argument `{argument}` must pick leaves of the model, such as `lambda m: m.threshold`"
    try:
        picked = jax.tree.leaves(where(marked))
    except (AttributeError, TypeError, IndexError, KeyError) as error:
        raise ValueError(f"{hint}, but it fails: {error}.") from error
    if not picked:
        raise ValueError(f"{hint}, but it picks nothing: a field that is None has no number to fit.")
    if not all(isinstance(one, _Marker) for one in picked):
        raise ValueError(f"{hint}, but it returns something that is not a leaf.")
    for one in picked:
        if not _is_number(leaves[one.index]):
            raise ValueError(f"{hint}, but a picked leaf is no floating-point number: {leaves[one.index]!r}.")
    return [one.index for one in picked]


def _is_number(leaf: Any) -> bool:
    if isinstance(leaf, float):
        return True
    return isinstance(leaf, (jax.Array, np.ndarray)) and jnp.issubdtype(leaf.dtype, jnp.floating)


def leaf_names(tree: PyTree) -> list[str]:
    """The dotted path of every leaf."""
    paths, _ = jax.tree_util.tree_flatten_with_path(tree)
    return [jax.tree_util.keystr(path, simple=True, separator=".") for path, _ in paths]


def resolve(
    model: PyTree, free: Callable | Parameter | Sequence[Callable | Parameter], wind_count: int
) -> list[tuple[Slot, AbstractPrior | None]]:
    """The free leaves of a model in the order in which they are asked for, with their priors.

    **Raises:** `ValueError` for a leaf that is asked for twice or lies outside its bounds.
    """
    asked = [free] if isinstance(free, Parameter) or callable(free) else list(free)
    if not asked:
        raise ValueError(
            "Argument `free` must name at least one leaf, but is empty: there is nothing to fit."
        )
    leaves = jax.tree.leaves(model)
    names = leaf_names(model)
    chosen: list[tuple[int, Parameter, bool]] = []
    for one in asked:
        parameter = one if isinstance(one, Parameter) else Parameter(one)
        picked = locate(model, parameter.where, "free")
        chosen += [(index, parameter, len(picked) == 1) for index in picked]
    indices = [index for index, _, _ in chosen]
    for index in indices:
        if indices.count(index) > 1:
            raise ValueError(f"Argument `free` must pick each leaf once, but picks `{names[index]}` twice.")
    short = [names[index].rsplit(".", 1)[-1] for index in indices]
    slots = []
    for (index, parameter, alone), last in zip(chosen, short, strict=True):
        name = last if short.count(last) == 1 else names[index]
        if parameter.name is not None:
            name = parameter.name if alone else f"{parameter.name}.{last}"
        unit, bounds = VOCABULARY.get(last, ("", Real()))
        unit = unit if parameter.unit is None else parameter.unit
        bounds = bounds if parameter.bounds is None else parameter.bounds
        start = leaves[index]
        _check_inside(name, start, bounds)
        shape = ((wind_count,) if parameter.per_wind else ()) + np.shape(start)
        slots.append((Slot(name, unit, index, shape, bounds, parameter.per_wind), parameter.prior))
    return slots


def _check_inside(name: str, value: float | Array | np.ndarray, bounds: AbstractBounds) -> None:
    if not is_concrete(value):
        return
    if not bounds.contains(np.asarray(value, float)):
        raise ValueError(
            f"The starting value of `{name}` must be {bounds}, but is {np.array2string(np.asarray(value))}."
        )


def attach_priors(
    model: PyTree, slots: list[tuple[Slot, AbstractPrior | None]], priors: Sequence[AbstractPrior]
) -> list[tuple[Slot, AbstractPrior | None]]:
    """Give each prior of `fit(priors=…)` to its parameter.

    **Raises:** `ValueError` for a prior that names no leaf, or a leaf that is not free or has a prior
    already.
    """
    slots = list(slots)
    for prior in priors:
        if prior.where is None:
            raise ValueError(
                "A prior in `priors` must say of which leaf, for instance "
                "`Normal(1.0, 0.1, where=lambda m: m.choppiness)`, but its `where` is None."
            )
        for index in locate(model, prior.where, "where"):
            position = next((i for i, (slot, _) in enumerate(slots) if slot.index == index), None)
            if position is None:
                raise ValueError(
                    f"A prior must be on a free leaf, but `{leaf_names(model)[index]}` is fixed."
                )
            slot, present = slots[position]
            if present is not None:
                raise ValueError(f"`{slot.name}` must have one prior, but has two.")
            slots[position] = (slot, prior)
    # A function in a prior would make every fit a new program.
    return [(slot, None if prior is None else replace(prior, where=None)) for slot, prior in slots]
