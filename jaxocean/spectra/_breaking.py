"""The breaking wavenumber: which waves the foam sees."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from .._types import ScalarLike


def breaking_filter(
    wavenumber: Float[Array, "*k"], breaking_wavenumber: ScalarLike | None
) -> Float[Array, "*k"]:
    """The low-pass of the strain that decides about breaking.

    $$ G(k) = x²(3 − 2x), \\quad x = \\min(\\max(2(1 − k/k_b), 0), 1) $$

    It is 1 up to k_b/2, falls smoothly and is exactly 0 from k_b on, so that whitecap coverage does not depend on
    the grid as long as the grid resolves k_b.

    **Arguments:** `wavenumber` k [rad/m]; `breaking_wavenumber` k_b [rad/m], or None for no low-pass.

    **Returns:** the factor on amplitudes [-]; variances take its square.
    """
    if breaking_wavenumber is None:
        return jnp.ones_like(wavenumber)
    x = jnp.clip(2 * (1 - wavenumber / breaking_wavenumber), 0.0, 1.0)
    return x * x * (3 - 2 * x)
