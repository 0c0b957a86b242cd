"""Laws that are cubic above an onset of whitecapping."""

from typing import ClassVar

import jax.numpy as jnp

from ..._types import Scalar
from ...wind import Wind
from ._law import AbstractLaw, Constant


class Callaghan2008(AbstractLaw):
    """Two cubic branches from one cruise in the North-East Atlantic, up to strong winds.

    $$ W = \\min(3.18·10^{-5} (U − 3.70)³, \\; 4.82·10^{-6} (U + 1.98)³) $$

    The published branches overlap from 9.25 to 11.25 m/s; the lesser of the two changes branch where they
    cross, at 10.19 m/s, so that W is continuous. No whitecaps below 3.70 m/s.

    **Source:** Callaghan, de Leeuw, Cohen & O'Dowd 2008, Geophys. Res. Lett. 35, L23609.
    """

    name: ClassVar[str] = "Callaghan et al. 2008"
    citation: ClassVar[str] = "Callaghan et al. 2008, Geophys. Res. Lett. 35, L23609"
    range: ClassVar[tuple[float, float]] = (3.70, 23.09)

    low_coefficient: Constant = 3.18e-5
    low_onset: Constant = 3.70
    high_coefficient: Constant = 4.82e-6
    high_onset: Constant = -1.98

    def coverage(self, wind: Wind) -> Scalar:
        low = self.low_coefficient * jnp.maximum(wind.speed - self.low_onset, 0.0) ** 3
        high = self.high_coefficient * jnp.maximum(wind.speed - self.high_onset, 0.0) ** 3
        return jnp.minimum(low, high)


class StramskaPetelski2003Undeveloped(AbstractLaw):
    """Young seas of the north polar Atlantic.

    $$ W = 8.75·10^{-5} (U − 6.33)³ $$

    Zero below the onset. The upper end of the range is (unverified).

    **Source:** Stramska & Petelski 2003, J. Geophys. Res. 108(C3), 3086.
    """

    name: ClassVar[str] = "Stramska & Petelski 2003 (undeveloped)"
    citation: ClassVar[str] = "Stramska & Petelski 2003, J. Geophys. Res. 108(C3), 3086"
    range: ClassVar[tuple[float, float]] = (6.33, 18.0)

    coefficient: Constant = 8.75e-5
    onset: Constant = 6.33

    def coverage(self, wind: Wind) -> Scalar:
        return self.coefficient * jnp.maximum(wind.speed - self.onset, 0.0) ** 3


class StramskaPetelski2003Developed(AbstractLaw):
    """Developed seas of the north polar Atlantic.

    $$ W = 5.0·10^{-5} (U − 4.47)³ $$

    Zero below the onset. The upper end of the range is (unverified).

    **Source:** Stramska & Petelski 2003, J. Geophys. Res. 108(C3), 3086.
    """

    name: ClassVar[str] = "Stramska & Petelski 2003 (developed)"
    citation: ClassVar[str] = "Stramska & Petelski 2003, J. Geophys. Res. 108(C3), 3086"
    range: ClassVar[tuple[float, float]] = (4.47, 18.0)

    coefficient: Constant = 5.0e-5
    onset: Constant = 4.47

    def coverage(self, wind: Wind) -> Scalar:
        return self.coefficient * jnp.maximum(wind.speed - self.onset, 0.0) ** 3
