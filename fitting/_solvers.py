"""How a fit moves downhill: optimistix solvers with tolerances that suit float64."""

import abc

import equinox as eqx
import optimistix as optx


class AbstractSolver(eqx.Module):
    """A choice of solver with its tolerances and the most steps that it may take."""

    steps: eqx.AbstractVar[int]

    @abc.abstractmethod
    def build(self) -> optx.AbstractLeastSquaresSolver | optx.AbstractMinimiser:
        """The optimistix solver."""

    @abc.abstractmethod
    def __str__(self) -> str:
        """Its name."""


class LevenbergMarquardt(AbstractSolver):
    """Damped Gauss–Newton steps: the right choice for nearly every fit."""

    rtol: float = eqx.field(static=True, default=1e-8)
    atol: float = eqx.field(static=True, default=1e-8)
    steps: int = eqx.field(static=True, default=256)

    def build(self) -> optx.AbstractLeastSquaresSolver:
        return optx.LevenbergMarquardt(self.rtol, self.atol)

    def __str__(self) -> str:
        return "Levenberg-Marquardt"


class GaussNewton(AbstractSolver):
    """Undamped steps: fastest near a solution, may diverge far from one."""

    rtol: float = eqx.field(static=True, default=1e-8)
    atol: float = eqx.field(static=True, default=1e-8)
    steps: int = eqx.field(static=True, default=256)

    def build(self) -> optx.AbstractLeastSquaresSolver:
        return optx.GaussNewton(self.rtol, self.atol)

    def __str__(self) -> str:
        return "Gauss-Newton"


class Dogleg(AbstractSolver):
    """Gauss–Newton steps inside a region of trust."""

    rtol: float = eqx.field(static=True, default=1e-8)
    atol: float = eqx.field(static=True, default=1e-8)
    steps: int = eqx.field(static=True, default=256)

    def build(self) -> optx.AbstractLeastSquaresSolver:
        return optx.Dogleg(self.rtol, self.atol)

    def __str__(self) -> str:
        return "dogleg"


class BFGS(AbstractSolver):
    """A quasi-Newton minimiser: for many parameters, or a likelihood that is far from a sum of squares."""

    rtol: float = eqx.field(static=True, default=1e-8)
    atol: float = eqx.field(static=True, default=1e-8)
    steps: int = eqx.field(static=True, default=512)

    def build(self) -> optx.AbstractMinimiser:
        return optx.BFGS(self.rtol, self.atol)

    def __str__(self) -> str:
        return "BFGS"


class LBFGS(AbstractSolver):
    """BFGS that remembers a few steps only: for very many parameters."""

    rtol: float = eqx.field(static=True, default=1e-8)
    atol: float = eqx.field(static=True, default=1e-8)
    steps: int = eqx.field(static=True, default=512)

    def build(self) -> optx.AbstractMinimiser:
        return optx.LBFGS(self.rtol, self.atol)

    def __str__(self) -> str:
        return "L-BFGS"


class NelderMead(AbstractSolver):
    """A simplex that needs no derivatives: slow, for models without a useful slope."""

    rtol: float = eqx.field(static=True, default=1e-7)
    atol: float = eqx.field(static=True, default=1e-7)
    steps: int = eqx.field(static=True, default=2000)

    def build(self) -> optx.AbstractMinimiser:
        return optx.NelderMead(self.rtol, self.atol)

    def __str__(self) -> str:
        return "Nelder-Mead"
