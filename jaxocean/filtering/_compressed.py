"""A pyramid in half precision whose covariances keep their digits."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._numerics import safe_sqrt
from ._moment_pyramid import MomentPyramid
from ._moments import pair_products


class CompressedMoments(eqx.Module):
    """Means of every level, and covariances **within** the texels of every level but the first, where they are 0.

    Differences of products are taken before they are rounded, and each pattern is scaled to unit variance, so that a
    half-precision covariance is right to its own last digit. It is smaller than a pyramid of products and is meant for
    keeping and sending: `expand` makes a `MomentPyramid` of it.

    **Arguments:**

    - `means`: of (a, b, c, ∂η/∂x, ∂η/∂y), scaled.
    - `covariances`: the six of the strain and the three of the slopes, scaled, without level 0.
    - `scale`: standard deviations of the five fields in each pattern [-], in full precision.
    """

    sizes: tuple[float, ...] = eqx.field(static=True)
    resolution: int = eqx.field(static=True)
    means: Float[Array, "pattern texel 5"]
    covariances: Float[Array, "pattern texel_above 9"]
    scale: Float[Array, "pattern 5"]

    @classmethod
    def from_pyramid(cls, pyramid: MomentPyramid, dtype: jnp.dtype | type) -> "CompressedMoments":
        """Compress a pyramid to float16, bfloat16 or any other type."""
        means = pyramid.means[..., :5]
        raw = jnp.concatenate([pyramid.products, pyramid.means[..., 5:]], axis=-1)
        covariances = (raw - _products(means))[:, pyramid.resolution**2 :]
        squares = jnp.concatenate([pyramid.products[:, -1, :3], pyramid.means[:, -1, 5:7]], axis=-1)
        deviation = safe_sqrt(squares)
        scale = jnp.where(deviation > 0, deviation, 1.0)
        return cls(
            pyramid.sizes,
            pyramid.resolution,
            (means / scale[:, None]).astype(dtype),
            (covariances / _products(scale)[:, None]).astype(dtype),
            scale,
        )

    @property
    def nbytes(self) -> int:
        """Bytes of everything that is stored."""
        return self.means.nbytes + self.covariances.nbytes + self.scale.nbytes

    def expand(self) -> MomentPyramid:
        """The pyramid for look-ups, in the type of `scale`."""
        dtype = self.scale.dtype
        means = self.means.astype(dtype) * self.scale[:, None]
        covariances = self.covariances.astype(dtype) * _products(self.scale)[:, None]
        first = self.resolution**2
        products = _products(means) + jnp.pad(covariances, ((0, 0), (first, 0), (0, 0)))
        return MomentPyramid(
            self.sizes,
            self.resolution,
            jnp.concatenate([means, products[..., 6:]], axis=-1),
            products[..., :6],
        )


def _products(fields: Float[Array, "*b 5"]) -> Float[Array, "*b 9"]:
    """The six products of the strain and the three of the slopes."""
    return jnp.concatenate([pair_products(fields[..., :3]), pair_products(fields[..., 3:])], axis=-1)
