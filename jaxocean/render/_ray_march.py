"""Where each ray first passes below the surface: a march over the rest plane in steps that are safe."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from .._numerics import safe_norm
from .._types import Scalar
from ._bounds import Bounds
from ._projected_grid import FAR
from ._ray_surface import RaySurface
from ._steepness import Steepness

MOST_STEPS = 1024
"""Evaluations of the surface after which a ray is given up."""

REFINEMENTS = 12
"""Evaluations inside of the bracket; Newton's method does the rest."""

CLOSE = 1e-3
"""Distance [pixels] between ray and surface at which the bracket is narrow enough."""


class Start(NamedTuple):
    """What the march hands to Newton's method.

    **Arguments:** `hit`: whether the ray meets water; `x`, `y`: rest point from the point below the camera [m];
    `depth`: along the ray [m]; `steps`: evaluations of the surface.
    """

    hit: Bool[Array, "rows columns"]
    x: Float[Array, "rows columns"]
    y: Float[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    steps: Int[Array, ""]


class _Rays(NamedTuple):
    """Rays in their vertical planes, which all contain the vertical through the camera.

    **Arguments:** `east`, `north`: of the unit vector along the ground; `along` and `down`: parts of the unit vector
    along the ray.
    """

    east: Float[Array, "rows columns"]
    north: Float[Array, "rows columns"]
    along: Float[Array, "rows columns"]
    down: Float[Array, "rows columns"]


class _State(NamedTuple):
    """`a` and `b`: rest point along the ray's plane and across it; `low`, `high`: the bracket of a, with the clearance
    there; `last`: which end moved last; `left`: refinements to come."""

    a: Float[Array, "rows columns"]
    b: Float[Array, "rows columns"]
    low: Float[Array, "rows columns"]
    clear: Float[Array, "rows columns"]
    high: Float[Array, "rows columns"]
    under: Float[Array, "rows columns"]
    last: Int[Array, "rows columns"]
    left: Int[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    crossed: Bool[Array, "rows columns"]
    done: Bool[Array, "rows columns"]
    steps: Int[Array, ""]


def first_crossing(
    surface: RaySurface,
    steepness: Steepness,
    bounds: Bounds,
    rays: Float[Array, "rows columns 3"],
    height: Scalar,
    least_step: float,
) -> Start:
    """The first place along each ray where it passes below the surface, to within `CLOSE` of a pixel.

    The march goes over the rest plane, along the line a whose points are displaced into the ray's own vertical plane;
    a fixed point across it, b ← −v(a, b), takes one step with every step along it. Folds are no obstacle: the line is
    followed through them. With the ray's direction (c, −s) the clearance

    $$ G(a) = c\\,(h - z(a)) - s\\,x(a), \\qquad |G'| ≤ s\\,(1 + |∇u|) + c\\,|∇η| $$

    is positive before the first crossing, and |G| over the bound is a step that cannot pass a zero. Where it is shorter
    than `least_step` widths of the filter, that is taken instead: so the tip of a crest can be missed only if it is
    narrower than this, less than which no wave in the filtered surface is. The bound takes the line as straight.
    """
    flat = safe_norm(rays[..., 0], rays[..., 1])
    upright = flat < 1e-6
    length = jnp.where(upright, 1.0, flat)
    plane = _Rays(
        jnp.where(upright, 1.0, rays[..., 0] / length),
        jnp.where(upright, 0.0, rays[..., 1] / length),
        flat,
        -rays[..., 2],
    )
    start, end = _stretch(plane, bounds, height, surface.curvature)
    missed = ~jnp.isfinite(start)
    start, end = jnp.where(missed, 0.0, start) - bounds.displacement, jnp.where(missed, 0.0, end)
    last_width = jnp.sqrt(12 * surface.variance(end * plane.east, end * plane.north))
    end = end + bounds.displacement + last_width

    def step(state: _State) -> _State:
        x = state.a * plane.east - state.b * plane.north
        y = state.a * plane.north + state.b * plane.east
        variance = surface.variance(x, y)
        px, py, pz = surface(x, y, variance)
        forward, aside = px * plane.east + py * plane.north, py * plane.east - px * plane.north
        fall = height - pz
        clearance = plane.along * fall - plane.down * forward
        depth = plane.along * forward + plane.down * fall
        below = (clearance <= 0) & (depth > 0)
        moved, raised = steepness(variance)
        # On a round planet the ray's angle is that to the local horizontal.
        turn = surface.curvature * state.a
        dive = jnp.abs(plane.down * jnp.cos(turn) - plane.along * jnp.sin(turn))
        safe = jnp.abs(clearance) / (dive * (1 + moved) + raised + 1e-12)
        ahead = state.a + jnp.maximum(safe, least_step * jnp.sqrt(12 * variance))
        return _advanced(state, clearance, depth, below, ahead, end, aside, surface.angle)

    zero = jnp.zeros_like(start)
    none = jnp.zeros(start.shape, jnp.int32)
    state = _State(
        start, zero, start, zero, end, zero, none, none + REFINEMENTS, zero, zero > 0, missed, jnp.int32(0)
    )
    state = jax.lax.while_loop(lambda s: ~jnp.all(s.done) & (s.steps < MOST_STEPS), step, state)
    x = state.a * plane.east - state.b * plane.north
    y = state.a * plane.north + state.b * plane.east
    return Start(state.crossed & ~missed, x, y, state.depth, state.steps)


def _advanced(state: _State, clearance, depth, below, ahead, end, aside, angle) -> _State:
    """One step of the march, or of false position once there is a bracket."""
    crossed = state.crossed | below
    low = jnp.where(below, state.low, state.a)
    high = jnp.where(below, state.a, state.high)
    # Behind the camera the clearance means nothing but "before".
    clear = jnp.where(below, state.clear, jnp.maximum(clearance, 1e-30))
    under = jnp.where(below, clearance, state.under)
    # Illinois: the end that stays for the second time counts half.
    refining = state.crossed
    clear = jnp.where(refining & below & (state.last == 1), 0.5 * clear, clear)
    under = jnp.where(refining & ~below & (state.last == -1), 0.5 * under, under)
    last = jnp.where(refining, jnp.where(below, 1, -1), 0).astype(jnp.int32)
    left = state.left - crossed.astype(jnp.int32)
    share = clear / jnp.maximum(clear - under, 1e-30)
    inside = low + (high - low) * jnp.clip(share, 0.02, 0.98)
    close = crossed & ((jnp.abs(clearance) < CLOSE * angle * depth) & (depth > 0) | (left <= 0))
    finished = close | (~crossed & (state.a >= end))
    following = jnp.where(crossed, inside, jnp.minimum(ahead, end))

    def kept(new, old):
        return jnp.where(state.done, old, new)

    return _State(
        kept(jnp.where(finished, state.a, following), state.a),
        kept(state.b - aside, state.b),
        kept(low, state.low),
        kept(clear, state.clear),
        kept(high, state.high),
        kept(under, state.under),
        kept(last, state.last),
        kept(left, state.left),
        kept(depth, state.depth),
        kept(crossed, state.crossed),
        state.done | finished,
        state.steps + 1,
    )


def _stretch(
    rays: _Rays, bounds: Bounds, height: Scalar, curvature: Scalar
) -> tuple[Float[Array, "rows columns"], Float[Array, "rows columns"]]:
    """From where to where along the ground [m] each ray is between the lowest and the highest water."""
    round_planet = curvature > 0
    kappa = jnp.where(round_planet, curvature, 1.0)

    def roots(level: Scalar):
        """Depths at which the ray enters and leaves the sphere of this height, and whether it does."""
        slant = -(1 + curvature * height) * rays.down
        rest = (height - level) * (2 + curvature * (height + level))
        square = slant**2 - curvature * rest
        root = jnp.sqrt(jnp.maximum(square, 0.0))
        enters = rest / jnp.maximum(root - slant, 1e-30)
        up = -rest / jnp.maximum(root + slant, 1e-30)
        leaves = jnp.where(round_planet & (rest > 0), (root - slant) / kappa, up)
        return enters, leaves, (square >= 0) & (rest > 0) & (rays.down > 0), rest

    def ground(depth):
        flat = depth * rays.along
        turn = jnp.arctan2(curvature * flat, 1 + curvature * (height - depth * rays.down))
        return jnp.where(round_planet & (jnp.abs(turn) > 1e-3), turn / kappa, flat)

    top, bottom = roots(bounds.highest), roots(bounds.lowest)
    outside = top[3] > 0
    start = jnp.where(outside, jnp.where(top[2], ground(top[0]), jnp.inf), 0.0)
    away = FAR * jnp.maximum(height - bounds.lowest, 1.0)
    end = jnp.where(bottom[2], ground(bottom[0]), ground(jnp.minimum(top[1], away)))
    # What is further away than `FAR` is the horizon itself.
    return jnp.where(start < away, start, jnp.inf), jnp.minimum(jnp.maximum(end, start), away)
