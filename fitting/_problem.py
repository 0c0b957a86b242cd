"""A fit as a vector of residuals of a vector of numbers: everything between the user's words and a solver."""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PyTree

from jaxocean._numerics import is_concrete, safe_sqrt

from ._bounds import Interval
from ._model import AbstractPreparedModel
from ._parameters import Parameter, Slot, attach_priors, locate, resolve, split
from ._priors import AbstractPrior
from ._target import AbstractTarget, FreeScatter

LEAST_SCATTER = 1e-3
"""A fitted scatter stays above this fraction of its start: a model through all points would send it to 0."""

MOST_SCATTER = 100.0
"""And below this multiple."""


class Predictions(NamedTuple):
    """For each target: predicted and observed numbers and their scatter, in the target's transformed unit."""

    predicted: tuple[Float[Array, " n"], ...]
    observed: tuple[Float[Array, " n"], ...]
    scatter: tuple[Float[Array, "..."], ...]


class Problem(eqx.Module):
    """Model, targets, priors and which leaves are free; the free numbers are one flat vector."""

    tree: tuple[PyTree, tuple[AbstractTarget, ...]]
    priors: tuple[AbstractPrior | None, ...]
    slots: tuple[Slot, ...] = eqx.field(static=True)
    rows: tuple[tuple[int, ...], ...] = eqx.field(static=True)
    split: bool = eqx.field(static=True)

    def start(self) -> Float[Array, " p"]:
        """The numbers that the model and its targets come with."""
        leaves = jax.tree.leaves(self.tree)
        parts = [jnp.broadcast_to(jnp.asarray(leaves[slot.index]), slot.shape).ravel() for slot in self.slots]
        return jnp.concatenate(parts)

    def constrain(self, free: Float[Array, " p"]) -> Float[Array, " p"]:
        """Numbers inside their bounds from a point in free space."""
        return self._each(free, lambda slot, x: slot.bounds.constrain(x))

    def unconstrain(self, values: Float[Array, " p"]) -> Float[Array, " p"]:
        """The point in free space of numbers inside their bounds."""
        return self._each(values, lambda slot, x: slot.bounds.unconstrain(x))

    def prepare(self) -> tuple[PyTree, ...] | None:
        """The costly part of the model at each target's winds, or None where free leaves change it."""
        model, targets = self.tree
        if not self.split:
            return None
        return tuple(jax.vmap(model.prepare)(target.winds) for target in targets)

    def predictions(self, values: Float[Array, " p"], states: tuple[PyTree, ...] | None) -> Predictions:
        """What the model says where the targets look."""
        shared = self._with(values, None)[1]
        predicted = []
        for t, target in enumerate(shared):
            rows = jnp.asarray(np.asarray(self.rows[t]))
            state = None if states is None else states[t]
            predicted.append(
                jax.vmap(lambda wind, row, known, t=t: self._predict(values, t, wind, row, known))(
                    target.winds, rows, state
                )
            )
        observed = tuple(target.observed() for target in shared)
        return Predictions(tuple(predicted), observed, tuple(target.scatter.value for target in shared))

    def data_residuals(self, predictions: Predictions) -> Float[Array, " n"]:
        """(predicted − observed)/scatter of all targets, one behind the other."""
        return jnp.concatenate([(p - o) / s for p, o, s in zip(*predictions, strict=True)])

    def prior_residuals(self, values: Float[Array, " p"]) -> Float[Array, " m"]:
        """Distances from the priors in standard deviations."""
        parts = [
            prior.residual(part).ravel()
            for prior, part in zip(self.priors, split(self.slots, values), strict=True)
            if prior is not None
        ]
        return jnp.concatenate(parts) if parts else jnp.zeros(0, values.dtype)

    def residuals(self, values: Float[Array, " p"], predictions: Predictions) -> Float[Array, " r"]:
        """All residuals: those of the data, then priors, then scatters.

        Half their sum of squares is the negative log likelihood, up to a constant.

        A free scatter σ of n data adds n log σ, written as ½(√(2n log(σ/σ_least)))² so that a least-squares
        solver minimises it too.
        """
        rows = [self.data_residuals(predictions), self.prior_residuals(values)]
        for slot, part in zip(self.slots, split(self.slots, values), strict=True):
            if slot.is_scatter:
                assert isinstance(slot.bounds, Interval)
                n = self.scatter_size(slot)
                rows.append(safe_sqrt(2 * n * jnp.log(part / slot.bounds.lower)).ravel())
        return jnp.concatenate(rows)

    @property
    def data_size(self) -> int:
        """How many data all targets have."""
        return sum(target.size for target in self.tree[1])

    @property
    def prior_size(self) -> int:
        """How many numbers have a prior."""
        pairs = zip(self.slots, self.priors, strict=True)
        return sum(slot.size for slot, prior in pairs if prior is not None)

    def scatter_size(self, slot: Slot) -> int:
        """How many data share a fitted scatter."""
        model, targets = self.tree
        index = len(jax.tree.leaves(model))
        for target in targets:
            count = len(jax.tree.leaves(target))
            if index <= slot.index < index + count:
                return target.size
            index += count
        raise ValueError(f"`{slot.name}` belongs to no target.")

    def _predict(self, values, t, wind, row, state):
        model, targets = self._with(values, row)
        return targets[t].predict(model if state is None else model.prepared(state), wind)

    def _with(self, values: Float[Array, " p"], row: Any) -> tuple[PyTree, tuple[AbstractTarget, ...]]:
        """Model and targets with their numbers put in; per-wind parameters give those of this row."""
        leaves, treedef = jax.tree.flatten(self.tree)
        for slot, part in zip(self.slots, split(self.slots, values), strict=True):
            leaves[slot.index] = part[0 if row is None else row] if slot.per_wind else part
        return treedef.unflatten(leaves)

    def _each(self, values: Float[Array, " p"], change: Callable) -> Float[Array, " p"]:
        parts = zip(self.slots, split(self.slots, values), strict=True)
        return jnp.concatenate([change(slot, part).ravel() for slot, part in parts])


