"""How much of the foam in a footprint a viewer sees."""

import abc

import equinox as eqx
from jaxtyping import Array, Float

from .._numerics import as_leaf, check_scalar
from .._types import Scalar


class AbstractFoamView(eqx.Module):
    """From the coverage of the sea to the coverage of what is seen of it."""

    @abc.abstractmethod
    def __call__(self, coverage: Float[Array, "*b"], hidden: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """The share of foam in the visible area.

        **Arguments:** `coverage` W in 0 … 1, (*b): the share of projected (horizontal) area; `hidden` Λ of the view,
        see `smith_lambda`. **Returns:** a share in 0 … 1, (*b); W at Λ = 0.
        """


class EvenFoam(AbstractFoamView):
    """Foam lies on facets of all slopes and heights alike: waves hide it as they hide water.

    $$ W_V = W $$
    """

    def __call__(self, coverage: Float[Array, "*b"], hidden: Float[Array, "*b"]) -> Float[Array, "*b"]:
        return coverage


class CrestFoam(AbstractFoamView):
    """Foam lies high, where fewer waves hide it: at grazing angles there seems to be more of it.

    $$ W_V = \\frac{g W}{1 - W + g W}, \\quad g = \\frac{κ (1 + Λ)}{κ + Λ} $$

    On Smith's surface a facet that is higher than the share χ of the others is seen with the chance χ^Λ. For foam
    whose χ has the density κ χ^{κ−1} this is κ/(κ + Λ) on average, against 1/(1 + Λ) for all facets. κ = 1 is
    `EvenFoam`; for κ < 1 foam gathers in the troughs.

    **Arguments:** `preference` κ [-], above 0: the mean of χ is κ/(κ + 1).

    **Source:** our own, from the height-dependent masking of Smith 1967, IEEE Trans. Antennas Propag. 15.
    """

    preference: Scalar = eqx.field(converter=as_leaf)

    def __check_init__(self) -> None:
        check_scalar("preference", self.preference, "", positive=True)

    def __call__(self, coverage: Float[Array, "*b"], hidden: Float[Array, "*b"]) -> Float[Array, "*b"]:
        preference = self.preference.astype(coverage.dtype)
        gain = preference * (1.0 + hidden) / (preference + hidden)
        return gain * coverage / (1.0 - coverage + gain * coverage)


class FlatFoam(AbstractFoamView):
    """Foam lies flat on the mean facet, at all heights: it turns its edge to a low viewer, water's facets do not.

    $$ W_V = \\frac{W}{1 + Λ} $$

    This is what the last section of Dupuy & Bruneton suggests: their coverage times the masking function. Towards the
    horizon all foam disappears.

    **Source:** Dupuy & Bruneton 2012, §5; Ross, Dion & Potvin 2005.
    """

    def __call__(self, coverage: Float[Array, "*b"], hidden: Float[Array, "*b"]) -> Float[Array, "*b"]:
        return coverage / (1.0 + hidden)
