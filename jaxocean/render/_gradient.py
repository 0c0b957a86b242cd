"""Gradients of a number that is made from pictures, by the mode that is faster for so many parameters."""

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PyTree

from .._numerics import as_leaf

MOST_FORWARD = 4
"""Numbers up to which forward mode is used on a CPU: 320 × 180 pixels took about 0.26 s of processor time more for each
number there, and 1.3 s more for any number of them in reverse mode."""

MOST_FORWARD_WIDE = 64
"""The same on an accelerator, which adds to texels slowly: on an H100 ten numbers take 9 ms forward and 112 ms back."""


def value_and_gradient(
    loss: Callable[..., Float[Array, ""]], *, forward: bool | None = None
) -> Callable[..., tuple[Float[Array, ""], PyTree]]:
    """The function (parameters, *arguments) → (loss, its gradient with respect to the parameters), compiled.

    Reverse mode takes the same time for any number of parameters, but walks back through each look-up of each pixel;
    forward mode takes time in proportion to their number. Up to 4 numbers in all leaves together go forward on a CPU,
    and up to 64 on an accelerator; more go in reverse.

    ```python
    look = jo.render.value_and_gradient(lambda ocean, picture: jnp.mean((jo.render.render(ocean, …) - picture) ** 2))
    value, gradient = look(ocean, picture)
    ```

    **Arguments:**

    - `loss`: from (parameters, *arguments) to one real number.
    - `forward`: True or False to choose the mode instead.

    **Returns:** a function of `parameters`, a tree of which every floating-point leaf is differentiated, and of further
    arguments, which are not. Its gradient is such a tree, with None for what is no floating-point leaf.

    **Raises:** `ValueError`, when called, if there is nothing to differentiate, or for complex numbers in forward mode.
    """

    @eqx.filter_jit
    def compute(parameters: PyTree, *arguments: Any) -> tuple[Float[Array, ""], PyTree]:
        free, fixed = eqx.partition(parameters, eqx.is_inexact_array)

        def of_free(free: PyTree) -> Float[Array, ""]:
            return loss(eqx.combine(free, fixed), *arguments)

        goes_forward = _goes_forward(jax.tree.leaves(free)) if forward is None else forward
        return (_forward if goes_forward else jax.value_and_grad)(of_free)(free)

    def value_and_gradient_of(parameters: PyTree, *arguments: Any) -> tuple[Float[Array, ""], PyTree]:
        parameters = jax.tree.map(lambda x: as_leaf(x) if isinstance(x, float) else x, parameters)
        leaves = [leaf for leaf in jax.tree.leaves(parameters) if eqx.is_inexact_array(leaf)]
        if not leaves:
            raise ValueError("Argument `parameters` must hold floating-point numbers, but there are none.")
        if forward and any(jnp.iscomplexobj(leaf) for leaf in leaves):
            raise ValueError("Argument `forward` must not be True for complex parameters, but is.")
        return compute(parameters, *arguments)

    return value_and_gradient_of


def _goes_forward(leaves: list[Array]) -> bool:
    """Whether forward mode is the faster one; complex numbers, such as a sea's noise, come in masses."""
    most = MOST_FORWARD if jax.default_backend() == "cpu" else MOST_FORWARD_WIDE
    few = sum(leaf.size for leaf in leaves) <= most
    return few and not any(jnp.iscomplexobj(leaf) for leaf in leaves)


def _forward(loss: Callable[[PyTree], Float[Array, ""]]) -> Callable[[PyTree], tuple]:
    def value_and_gradient_of(parameters: PyTree) -> tuple[Float[Array, ""], PyTree]:
        leaves, structure = jax.tree.flatten(parameters)
        ends = np.cumsum([0] + [leaf.size for leaf in leaves])
        axes = np.eye(ends[-1])
        directions = [
            jnp.asarray(axes[:, start:end].reshape(-1, *leaf.shape), leaf.dtype)
            for leaf, start, end in zip(leaves, ends[:-1], ends[1:], strict=True)
        ]

        def along(direction: list[Array]) -> tuple[Array, Array]:
            return jax.jvp(loss, (parameters,), (jax.tree.unflatten(structure, direction),))

        value, slopes = jax.vmap(along, out_axes=(None, 0))(directions)
        parts = [
            slopes[start:end].reshape(leaf.shape).astype(leaf.dtype)
            for leaf, start, end in zip(leaves, ends[:-1], ends[1:], strict=True)
        ]
        return value, jax.tree.unflatten(structure, parts)

    return value_and_gradient_of
