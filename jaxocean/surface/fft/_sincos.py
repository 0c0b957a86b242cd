"""Sine and cosine of a phase in turns, cheap enough for every wave of every frame."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

# Minimax polynomials in z = x² on |x| ≤ ½, by Remez exchange in float64: sin(πx)/x to 3e-9, cos(πx) to 2e-10.
SINE = (3.14159258, -5.1677069, 2.55003164, -0.59804645, 0.07722225)
COSINE = (1.0, -4.93480214, 4.05870916, -1.33521206, 0.23493756, -0.02439672)


@jax.custom_jvp
def sincos_turns(x: Float[Array, "*s"]) -> tuple[Float[Array, "*s"], Float[Array, "*s"]]:
    """sin 2πx and cos 2πx for a phase x in turns, |x| ≤ ½.

    In float32 both come from sine and cosine of the half angle by polynomials, which vectorise, and are
    good to 4e-7; in float64 they are those of the library. Derivatives are the exact ones, of any order.
    """
    if x.dtype != jnp.float32:
        return jnp.sin(2 * np.pi * x), jnp.cos(2 * np.pi * x)
    z = x * x
    sine = x * _horner(SINE, z)
    cosine = _horner(COSINE, z)
    return 2 * sine * cosine, (cosine - sine) * (cosine + sine)


@sincos_turns.defjvp
def _derivative(primals, tangents):
    (x,), (rate,) = primals, tangents
    sine, cosine = sincos_turns(x)
    turning = 2 * np.pi * rate
    return (sine, cosine), (cosine * turning, -sine * turning)


def _horner(coefficients: tuple[float, ...], z: Float[Array, "*s"]) -> Float[Array, "*s"]:
    total = jnp.full_like(z, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        total = total * z + coefficient
    return total
