"""Which light looks white."""

import jax.numpy as jnp
from jaxtyping import Array, Float

LEAST = 1e-3
"""Least channel of the white, relative to its green: nearly red light is not turned into noise."""


def white_balance(radiance: Float[Array, "*b 3"], white: Float[Array, "3"]) -> Float[Array, "*b 3"]:
    """The light of a scene with the colour `white` turned into neutral grey.

    $$ L_i' = L_i \\frac{w_g}{w_i} $$

    in linear red, green and blue, as cameras do it: von Kries' rule in the primaries of the picture. Green is as bright
    as before.

    **Arguments:** `radiance`: linear, any unit; `white` w: the light on a white plate, in any unit, with a green
    above 0; differentiable.

    **Returns:** (*b, 3), in the unit of `radiance`.

    **Source:** von Kries 1902.
    """
    green = white[1]
    gains = green / jnp.maximum(white, LEAST * green)
    return radiance * gains.astype(radiance.dtype)
