"""Numerical helpers that every room needs: leaves, safe derivatives at singular points, quadrature rules."""

from typing import TypeVar

import jax
import jax.core
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._types import FloatLike

Tree = TypeVar("Tree")


def as_leaf(value: FloatLike) -> Float[Array, "..."]:
    """Turn a number into a floating-point array; a floating-point input keeps its precision."""
    array = jnp.asarray(value)
    floating = jnp.issubdtype(array.dtype, jnp.floating)
    # Naming the type makes it strong: a weakly typed leaf would compile everything a second time.
    return array.astype(array.dtype if floating else jnp.result_type(float))


def optional_leaf(value: FloatLike | None) -> Float[Array, "..."] | None:
    """`as_leaf` that passes None on."""
    return None if value is None else as_leaf(value)


SLACK = 1e-3
"""By how much [rad] an angle may pass straight up or down, and is taken for just that."""


UPRIGHT = 0.5 * np.pi + 1e-6
"""Straight up [rad], in whatever precision."""


def as_upright_angle(value: FloatLike) -> Float[Array, "..."]:
    """`as_leaf` of an angle from −π/2 to π/2: one that is beyond by less than `SLACK`, as 1.5708 is, is the end."""
    leaf = as_leaf(value)
    upright = np.asarray(0.5 * np.pi, leaf.dtype)
    beyond = (jnp.abs(leaf) > upright) & (jnp.abs(leaf) < upright + SLACK)
    return jnp.where(beyond, jnp.where(leaf > 0, upright, -upright), leaf)


def is_concrete(value: object) -> bool:
    """Whether a value is known now, that is: not a tracer inside jit, vmap or grad."""
    return not isinstance(value, jax.core.Tracer)


def check_scalar(
    name: str,
    value: Float[Array, "..."] | None,
    unit: str,
    *,
    minimum: float | None = None,
    maximum: float | None = None,
    positive: bool = False,
) -> None:
    """Raise one clear sentence if a leaf is not a finite scalar inside its range; tracers pass.

    **Raises:** `ValueError` that names the argument, what it must be and what it is.
    """
    if value is None or not is_concrete(value) or not isinstance(value, (jax.Array, np.ndarray)):
        return
    if value.ndim != 0:
        raise ValueError(
            f"Argument `{name}` must be one number, but has shape {value.shape}: "
            "objects are unbatched, batch them with `equinox.filter_vmap`."
        )
    number = float(value)
    where = f" {unit}" if unit else ""
    if not np.isfinite(number):
        raise ValueError(f"Argument `{name}` must be finite, but is {number}{where}.")
    if positive and number <= 0:
        raise ValueError(f"Argument `{name}` must be greater than 0{where}, but is {number:g}.")
    if minimum is not None and number < minimum:
        raise ValueError(f"Argument `{name}` must be at least {minimum:g}{where}, but is {number:g}.")
    if maximum is not None and number > maximum:
        raise ValueError(f"Argument `{name}` must be at most {maximum:g}{where}, but is {number:g}.")


def check_kind(name: str, value: object, kind: type | tuple[type, ...], example: str) -> None:
    """Raise one clear sentence if an argument is not the kind of object that it must be.

    **Raises:** `ValueError` that names the argument, an example of what it must be, and what it is.
    """
    if not isinstance(value, kind):
        shown = repr(value) if isinstance(value, (str, int, float)) else f"a {type(value).__name__}"
        shown = f"the class {value.__name__} itself" if isinstance(value, type) else shown
        raise ValueError(f"Argument `{name}` must be {example}, but is {shown}.")


def check_last_axis(name: str, shape: tuple[int, ...], size: int, meaning: str) -> None:
    """Raise one clear sentence if the last axis of an array is not of this size."""
    if not shape or shape[-1] != size:
        raise ValueError(f"Argument `{name}` must hold {meaning} on its last axis, but has shape {shape}.")


