"""How a fit moves downhill: optimistix solvers with tolerances that suit float64."""

import abc
from dataclasses import dataclass

import optimistix as optx

from ._rounding import forgiving


class AbstractSolver(abc.ABC):
    """A choice of solver with its tolerances and the most steps that it may take."""

    steps: int

    @abc.abstractmethod
    def build(self) -> optx.AbstractLeastSquaresSolver | optx.AbstractMinimiser:
        """The optimistix solver."""

    @abc.abstractmethod
    def __str__(self) -> str:
        """Its name."""


@dataclass(frozen=True)
class LevenbergMarquardt(AbstractSolver):
    """Damped Gauss–Newton steps: the right choice for nearly every fit."""

    rtol: float = 1e-8
    atol: float = 1e-8
    steps: int = 256

    def build(self) -> optx.AbstractLeastSquaresSolver:
        return forgiving(optx.LevenbergMarquardt(self.rtol, self.atol))

    def __str__(self) -> str:
        return "Levenberg-Marquardt"


@dataclass(frozen=True)
class GaussNewton(AbstractSolver):
    """Undamped steps: fastest near a solution, may diverge far from one."""

    rtol: float = 1e-8
    atol: float = 1e-8
    steps: int = 256

    def build(self) -> optx.AbstractLeastSquaresSolver:
        return optx.GaussNewton(self.rtol, self.atol)

    def __str__(self) -> str:
        return "Gauss-Newton"


@dataclass(frozen=True)
class Dogleg(AbstractSolver):
    """Gauss–Newton steps inside a region of trust."""

    rtol: float = 1e-8
    atol: float = 1e-8
    steps: int = 256

    def build(self) -> optx.AbstractLeastSquaresSolver:
        return forgiving(optx.Dogleg(self.rtol, self.atol))

    def __str__(self) -> str:
        return "dogleg"


@dataclass(frozen=True)
class BFGS(AbstractSolver):
    """A quasi-Newton minimiser: for many parameters, or a likelihood that is far from a sum of squares."""

    rtol: float = 1e-8
    atol: float = 1e-8
    steps: int = 512

    def build(self) -> optx.AbstractMinimiser:
        return optx.BFGS(self.rtol, self.atol)

    def __str__(self) -> str:
        return "BFGS"


@dataclass(frozen=True)
class LBFGS(AbstractSolver):
    """BFGS that remembers a few steps only: for very many parameters."""

    rtol: float = 1e-8
    atol: float = 1e-8
    steps: int = 512

    def build(self) -> optx.AbstractMinimiser:
        return optx.LBFGS(self.rtol, self.atol)

    def __str__(self) -> str:
        return "L-BFGS"


@dataclass(frozen=True)
class NelderMead(AbstractSolver):
    """A simplex that needs no derivatives: slow, for models without a useful slope."""

    rtol: float = 1e-7
    atol: float = 1e-7
    steps: int = 2000

    def build(self) -> optx.AbstractMinimiser:
        return optx.NelderMead(self.rtol, self.atol)

    def __str__(self) -> str:
        return "Nelder-Mead"
