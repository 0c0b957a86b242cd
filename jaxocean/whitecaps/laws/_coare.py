"""The whitecap fraction inside the COARE bulk flux algorithm."""

from typing import ClassVar

import jax.numpy as jnp

from ..._types import Scalar
from ...wind import Wind
from ._law import AbstractLaw, Constant


class COARE36(AbstractLaw):
    """Whitecaps as the sea-spray and gas-transfer parts of COARE 3.6 use them.

    $$ W = 7.3·10^{-4} (U − 2)^{1.43} $$

    and 1e-5 below 2.1 m/s, where the algorithm has a step. The upper end of the range is that of the
    algorithm's flux data.

    **Source:** the COARE 3.6 bulk flux algorithm (Fairall et al. 2003; Edson et al. 2013).
    """

    name: ClassVar[str] = "COARE 3.6"
    citation: ClassVar[str] = "COARE 3.6 bulk flux algorithm, after Edson et al. 2013, J. Phys. Oceanogr. 43"
    range: ClassVar[tuple[float, float]] = (0.0, 25.0)

    coefficient: Constant = 7.3e-4
    exponent: Constant = 1.43
    onset: Constant = 2.0
    floor: Constant = 1e-5
    floor_speed: Constant = 2.1

    def coverage(self, wind: Wind) -> Scalar:
        above = wind.speed >= self.floor_speed
        excess = jnp.where(above, wind.speed - self.onset, 1.0)
        return jnp.where(above, self.coefficient * excess**self.exponent, self.floor)
