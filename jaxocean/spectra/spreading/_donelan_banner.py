"""Spreading by a hyperbolic secant."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._spreading import AbstractSpreading, WavePeak

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)


class DonelanBanner(AbstractSpreading):
    """A beam whose width was measured up to 1.6 f_p by Donelan and beyond by Banner.

    $$ D(θ) = \\frac{β}{2 \\tanh(βπ)} \\mathrm{sech}^2(βθ), \\quad |θ| ≤ π $$

    with r = f/f_p and β = 2.61 r^1.3 below 0.95 (held below 0.56), 2.28 r^−1.3 up to 1.6, and
    10^(−0.4 + 0.8393 exp(−0.567 ln r²)) above. The first two meet at 0.949, where the change is made.

    **Source:** Donelan, Hamilton & Hui 1985, Phil. Trans. R. Soc. A 315, 509–562; Banner 1990, J. Phys.
    Oceanogr. 20, 966–984.
    """

    def density(self, offset: Float[Array, "*k"], wave: WavePeak) -> Float[Array, "*k"]:
        angle = jnp.mod(offset + jnp.pi, 2 * jnp.pi) - jnp.pi
        return _beam(angle, self._parameter(wave))

    def harmonics(self, wave: WavePeak) -> tuple[Float[Array, "*k"], Float[Array, "*k"]]:
        # The half-circle is free of the kink at θ = ±π.
        beta = self._parameter(wave)[..., None]
        angle = jnp.asarray(0.5 * np.pi * (NODES + 1), beta.dtype)
        weighted = _beam(angle, beta) * jnp.asarray(np.pi * WEIGHTS, beta.dtype)
        return (
            jnp.sum(weighted * jnp.cos(2 * angle), axis=-1),
            jnp.sum(weighted * jnp.cos(4 * angle), axis=-1),
        )

    def _parameter(self, wave: WavePeak) -> Float[Array, "*k"]:
        ratio = jnp.maximum(wave.frequency_ratio, 0.56)
        near = jnp.minimum(2.61 * ratio**1.3, 2.28 * ratio**-1.3)
        far = 10.0 ** (-0.4 + 0.8393 * jnp.exp(-0.567 * jnp.log(ratio**2)))
        return jnp.where(ratio <= 1.6, near, far)


def _beam(angle: Float[Array, "..."], beta: Float[Array, "..."]) -> Float[Array, "..."]:
    return 0.5 * beta / jnp.tanh(beta * jnp.pi) / jnp.cosh(beta * angle) ** 2
