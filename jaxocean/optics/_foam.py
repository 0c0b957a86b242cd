"""The light that foam scatters."""

import abc

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar, optional_leaf
from .._types import Scalar
from ._colour import reflectance_to_srgb
from .sky._colour_leaf import as_colour, check_colour

EFFECTIVE_REFLECTANCE = 0.22
"""Reflectance [-] of whitecaps in the visible, their ageing included (Koepke 1984)."""

PREMOZE_REFLECTANCE = 0.4
"""What Premože & Ashikhmin 2001 and Dupuy & Bruneton 2012 use: Koepke's efficiency factor, not his reflectance."""

FRESH_REFLECTANCE = 0.55
"""Reflectance [-] of fresh, dense foam in the visible (Whitlock et al. 1982, used by Koepke 1984)."""

# Wavelength [nm] and factor on the visible reflectance: Frouin, Schwindling & Deschamps 1996.
FROUIN = ((400.0, 1.0), (555.0, 1.0), (670.0, 0.889), (765.0, 0.760), (865.0, 0.645))


def frouin_colour() -> Float[Array, "3"]:
    """How foam's reflectance falls towards the red, as factors on linear sRGB under D65.

    **Returns:** (3,), from the factors 1 up to 555 nm, 0.889 at 670 nm, 0.760 at 765 nm and 0.645 at 865 nm, linear
    in between.

    **Source:** Frouin, Schwindling & Deschamps 1996, J. Geophys. Res. 101.
    """
    wavelengths, factors = np.array(FROUIN).T
    return reflectance_to_srgb(wavelengths, jnp.asarray(factors, jnp.result_type(float)))


class AbstractFoam(eqx.Module):
    """A Lambertian cover of bubbles: it scatters radiance R E/π in all directions."""

    @abc.abstractmethod
    def reflectance(self, age: Float[Array, "*b"] | None = None) -> Float[Array, "..."]:
        """R [-] in linear sRGB, (3,), or (*b, 3) for foam whose light depends on its `age` [s], (*b)."""


class Foam(AbstractFoam):
    """Foam of one reflectance, whatever its age.

    | leaf | unit | default | role |
    |---|---|---|---|
    | `brightness` | - | 0.22 | reflectance R in the visible; the default is Koepke's for whitecaps of all ages |
    | `colour` | - | 1 | factors on it in linear sRGB, (3,); `frouin_colour()` for the fall towards the red |

    **Source:** Koepke 1984, Appl. Opt. 23: 0.22. `Foam.premoze()` has the 0.4 of Dupuy & Bruneton 2012.
    """

    brightness: Scalar = eqx.field(converter=as_leaf, default=EFFECTIVE_REFLECTANCE)
    colour: Float[Array, "3"] = eqx.field(converter=as_colour, default=1.0)

    def __check_init__(self) -> None:
        check_scalar("brightness", self.brightness, "", minimum=0.0, maximum=1.0)
        check_colour("colour", self.colour, "")

    @classmethod
    def premoze(cls) -> "Foam":
        """Foam of reflectance 0.4: Koepke's efficiency factor taken for a reflectance, as in the paper."""
        return cls(brightness=PREMOZE_REFLECTANCE)

    def reflectance(self, age: Float[Array, "*b"] | None = None) -> Float[Array, "..."]:
        return self.brightness * self.colour


class AgeingFoam(AbstractFoam):
    """Foam that is bright when it is born and thins out.

    $$ R(t) = R_0 e^{-t/T}, \\quad \\overline{R} = R_0 \\frac{T}{T + τ} $$

    The mean is over the ages of foam whose area decays with the time τ. Koepke found that whitecaps of all ages
    reflect 0.4 ± 0.2 of what fresh foam does; the default T gives this 0.4 for the default τ. The exponential itself
    is a choice.

    | leaf | unit | default | role |
    |---|---|---|---|
    | `fresh` R₀ | - | 0.55 | reflectance at birth, in the visible |
    | `fading_time` T | s | 2.353 | time in which a parcel of foam loses its brightness |
    | `decay_time` τ | s | 3.53 | time in which the area of foam decays, for foam of unknown age |
    | `colour` | - | 1 | factors in linear sRGB, (3,); `frouin_colour()` for the fall towards the red |
    | `age` t | s | none | of all foam whose age is not told; none: the mean over the ages |

    **Source:** Koepke 1984, Appl. Opt. 23; τ of Monahan & Lu 1990, IEEE J. Oceanic Eng. 15.
    """

    fresh: Scalar = eqx.field(converter=as_leaf, default=FRESH_REFLECTANCE)
    fading_time: Scalar = eqx.field(converter=as_leaf, default=3.53 * 0.4 / 0.6)
    decay_time: Scalar = eqx.field(converter=as_leaf, default=3.53)
    colour: Float[Array, "3"] = eqx.field(converter=as_colour, default=1.0)
    age: Scalar | None = eqx.field(converter=optional_leaf, default=None)

    def __check_init__(self) -> None:
        check_scalar("age", self.age, "s", minimum=0.0)
        check_scalar("fresh", self.fresh, "", minimum=0.0, maximum=1.0)
        check_scalar("fading_time", self.fading_time, "s", positive=True)
        check_scalar("decay_time", self.decay_time, "s", positive=True)
        check_colour("colour", self.colour, "")

    def reflectance(self, age: Float[Array, "*b"] | None = None) -> Float[Array, "..."]:
        age = self.age if age is None else age
        if age is None:
            return self.fresh * self.fading_time / (self.fading_time + self.decay_time) * self.colour
        fading = self.fresh * jnp.exp(-jnp.maximum(age, 0.0) / self.fading_time.astype(age.dtype))
        return fading[..., None] * self.colour
