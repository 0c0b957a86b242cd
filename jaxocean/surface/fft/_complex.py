"""Products of real and complex arrays, spelled out: strict promotion refuses to mix them."""

import jax
from jaxtyping import Array, Complex, Float


def scale(z: Complex[Array, "..."], factor: Float[Array, "..."]) -> Complex[Array, "..."]:
    """z times a real factor, two real products instead of a complex one."""
    return jax.lax.complex(z.real * factor, z.imag * factor)


def turn(z: Complex[Array, "*s"]) -> Complex[Array, "*s"]:
    """i z, a quarter turn."""
    return jax.lax.complex(-z.imag, z.real)
