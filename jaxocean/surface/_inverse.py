"""Which rest point is now above this place: the inverse of the displacement, folds included."""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._numerics import safe_divide, safe_norm
from .._types import Scalar

SEARCH_STEPS = 24
POLISH_STEPS = 10
RINGS = (0.35, 1.1)  # radii of the rings of starting points, in root-mean-square displacements
SPOKES = 8
FOUND = 0.02  # residual, in root-mean-square displacements, below which a search has found a root


class Sample(eqx.Module):
    """What the surface does at some points: displacement [m], strain [-] and height [m]."""

    displacement: Float[Array, "*s 2"]
    strain: Float[Array, "*s 3"]
    height: Float[Array, "*s"]


class RestPoint(eqx.Module):
    """A rest point p whose displaced place p + D(p) is the place x that was asked for.

    `offset` is p − x [m], accurate also where x itself has few digits left. `residual` [m] is what remains of
    |p + D(p) − x|: the root is good where it is as small as the floating-point type allows.
    """

    point: Float[Array, "*b 2"]
    offset: Float[Array, "*b 2"]
    residual: Float[Array, "*b"]
    tolerance: Scalar

    @property
    def converged(self) -> Bool[Array, "*b"]:
        """Whether the residual is below the tolerance."""
        return self.residual < self.tolerance


def highest_root(
    rough: Callable[[Float[Array, "s p 2"]], Sample],
    exact: Callable[[Float[Array, "1 p 2"]], Sample],
    count: int,
    scale: Scalar,
) -> tuple[Float[Array, "p 2"], Float[Array, "p"]]:
    """Offsets δ with δ + D(x + δ) = 0, for `count` places x at once; of several roots the one with the
    highest surface.

    Damped Newton steps (Levenberg–Marquardt with one damping for each point, so a residual never grows) run
    from a small set of starting points on `rough`, an approximation that is cheap; the highest root found
    is refined on `exact`. Where the sea folds (j < 0) a place has three roots or more, and a search can
    miss one.

    **Arguments:** `rough`, `exact`: the surface at x + δ for offsets δ [m]; `scale`: root-mean-square
    displacement [m].

    **Returns:** the offsets [m] and the residuals [m], both without derivative.
    """
    here = jnp.zeros((1, count, 2), scale.dtype)
    for _ in range(2):
        here = -rough(here).displacement
    angle = np.arange(SPOKES) * (2 * np.pi / SPOKES)
    spokes = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    star = np.concatenate([np.zeros((1, 2)), *(radius * spokes for radius in RINGS)])
    starts = here + jnp.asarray(star, scale.dtype)[:, None] * scale

    found, sample, residual = _descend(rough, starts, SEARCH_STEPS)
    good = residual < FOUND * scale
    lowest = jnp.min(sample.height) - 1
    score = jnp.where(good, sample.height, lowest - residual)
    best = jnp.argmax(score, axis=0)
    chosen = jnp.take_along_axis(found, best[None, :, None], axis=0)
    offset, _, residual = _descend(exact, chosen, POLISH_STEPS)
    return offset[0], residual[0]


def implicit_offset(offset: Float[Array, "p 2"], sample: Sample) -> Float[Array, "p 2"]:
    """The offset with its exact first derivative, by the implicit function theorem: dδ = −(1 + ∇D)⁻¹ dD.

    **Arguments:** `offset`: a root without derivative; `sample`: the surface there, with derivatives.
    """
    residual = sample.displacement - jax.lax.stop_gradient(sample.displacement)
    a, b, c = jnp.moveaxis(jax.lax.stop_gradient(sample.strain), -1, 0)
    rx, ry = residual[..., 0], residual[..., 1]
    jacobian = (1 + a) * (1 + b) - c * c
    step = jnp.stack(
        [safe_divide((1 + b) * rx - c * ry, jacobian), safe_divide((1 + a) * ry - c * rx, jacobian)], axis=-1
    )
    return offset - step


def _descend(
    surface: Callable[[Float[Array, "s p 2"]], Sample], start: Float[Array, "s p 2"], steps: int
) -> tuple[Float[Array, "s p 2"], Sample, Float[Array, "s p"]]:
    sample = surface(start)
    damping = jnp.full(start.shape[:-1], 1e-3, start.dtype)

    def step(_, state):
        offset, sample, damping = state
        trial = offset + _damped_step(offset, sample, damping)
        there = surface(trial)
        better = _residual(trial, there) < _residual(offset, sample)
        offset, sample = jax.tree.map(
            lambda new, old: jnp.where(
                better.reshape(better.shape + (1,) * (new.ndim - better.ndim)), new, old
            ),
            (trial, there),
            (offset, sample),
        )
        return offset, sample, jnp.where(better, 0.1 * damping, jnp.maximum(10 * damping, 1e-3))

    offset, sample, _ = jax.lax.fori_loop(0, steps, step, (start, sample, damping))
    return offset, sample, _residual(offset, sample)


def _residual(offset: Float[Array, "s p 2"], sample: Sample) -> Float[Array, "s p"]:
    rest = offset + sample.displacement
    return safe_norm(rest[..., 0], rest[..., 1])


def _damped_step(
    offset: Float[Array, "s p 2"], sample: Sample, damping: Float[Array, "s p"]
) -> Float[Array, "s p 2"]:
    """−(MᵀM + μ)⁻¹ Mᵀ r with the symmetric M = 1 + ∇D."""
    rest = offset + sample.displacement
    a, b, c = jnp.moveaxis(sample.strain, -1, 0)
    a, b = 1 + a, 1 + b
    gx, gy = a * rest[..., 0] + c * rest[..., 1], c * rest[..., 0] + b * rest[..., 1]
    xx, yy, xy = a * a + c * c + damping, b * b + c * c + damping, c * (a + b)
    determinant = xx * yy - xy * xy
    return -jnp.stack(
        [safe_divide(yy * gx - xy * gy, determinant), safe_divide(xx * gy - xy * gx, determinant)], axis=-1
    )