def wind_rows(targets: Sequence[AbstractTarget]) -> tuple[tuple[float, ...], tuple[tuple[int, ...], ...]]:
    """All wind speeds [m/s] of the targets in order, and for each target which of them its data have."""
    speeds = [np.asarray(target.winds.speed, float) for target in targets]
    unique, inverse = np.unique(np.concatenate(speeds), return_inverse=True)
    ends = np.cumsum([0] + [len(one) for one in speeds])
    rows = [tuple(int(i) for i in inverse[a:b]) for a, b in itertools.pairwise(ends)]
    return tuple(float(speed) for speed in unique), tuple(rows)


def make_problem(
    model: PyTree,
    free: Callable | Parameter | Sequence[Callable | Parameter],
    targets: tuple[AbstractTarget, ...],
    priors: Sequence[AbstractPrior],
    names: list[str],
) -> tuple[Problem, tuple[float, ...]]:
    """The problem that a user's words mean, and its wind speeds [m/s] (none where they are not known yet)."""
    traced = any(not is_concrete(target.winds.speed) for target in targets)
    if traced:
        # Which winds are alike cannot be known: every datum is its own wind.
        ends = np.cumsum([0] + [target.size for target in targets])
        rows = tuple(tuple(range(a, b)) for a, b in itertools.pairwise(ends))
        speeds = tuple(math.nan for _ in range(int(ends[-1])))
    else:
        speeds, rows = wind_rows(targets)
    slots = attach_priors(model, resolve(model, free, len(speeds)), list(priors))
    slots += [(slot, None) for slot in _scatter_slots(model, targets, names)]
    split = False
    if isinstance(model, AbstractPreparedModel):
        costly = set(_indices(model, lambda m: m.preparation_leaves()))
        split = costly.isdisjoint(slot.index for slot, _ in slots)
    return (
        Problem((model, targets), tuple(p for _, p in slots), tuple(s for s, _ in slots), rows, split),
        speeds,
    )


def _scatter_slots(model: PyTree, targets: tuple[AbstractTarget, ...], names: list[str]) -> list[Slot]:
    slots = []
    for t, target in enumerate(targets):
        if isinstance(target.scatter, FreeScatter):
            (index,) = locate((model, targets), lambda tree, t=t: tree[1][t].scatter.value, "scatter")
            start = target.scatter.value
            start = 1.0 if not is_concrete(start) else float(start)
            name = "scatter" if len(targets) == 1 else f"scatter of {names[t]}"
            bounds = Interval(LEAST_SCATTER * start, MOST_SCATTER * start)
            slots.append(Slot(name, target.unit, index, (), bounds, per_wind=False, is_scatter=True))
    return slots


def _indices(tree: PyTree, where: Callable) -> list[int]:
    """Positions among the flattened leaves of `tree` of everything below what `where` returns."""
    leaves, treedef = jax.tree.flatten(tree)
    return jax.tree.leaves(where(treedef.unflatten(list(range(len(leaves))))))
