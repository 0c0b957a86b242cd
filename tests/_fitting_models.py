"""A model that compiles in no time, so that the machinery of fits can be tested by itself."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean._numerics import as_leaf

SPEEDS = np.arange(4.0, 21.0, 2.0)


class PowerSea(eqx.Module):
    """W = coefficient · U^exponent · threshold; the first and the last cannot be told apart."""

    coefficient: Float[Array, ""] = eqx.field(converter=as_leaf, default=1e-5)
    exponent: Float[Array, ""] = eqx.field(converter=as_leaf, default=3.0)
    threshold: Float[Array, ""] = eqx.field(converter=as_leaf, default=1.0)
    unseen: Float[Array, ""] = eqx.field(converter=as_leaf, default=1.0)
    nothing: Float[Array, ""] | None = None

    def log_coverage(self, wind):
        return (
            jnp.log(self.coefficient)
            + self.exponent * jnp.log(wind.speed)
            + jnp.log(jnp.abs(self.threshold))
            + 0.0 * jnp.floor(self.unseen)
        )


class WavySea(eqx.Module):
    """A coverage that waves with the wind: its rate has many valleys of cost, of which one is the deepest."""

    rate: Float[Array, ""] = eqx.field(converter=as_leaf, default=1.0)

    def log_coverage(self, wind):
        return -6 + jnp.sin(self.rate * wind.speed)
