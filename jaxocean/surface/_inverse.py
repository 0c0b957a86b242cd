"""Which rest point is now above this place: the inverse of the displacement, folds included."""

from collections.abc import Callable
from typing import TypeAlias

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from .._numerics import safe_divide, safe_norm
from .._types import Scalar

SEARCH_STEPS = 24
POLISH_STEPS = 16
AGAIN_STEPS = 40
BATCH = 16  # places that are searched again at once
CANDIDATES = 4  # roots that are refined
RINGS = (0.35, 1.1)  # radii of the rings of starting points, in root-mean-square displacements
SPOKES = 8
SAME = 0.02  # distance, in root-mean-square displacements, within which two roots are one
FOUND = 0.02  # residual, in root-mean-square displacements, below which a search has found a root


class Sample(eqx.Module):
    """What the surface does at some points: displacement [m], strain [-] and height [m]."""

    displacement: Float[Array, "*s 2"]
    strain: Float[Array, "*s 3"]
    height: Float[Array, "*s"]


Surface: TypeAlias = Callable[[Int[Array, " p"], Float[Array, "s p 2"]], Sample]


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
    rough: Surface, exact: Surface, count: int, scale: Scalar, tolerance: Scalar
) -> tuple[Float[Array, "p 2"], Float[Array, " p"]]:
    """Offsets δ with δ + D(x + δ) = 0, for `count` places x; of several roots the one with the highest
    surface.

    Damped Newton steps (Levenberg–Marquardt with one damping for each point, so a residual never grows) run
    from a small set of starting points on `rough`, an approximation that is cheap; the highest roots found,
    each once, are refined on `exact`, and the highest of these is taken. The few places where that fails,
    all near folds, are searched again on `exact`. Where the sea folds (j < 0) a place has three roots or
    more, and a search can miss one.

    **Arguments:** `rough`, `exact`: the surface at x_i + δ for offsets δ [m] and numbers i of places;
    `scale`: root-mean-square displacement [m]; `tolerance`: residual [m] of a root.

    **Returns:** the offsets [m] and the residuals [m], both without derivative.
    """
    if count == 0:
        return jnp.zeros((0, 2), scale.dtype), jnp.zeros(0, scale.dtype)
    everywhere = jnp.arange(count)
    centre = jnp.zeros((1, count, 2), scale.dtype)
    for _ in range(2):
        centre = -rough(everywhere, centre).displacement
    star = jnp.asarray(_star(), scale.dtype)[:, None] * scale

    found, sample, residual = _descend(rough, everywhere, centre + star, SEARCH_STEPS, FOUND * scale)
    score = _score(sample, residual, FOUND * scale)
    candidates = []
    for _ in range(CANDIDATES):
        best = _take(found, jnp.argmax(score, axis=0))
        candidates.append(best)
        apart = found - best
        score = jnp.where(safe_norm(apart[..., 0], apart[..., 1]) < SAME * scale, -jnp.inf, score)
    offset, residual = _highest(exact, everywhere, jnp.stack(candidates), POLISH_STEPS, tolerance)

    def unfinished(state):
        _, residual, tried = state
        return jnp.any((residual > tolerance) & ~tried)

    def search_again(state):
        offset, residual, tried = state
        pending = jnp.where(tried, 0.0, residual)
        worst = jax.lax.top_k(pending, min(BATCH, count))[1]
        again, remainder = _highest(exact, worst, centre[:, worst] + star, AGAIN_STEPS, tolerance)
        better = remainder < residual[worst]
        offset = offset.at[worst].set(jnp.where(better[:, None], again, offset[worst]))
        residual = residual.at[worst].set(jnp.where(better, remainder, residual[worst]))
        return offset, residual, tried.at[worst].set(True)

    offset, residual, _ = jax.lax.while_loop(
        unfinished, search_again, (offset, residual, jnp.zeros(count, bool))
    )
    return offset, residual


def _star() -> np.ndarray:
    """Where searches start, around a first guess, in root-mean-square displacements."""
    angle = np.arange(SPOKES) * (2 * np.pi / SPOKES)
    spokes = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.concatenate([np.zeros((1, 2)), *(radius * spokes for radius in RINGS)])


def _highest(
    exact: Surface, which: Int[Array, " p"], starts: Float[Array, "s p 2"], steps: int, tolerance: Scalar
) -> tuple[Float[Array, "p 2"], Float[Array, " p"]]:
    """The highest root that descents from the given starts reach, or where none does, the smallest residual."""
    roots, sample, residual = _descend(exact, which, starts, steps, 0.1 * tolerance)
    best = jnp.argmax(_score(sample, residual, tolerance), axis=0)
    return _take(roots, best), _take(residual[..., None], best)[..., 0]


def _score(sample: Sample, residual: Float[Array, "s p"], tolerance: Scalar) -> Float[Array, "s p"]:
    """Heights of the roots; below all of these, what is no root, the worse the lower."""
    lowest = jnp.min(sample.height) - 1
    return jnp.where(residual < tolerance, sample.height, lowest - residual)


def _take(values: Float[Array, "s p c"], index: Int[Array, " p"]) -> Float[Array, "p c"]:
    return jnp.take_along_axis(values, index[None, :, None], axis=0)[0]


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
    surface: Surface, which: Int[Array, " p"], start: Float[Array, "s p 2"], steps: int, goal: Scalar
) -> tuple[Float[Array, "s p 2"], Sample, Float[Array, "s p"]]:
    """At most `steps` damped Newton steps, fewer if all residuals are below `goal` [m] before."""

    def unfinished(state):
        count, offset, sample, _ = state
        return (count < steps) & jnp.any(_residual(offset, sample) > goal)

    def step(state):
        count, offset, sample, damping = state
        trial = offset + _damped_step(offset, sample, damping)
        there = surface(which, trial)
        better = _residual(trial, there) < _residual(offset, sample)
        offset, sample = jax.tree.map(
            lambda new, old: jnp.where(
                better.reshape(better.shape + (1,) * (new.ndim - better.ndim)), new, old
            ),
            (trial, there),
            (offset, sample),
        )
        return count + 1, offset, sample, jnp.where(better, 0.1 * damping, jnp.maximum(10 * damping, 1e-3))

    damping = jnp.full(start.shape[:-1], 1e-3, start.dtype)
    start_state = (jnp.asarray(0), start, surface(which, start), damping)
    _, offset, sample, _ = jax.lax.while_loop(unfinished, step, start_state)
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
