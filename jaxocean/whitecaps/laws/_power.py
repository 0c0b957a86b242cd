"""Power laws of later cruises and of satellites."""

from typing import ClassVar

from ..._types import Scalar
from ...wind import Wind
from ._law import AbstractLaw, Constant


class Salisbury2013(AbstractLaw):
    """What a microwave radiometer sees at 37 GHz: active and decaying foam, thin layers included.

    $$ W = 3.97·10^{-4} U^{1.59} $$

    The range is (unverified).

    **Source:** Salisbury, Anguelova & Brooks 2013, J. Geophys. Res. Oceans 118.
    """

    name: ClassVar[str] = "Salisbury et al. 2013 (37 GHz)"
    citation: ClassVar[str] = "Salisbury, Anguelova & Brooks 2013, J. Geophys. Res. Oceans 118, 6201-6222"
    range: ClassVar[tuple[float, float]] = (2.0, 20.0)

    coefficient: Constant = 3.97e-4
    exponent: Constant = 1.59

    def coverage(self, wind: Wind) -> Scalar:
        return self.coefficient * wind.speed**self.exponent


class GoddijnMurphy2011(AbstractLaw):
    """One power law through the cruise data of Callaghan et al. (2008), whose range it shares.

    $$ W = 1.59·10^{-5} U^{2.7} $$

    **Source:** Goddijn-Murphy, Woolf & Callaghan 2011, J. Phys. Oceanogr. 41.
    """

    name: ClassVar[str] = "Goddijn-Murphy et al. 2011"
    citation: ClassVar[str] = "Goddijn-Murphy, Woolf & Callaghan 2011, J. Phys. Oceanogr. 41, 741-756"
    range: ClassVar[tuple[float, float]] = (3.70, 23.09)

    coefficient: Constant = 1.59e-5
    exponent: Constant = 2.7

    def coverage(self, wind: Wind) -> Scalar:
        return self.coefficient * wind.speed**self.exponent
