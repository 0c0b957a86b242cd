"""Means and covariances of slopes and strain in a footprint."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class Moments(eqx.Module):
    """What a footprint sees of the slopes (∂η/∂x, ∂η/∂y) and of the strain (a, b, c), choppiness included.

    **Arguments:**

    - `slope_mean`, `strain_mean`: means [-].
    - `slope_covariance`, `strain_covariance`: symmetric, positive semi-definite up to rounding [-].
    """

    slope_mean: Float[Array, "*b 2"]
    slope_covariance: Float[Array, "*b 2 2"]
    strain_mean: Float[Array, "*b 3"]
    strain_covariance: Float[Array, "*b 3 3"]

    def sum_patterns(self) -> "Moments":
        """The moments of the sum of independent patterns, from moments whose last batch axis is the pattern."""
        return Moments(
            jnp.sum(self.slope_mean, axis=-2),
            jnp.sum(self.slope_covariance, axis=-3),
            jnp.sum(self.strain_mean, axis=-2),
            jnp.sum(self.strain_covariance, axis=-3),
        )


def pair_products(x: Float[Array, "*b n"]) -> Float[Array, "*b products"]:
    """x xᵀ of two or three numbers as its three or six different elements: the squares, then the products
    (xy) or (xy, yz, zx)."""
    count = x.shape[-1]
    others = x[..., :1] * x[..., 1:] if count == 2 else x * jnp.roll(x, -1, axis=-1)
    return jnp.concatenate([x * x, others], axis=-1)


def symmetric_matrix(elements: Float[Array, "*b products"]) -> Float[Array, "*b n n"]:
    """The symmetric matrix whose different elements stand as in `pair_products`."""
    if elements.shape[-1] == 3:
        xx, yy, xy = (elements[..., i] for i in range(3))
        rows = [[xx, xy], [xy, yy]]
    else:
        xx, yy, zz, xy, yz, zx = (elements[..., i] for i in range(6))
        rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
    return jnp.stack([jnp.stack(row, axis=-1) for row in rows], axis=-2)
