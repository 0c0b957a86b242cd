"""How much of a ray a smooth interface reflects."""

import abc

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Inexact

from ..._elementary import inverse_root
from ..._numerics import as_leaf, check_scalar, optional_leaf
from ..._types import Scalar


def fresnel(
    cos_incidence: Float[Array, "*b"], refractive_index: Inexact[Array, "..."] | float | complex
) -> Float[Array, "*b"]:
    """Reflectance of unpolarised light at a smooth interface.

    $$ F = \\tfrac12 \\frac{(g-c)^2}{(g+c)^2} \\left( 1 + \\frac{(c(g+c)-1)^2}{(c(g-c)+1)^2} \\right), \\quad
    g = \\sqrt{n^2 - 1 + c^2} $$

    and for a complex index, with g complex, the moduli of the two amplitudes. Light that comes from the denser side
    (n < 1) is reflected totally beyond the critical angle.

    **Arguments:**

    - `cos_incidence`: c = cosθ of the angle to the normal, (*b); clipped to 0 … 1.
    - `refractive_index`: n of the far side divided by n of the near side, above 0. An absorbing far side has a
      complex n with the extinction as its imaginary part, of either sign. Any shape that broadcasts with *b.

    **Returns:** the reflected fraction of the power, from 0 to 1.

    **Source:** Born & Wolf, Principles of Optics, §1.5 and §14.2.
    """
    c = jnp.clip(cos_incidence, 0.0, 1.0)
    n = jnp.asarray(refractive_index)
    if jnp.iscomplexobj(n):
        return _absorbing(c, n.astype(np.result_type(c.dtype, np.complex64)))
    n = n.astype(c.dtype)
    square = n * n - 1.0 + c * c
    passes = square > 0.0
    square = jnp.where(passes, square, 1.0)
    g = square * inverse_root(square)
    # One quotient for both polarisations, and one of the library: XLA writes it to memory, and so computes it once.
    perpendicular, parallel = c * (g + c) - 1.0, c * (g - c) + 1.0
    numerator = (g - c) * (g - c) * (perpendicular * perpendicular + parallel * parallel)
    denominator = (g + c) * (g + c) * parallel * parallel
    reflected = 0.5 * numerator / denominator
    return jnp.where(passes, reflected, 1.0)


def _absorbing(c: Float[Array, "*b"], n: Inexact[Array, "..."]) -> Float[Array, "*b"]:
    """The mean |r|² of both polarisations, n complex."""
    square = n * n
    g = jnp.sqrt(square - (1.0 - c * c).astype(n.dtype))
    cosine = c.astype(n.dtype)
    perpendicular = (cosine - g) / (cosine + g)
    parallel = (square * cosine - g) / (square * cosine + g)
    return 0.5 * (_squared_modulus(perpendicular) + _squared_modulus(parallel))


def _squared_modulus(z: Inexact[Array, "*b"]) -> Float[Array, "*b"]:
    return z.real * z.real + z.imag * z.imag


def schlick(cos_incidence: Float[Array, "*b"], normal_reflectance: Float[Array, "..."] | float):
    """The polynomial that stands in for Fresnel's equations in most renderers.

    $$ F = F_0 + (1 - F_0)(1 - c)^5 $$

    **Arguments:** `cos_incidence` c, (*b), clipped to 0 … 1; `normal_reflectance` F₀, 0.02 for sea water.

    **Returns:** the reflected fraction, (*b).

    **Source:** Schlick 1994, Comput. Graph. Forum 13.
    """
    rest = 1.0 - jnp.clip(cos_incidence, 0.0, 1.0)
    square = rest * rest
    normal = jnp.asarray(normal_reflectance).astype(rest.dtype)
    return normal + (1.0 - normal) * square * square * rest


class AbstractFresnel(eqx.Module):
    """How much a facet of the sea reflects, by the angle of incidence."""

    @abc.abstractmethod
    def __call__(self, cos_incidence: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """The reflected fraction at cosines of the angle of incidence."""


class ExactFresnel(AbstractFresnel):
    """Fresnel's equations for unpolarised light, see `fresnel`.

    | leaf | unit | default | role |
    |---|---|---|---|
    | `refractive_index` n | - | 1.34 | of sea water in the visible |
    | `extinction` κ | - | none | imaginary part of n, for what absorbs within a wavelength |
    """

    refractive_index: Scalar = eqx.field(converter=as_leaf, default=1.34)
    extinction: Scalar | None = eqx.field(converter=optional_leaf, default=None)

    def __check_init__(self) -> None:
        check_scalar("refractive_index", self.refractive_index, "", positive=True)
        check_scalar("extinction", self.extinction, "", minimum=0.0)

    def __call__(self, cos_incidence: Float[Array, "*b"]) -> Float[Array, "*b"]:
        if self.extinction is None:
            return fresnel(cos_incidence, self.refractive_index)
        extinction = self.extinction.astype(self.refractive_index.dtype)
        return fresnel(cos_incidence, jax.lax.complex(self.refractive_index, extinction))


class SchlickFresnel(AbstractFresnel):
    """Schlick's polynomial, see `schlick`.

    **Arguments:** `normal_reflectance` F₀ [-], differentiable, default 0.02.
    """

    normal_reflectance: Scalar = eqx.field(converter=as_leaf, default=0.02)

    def __check_init__(self) -> None:
        check_scalar("normal_reflectance", self.normal_reflectance, "", minimum=0.0, maximum=1.0)

    def __call__(self, cos_incidence: Float[Array, "*b"]) -> Float[Array, "*b"]:
        return schlick(cos_incidence, self.normal_reflectance)
