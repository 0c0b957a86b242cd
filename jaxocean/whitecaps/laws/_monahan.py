"""The laws of Monahan and his co-workers."""

from typing import ClassVar, Literal

import jax.numpy as jnp

from ..._constants import GRAVITY
from ..._types import Scalar
from ...wind import Wind
from ._law import AbstractLaw, Constant


class Monahan1980(AbstractLaw):
    """The classical power law, fitted robustly.

    $$ W = 3.84·10^{-6} U^{3.41} $$

    **Source:** Monahan & O'Muircheartaigh 1980, J. Phys. Oceanogr. 10; most data lie below 12 m/s, the
    last ones near 17 m/s.
    """

    name: ClassVar[str] = "Monahan & O'Muircheartaigh 1980 (robust)"
    citation: ClassVar[str] = "Monahan & O'Muircheartaigh 1980, J. Phys. Oceanogr. 10, 2094-2099"
    range: ClassVar[tuple[float, float]] = (0.0, 17.0)

    coefficient: Constant = 3.84e-6
    exponent: Constant = 3.41

    def coverage(self, wind: Wind) -> Scalar:
        return self.coefficient * wind.speed**self.exponent


class Monahan1980LeastSquares(AbstractLaw):
    """The same data as `Monahan1980`, fitted by ordinary least squares.

    $$ W = 2.95·10^{-6} U^{3.52} $$

    **Source:** Monahan & O'Muircheartaigh 1980, J. Phys. Oceanogr. 10.
    """

    name: ClassVar[str] = "Monahan & O'Muircheartaigh 1980 (least squares)"
    citation: ClassVar[str] = "Monahan & O'Muircheartaigh 1980, J. Phys. Oceanogr. 10, 2094-2099"
    range: ClassVar[tuple[float, float]] = (0.0, 17.0)

    coefficient: Constant = 2.95e-6
    exponent: Constant = 3.52

    def coverage(self, wind: Wind) -> Scalar:
        return self.coefficient * wind.speed**self.exponent


class MonahanOMuircheartaigh1986(AbstractLaw):
    """A power law that knows the stability of the air.

    $$ W = 1.95·10^{-5} U^{2.55} \\exp(0.0861 (T_w − T_a)) $$

    T_w − T_a is the wind's `sea_air_temperature_difference`. The range is (unverified).

    **Source:** Monahan & O'Muircheartaigh 1986, Int. J. Remote Sens. 7. (Darles et al. 2011 print 1.59e-5.)
    """

    name: ClassVar[str] = "Monahan & O'Muircheartaigh 1986"
    citation: ClassVar[str] = "Monahan & O'Muircheartaigh 1986, Int. J. Remote Sens. 7, 627-642"
    range: ClassVar[tuple[float, float]] = (0.0, 20.0)

    coefficient: Constant = 1.95e-5
    exponent: Constant = 2.55
    stability: Constant = 0.0861

    def coverage(self, wind: Wind) -> Scalar:
        warmth = jnp.exp(self.stability * wind.sea_air_temperature_difference)
        return self.coefficient * wind.speed**self.exponent * warmth


class MonahanLu1990StageB(AbstractLaw):
    """Decaying foam, by the viscosity of the water.

    $$ W_B = \\{5.21·10^{-4} [U (10^{-4} gν)^{-1/3} − 75.9]\\}³, \\quad
       ν = 0.018 − 4.72·10^{-4} T + 5.24·10^{-6} T² $$

    with ν in cm²/s and T in °C; 0 below the wind where the bracket vanishes. The upper end of the range is
    (unverified).

    **Arguments:** `water_temperature` T [°C].

    **Source:** Monahan & Lu 1990, IEEE J. Oceanic Eng. 15.
    """

    name: ClassVar[str] = "Monahan & Lu 1990 (stage B)"
    foam: ClassVar[Literal["total", "active", "decaying"]] = "decaying"
    citation: ClassVar[str] = "Monahan & Lu 1990, IEEE J. Oceanic Eng. 15, 340-349"
    range: ClassVar[tuple[float, float]] = (2.5, 20.0)

    water_temperature: Constant = 15.0

    def coverage(self, wind: Wind) -> Scalar:
        return _decaying_foam(wind, self.water_temperature)


class MonahanLu1990StageA(AbstractLaw):
    """Actively breaking crests: W_A = W_B/9.7 with W_B of `MonahanLu1990StageB`.

    **Arguments:** `water_temperature` T [°C].

    **Source:** Monahan & Lu 1990, IEEE J. Oceanic Eng. 15.
    """

    name: ClassVar[str] = "Monahan & Lu 1990 (stage A)"
    foam: ClassVar[Literal["total", "active", "decaying"]] = "active"
    citation: ClassVar[str] = "Monahan & Lu 1990, IEEE J. Oceanic Eng. 15, 340-349"
    range: ClassVar[tuple[float, float]] = (2.5, 20.0)

    water_temperature: Constant = 15.0
    ratio: Constant = 9.7

    def coverage(self, wind: Wind) -> Scalar:
        return _decaying_foam(wind, self.water_temperature) / self.ratio


def _decaying_foam(wind: Wind, temperature: Constant) -> Scalar:
    viscosity = 0.018 - 4.72e-4 * temperature + 5.24e-6 * temperature**2  # cm²/s
    bracket = wind.speed * (GRAVITY * viscosity * 1e-4) ** (-1 / 3) - 75.9
    return (5.21e-4 * jnp.maximum(bracket, 0.0)) ** 3
