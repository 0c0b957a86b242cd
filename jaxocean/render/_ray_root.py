"""The last digits of where rays meet the surface, and their derivative by the implicit function theorem."""

from typing import Any

import jax
import jax.numpy as jnp
import lineax as lx
import optimistix as optx
from jaxtyping import Array, Bool, Float

from .._types import Scalar
from ._ray_surface import RaySurface

Triple = tuple[Float[Array, "rows columns"], Float[Array, "rows columns"], Float[Array, "rows columns"]]

STEPS = 2
"""Newton steps from a start within a thousandth of a pixel."""

EDGE_ON = 0.02
"""Determinant, over that of the plane, below which the surface counts as seen edge on."""


def meet_surface(
    surface: RaySurface,
    start: Triple,
    hit: Bool[Array, "rows columns"],
    rays: Float[Array, "rows columns 3"],
    height: Scalar,
    slant: Float[Array, "rows columns"],
) -> Triple:
    """Rest point (x, y) and depth [m] at which rays meet the surface: the root of three equations for each pixel,

    $$ X(x, y) = (0, 0, h) + \\frac{τ}{s}\\,d $$

    with the sine s of the angle between ray and plane, so that all three unknowns are lengths on the same scale.
    Derivatives with respect to everything that surface, height and rays depend on are those of the implicit function
    theorem (`optimistix.ImplicitAdjoint`), forwards and in reverse; the start carries none. `PerPixel` takes a part in
    2500 from them where the surface lies like the plane, and keeps them bounded where it is seen edge on.
    """
    slant = jax.lax.stop_gradient(slant)
    held = jax.lax.stop_gradient((start[0], start[1], start[2] * slant))

    def residual(unknown: Triple, args) -> Triple:
        surface, rays, height = args
        x, y, tau = unknown
        px, py, pz = surface(x, y)
        depth = tau / slant
        parts = (px - depth * rays[..., 0], py - depth * rays[..., 1], pz - height - depth * rays[..., 2])
        a, b, c = (jnp.where(hit, part, u - s) for part, u, s in zip(parts, unknown, held, strict=True))
        return a, b, c

    tolerance = float(jnp.finfo(slant.dtype).eps) * 16
    solver = PerPixel()
    x, y, tau = optx.root_find(
        residual,
        optx.Newton(rtol=tolerance, atol=tolerance, linear_solver=solver),
        held,
        args=(surface, rays, height),
        adjoint=optx.ImplicitAdjoint(linear_solver=solver),
        max_steps=STEPS,
        throw=False,
    ).value
    return x, y, tau / slant


class PerPixel(lx.AbstractLinearSolver):
    """Linear systems of three equations for each pixel, all at once.

    Pixels know nothing of each other: three products with the operator give all 3 × 3 matrices. Where the surface is
    seen edge on and the determinant D vanishes, D/(D² + δ²) stands for 1/D.
    """

    def init(self, operator: lx.AbstractLinearOperator, options: dict[str, Any]) -> Any:
        del options
        ones = jax.tree.map(lambda s: jnp.ones(s.shape, s.dtype), operator.in_structure())
        nothing = jax.tree.map(jnp.zeros_like, ones)
        rows = [
            operator.mv(
                tuple(
                    one if i == j else zero for j, (one, zero) in enumerate(zip(ones, nothing, strict=True))
                )
            )
            for i in range(3)
        ]
        return tuple(rows)

    def compute(
        self, state: Any, vector: Any, options: dict[str, Any]
    ) -> tuple[Any, lx.RESULTS, dict[str, Any]]:
        del options
        first, second, third = state
        normal = _cross(first, second)
        determinant = _dot(normal, third)
        inverse = determinant / (determinant**2 + EDGE_ON**2)
        found = (
            _dot(_cross(second, third), vector),
            _dot(_cross(third, first), vector),
            _dot(normal, vector),
        )
        return tuple(part * inverse for part in found), lx.RESULTS.successful, {}

    def transpose(self, state: Any, options: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        del options
        return tuple(tuple(column[i] for column in state) for i in range(3)), {}

    def conj(self, state: Any, options: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        del options
        return state, {}

    def assume_full_rank(self) -> bool:
        return True


def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