def safe_sqrt(x: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """√max(x, 0) whose derivative at x ≤ 0 is 0 instead of infinity."""
    positive = x > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, x, 1.0)), 0.0)


def safe_norm(x: Float[Array, "*s"], y: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """√(x² + y²) whose derivative at the origin is 0 instead of NaN."""
    return safe_sqrt(x * x + y * y)


def safe_divide(x: Float[Array, "*s"], y: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """x / y, and 0 with derivative 0 where y = 0."""
    nonzero = y != 0
    return jnp.where(nonzero, x / jnp.where(nonzero, y, 1.0), 0.0)


def safe_angle(x: Float[Array, "*s"], y: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """The direction atan2(y, x) [rad], 0 with derivative 0 at the origin."""
    away = (x != 0) | (y != 0)
    return jnp.where(away, jnp.arctan2(jnp.where(away, y, 0.0), jnp.where(away, x, 1.0)), 0.0)


@jax.custom_jvp
def largest(values: Float[Array, "*b y x"]) -> Float[Array, "*b"]:
    """max over the last two axes, whose derivative is that of one of the largest.

    JAX looks for the largest by comparing all with the maximum. Where XLA computes `values` twice, with two roundings,
    none is equal to it, and the derivative is 0/0.
    """
    return jnp.max(values, axis=(-2, -1))


@largest.defjvp
def _largest_jvp(primals, tangents):
    values, change = (each[0].reshape(*each[0].shape[:-2], -1) for each in (primals, tangents))
    where = jnp.argmax(values, axis=-1)[..., None]
    found, moved = (jnp.take_along_axis(each, where, axis=-1)[..., 0] for each in (values, change))
    return found, moved


def logarithmic_nodes(
    lower: float, upper: float, *, panels: int | None = None, order: int = 16
) -> tuple[np.ndarray, np.ndarray]:
    """Composite Gauss–Legendre rule for ∫ f(k) dk, uniform in log k.

    **Arguments:** `lower`, `upper`: 0 < lower < upper; `panels`, `order`: the rule has their product of
    nodes; by default there are two panels per factor e, enough for the peak of a JONSWAP spectrum.

    **Returns:** nodes and weights, float64, with the Jacobian dk = k d(log k) in the weights.
    """
    if panels is None:
        panels = max(2, int(np.ceil(2 * np.log(upper / lower))))
    x, w = np.polynomial.legendre.leggauss(order)
    edges = np.linspace(np.log(lower), np.log(upper), panels + 1)
    half = 0.5 * np.diff(edges)[:, None]
    centre = 0.5 * (edges[1:] + edges[:-1])[:, None]
    nodes = np.exp(centre + half * x).ravel()
    return nodes, (half * w).ravel() * nodes


def periodic_nodes(count: int) -> tuple[np.ndarray, float]:
    """The trapezoidal rule on the circle: `count` angles [rad] and their common weight 2π/count.

    An even count holds with each angle its opposite, so that a spectrum that is cut to a half-plane integrates
    exactly like the symmetric one.
    """
    return np.arange(count) * (2.0 * np.pi / count), 2.0 * np.pi / count


def leaf_dtype(*trees: object) -> jnp.dtype:
    """The common floating-point type of all leaves, to which constants of a computation are cast."""
    leaves = [
        leaf
        for leaf in jax.tree.leaves(trees)
        if hasattr(leaf, "dtype") and jnp.issubdtype(leaf.dtype, jnp.floating)
    ]
    return jnp.result_type(*leaves) if leaves else jnp.result_type(float)


def with_dtype(tree: Tree, dtype: jnp.dtype) -> Tree:
    """The same with every array of real numbers in one floating-point type."""

    def one(leaf):
        real = isinstance(leaf, jax.Array) and jnp.issubdtype(leaf.dtype, jnp.floating)
        return leaf.astype(dtype) if real else leaf

    return jax.tree.map(one, tree)
