"""Where each ray first passes below the surface: a march over the rest plane in steps that are safe."""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from .._numerics import safe_norm
from .._types import Scalar, ScalarLike
from ._bounds import Bounds
from ._projected_grid import FAR
from ._ray_surface import RaySurface
from ._steepness import Steepness

MOST_STEPS = 1024
"""Evaluations of the surface after which a ray is given up."""

REFINEMENTS = 12
"""Evaluations inside of the bracket; Newton's method does the rest."""

CLOSE = 1e-3
"""Distance [pixels] between ray and surface at which the ray has arrived, on whichever side."""

ROUNDING = 8
"""The same over the distance from the camera, in roundings of that, where pixels are as fine as numbers."""

LANES = 8192
"""Rays that are under way at once; whenever some have arrived, others take their places."""

SPELL = 4
"""Steps between two such changes."""


class Start(NamedTuple):
    """What the march hands to Newton's method.

    **Arguments:** `hit`: whether the ray meets water; `x`, `y`: rest point from the point below the camera [m];
    `depth`: along the ray [m]; `steps`: evaluations of the surface. Without water all are 0.
    """

    hit: Bool[Array, "rows columns"]
    x: Float[Array, "rows columns"]
    y: Float[Array, "rows columns"]
    depth: Float[Array, "rows columns"]
    steps: Int[Array, "rows columns"]


class _Rays(NamedTuple):
    """Rays in their vertical planes, which all contain the vertical through the camera.

    **Arguments:** `east`, `north`: of the unit vector along the ground; `along` and `down`: parts of the unit vector
    along the ray; `start`, `end`: where along the ground [m] it is between the lowest and the highest water.
    """

    east: Float[Array, "*b"]
    north: Float[Array, "*b"]
    along: Float[Array, "*b"]
    down: Float[Array, "*b"]
    start: Float[Array, "*b"]
    end: Float[Array, "*b"]


class _Lanes(NamedTuple):
    """`number` of the ray; `a` and `b`: rest point along the ray's plane and across it; `low`, `high`: the bracket of
    a, with the clearance there; `last`: which end moved last; `left`: refinements to come; `crossed`: whether it has
    met the surface."""

    number: Int[Array, " lane"]
    a: Float[Array, " lane"]
    b: Float[Array, " lane"]
    low: Float[Array, " lane"]
    clear: Float[Array, " lane"]
    high: Float[Array, " lane"]
    under: Float[Array, " lane"]
    last: Int[Array, " lane"]
    left: Int[Array, " lane"]
    depth: Float[Array, " lane"]
    crossed: Bool[Array, " lane"]
    done: Bool[Array, " lane"]
    steps: Int[Array, " lane"]


def first_crossing(
    surface: RaySurface,
    steepness: Steepness,
    bounds: Bounds,
    rays: Float[Array, "rows columns 3"],
    height: Scalar,
    least_step: ScalarLike,
) -> Start:
    """The first place along each ray where it passes below the surface, or comes within `CLOSE` of a pixel of it.

    The march goes over the rest plane, along the line a whose points are displaced into the ray's own vertical plane;
    a fixed point across it, b ← −v(a, b), takes one step with every step along it. Folds are no obstacle: the line is
    followed through them, and of several sheets the first along it is taken. With the ray's direction (c, −s) the
    clearance

    $$ G(a) = c\\,(h - z(a)) - s\\,x(a), \\qquad |G'| ≤ s\\,(1 + |∇u|) + c\\,|∇η| $$

    is positive before the first crossing, and |G| over the right side is a step that cannot pass a zero, as far as the
    gradients are bounded by `Steepness` and the line is straight. Where such a step is shorter than `least_step` widths
    of the filter, that is taken instead: the tip of a crest can be missed only if it is narrower than this.
    """
    shape = rays.shape[:-1]
    plane = _in_planes(rays.reshape(-1, 3), surface, bounds, height)
    count = plane.start.size
    lanes = min(LANES, count)
    wanted = jnp.isfinite(plane.start)
    queue = jnp.nonzero(wanted, size=count + lanes, fill_value=count)[0].astype(jnp.int32)

    def spell(state: tuple[Int[Array, ""], _Lanes, Start]) -> tuple[Int[Array, ""], _Lanes, Start]:
        taken, lane, found = state
        own = jax.tree.map(lambda each: each.at[lane.number].get(mode="clip"), plane)
        step = partial(_step, surface, steepness, height, least_step, own)
        lane = jax.lax.fori_loop(0, SPELL, lambda _, each: step(each), lane)
        arrived = jnp.where(lane.done, lane.number, count)
        x, y = _at_rest(own, lane.a, lane.b)
        found = jax.tree.map(
            lambda all_, new: all_.at[arrived].set(new, mode="drop"),
            found,
            Start(lane.crossed, x, y, lane.depth, lane.steps),
        )
        return *_refilled(taken, lane, queue, plane), found

    zero = jnp.zeros_like(plane.start)
    nothing = Start(zero > 0, zero, zero, zero, zero.astype(jnp.int32))
    begin = jnp.int32(lanes), _new_lanes(queue[:lanes], plane)
    found = jax.lax.while_loop(lambda s: jnp.any(s[1].number < count), spell, (*begin, nothing))[2]
    return jax.tree.map(lambda each: each.reshape(shape), found)


def _in_planes(rays: Float[Array, "ray 3"], surface: RaySurface, bounds: Bounds, height: Scalar) -> _Rays:
    flat = safe_norm(rays[:, 0], rays[:, 1])
    upright = flat < 1e-6
    length = jnp.where(upright, 1.0, flat)
    east, north = jnp.where(upright, 1.0, rays[:, 0] / length), jnp.where(upright, 0.0, rays[:, 1] / length)
    start, end = _stretch(flat, -rays[:, 2], bounds, height, surface.curvature)
    last_width = jnp.sqrt(12 * surface.variance(end * east, end * north))
    return _Rays(
        east, north, flat, -rays[:, 2], start - bounds.displacement, end + bounds.displacement + last_width
    )


def _new_lanes(number: Int[Array, " lane"], plane: _Rays) -> _Lanes:
    start, end = (each.at[number].get(mode="clip") for each in (plane.start, plane.end))
    zero = jnp.zeros_like(start)
    none = jnp.zeros_like(number)
    idle = number >= plane.start.size
    return _Lanes(
        number, start, zero, start, zero, end, zero, none, none + REFINEMENTS, zero, zero > 0, idle, none
    )


def _refilled(
    taken: Int[Array, ""], lane: _Lanes, queue: Int[Array, " ray"], plane: _Rays
) -> tuple[Int[Array, ""], _Lanes]:
    """The lanes with the next rays of the queue where others have arrived."""
    place = taken + jnp.cumsum(lane.done.astype(jnp.int32)) - 1
    fresh = _new_lanes(queue.at[place].get(mode="clip"), plane)
    number = jnp.sum(lane.done, dtype=jnp.int32)
    return taken + number, jax.tree.map(lambda new, old: jnp.where(lane.done, new, old), fresh, lane)


def _at_rest(rays: _Rays, a: Float[Array, " lane"], b: Float[Array, " lane"]):
    return a * rays.east - b * rays.north, a * rays.north + b * rays.east


def _step(
    surface: RaySurface,
    steepness: Steepness,
    height: Scalar,
    least_step: ScalarLike,
    rays: _Rays,
    lane: _Lanes,
) -> _Lanes:
    """One step of the march, or of false position once there is a bracket."""
    x, y = _at_rest(rays, lane.a, lane.b)
    variance = surface.variance(x, y)
    px, py, pz = surface(x, y, variance)
    forward, aside = px * rays.east + py * rays.north, py * rays.east - px * rays.north
    fall = height - pz
    clearance = rays.along * fall - rays.down * forward
    depth = rays.along * forward + rays.down * fall
    below = (clearance <= 0) & (depth > 0)
    moved, raised = steepness(variance)
    # On a round planet the ray's angle is that to the local horizontal.
    turn = surface.curvature * lane.a
    dive = jnp.abs(rays.down * jnp.cos(turn) - rays.along * jnp.sin(turn))
    safe = jnp.abs(clearance) / (dive * (1 + moved) + raised + 1e-12)
    ahead = jnp.minimum(lane.a + jnp.maximum(safe, least_step * jnp.sqrt(12 * variance)), rays.end)

    # As near as this a ray has arrived, on either side. At a calm sea it starts there, and only rounding says on which:
    # compilers may work the clearance out anew for each decision below, and not always with the same sign.
    close = jnp.maximum(CLOSE * surface.angle, ROUNDING * float(jnp.finfo(depth.dtype).eps))
    near = (jnp.abs(clearance) < close * depth) & (depth > 0)
    crossed = lane.crossed | below | near
    low, high = jnp.where(below, lane.low, lane.a), jnp.where(below, lane.a, lane.high)
    # Behind the camera the clearance means nothing but "before".
    clear = jnp.where(below, lane.clear, jnp.maximum(clearance, 1e-30))
    under = jnp.where(below, clearance, lane.under)
    # Illinois: an end that stays for the second time counts half.
    clear = jnp.where(lane.crossed & below & (lane.last == 1), 0.5 * clear, clear)
    under = jnp.where(lane.crossed & ~below & (lane.last == -1), 0.5 * under, under)
    last = jnp.where(lane.crossed, jnp.where(below, 1, -1), 0).astype(jnp.int32)
    left = lane.left - crossed.astype(jnp.int32)
    share = clear / jnp.maximum(clear - under, 1e-30)
    inside = low + (high - low) * jnp.clip(share, 0.02, 0.98)
    steps = lane.steps + 1
    finished = near | (crossed & (left <= 0)) | (~crossed & ((lane.a >= rays.end) | (steps >= MOST_STEPS)))
    a = jnp.where(finished, lane.a, jnp.where(crossed, inside, ahead))
    new = _Lanes(
        lane.number, a, lane.b - aside, low, clear, high, under, last, left, depth, crossed, finished, steps
    )
    return jax.tree.map(lambda old, new: jnp.where(lane.done, old, new), lane, new)


def _stretch(
    along: Float[Array, " ray"], down: Float[Array, " ray"], bounds: Bounds, height: Scalar, curvature: Scalar
) -> tuple[Float[Array, " ray"], Float[Array, " ray"]]:
    """From where to where along the ground [m] each ray is between the lowest and the highest water; from infinity on
    if never."""
    round_planet = curvature > 0
    kappa = jnp.where(round_planet, curvature, 1.0)

    def roots(level: Scalar):
        """Depths at which the ray enters and leaves the sphere of this height, and whether it does."""
        slant = -(1 + curvature * height) * down
        rest = (height - level) * (2 + curvature * (height + level))
        square = slant**2 - curvature * rest
        root = jnp.sqrt(jnp.maximum(square, 0.0))
        enters = rest / jnp.maximum(root - slant, 1e-30)
        up = -rest / jnp.maximum(root + slant, 1e-30)
        leaves = jnp.where(round_planet & (rest > 0), (root - slant) / kappa, up)
        return enters, leaves, (square >= 0) & (rest > 0) & (down > 0), rest

    def ground(depth):
        flat = depth * along
        turn = jnp.arctan2(curvature * flat, 1 + curvature * (height - depth * down))
        return jnp.where(round_planet & (jnp.abs(turn) > 1e-3), turn / kappa, flat)

    top, bottom = roots(bounds.highest), roots(bounds.lowest)
    outside = top[3] > 0
    start = jnp.where(outside, jnp.where(top[2], ground(top[0]), jnp.inf), 0.0)
    away = FAR * jnp.maximum(height - bounds.lowest, 1.0)
    end = jnp.where(bottom[2], ground(bottom[0]), ground(jnp.minimum(top[1], away)))
    # What is further away than `FAR` is the horizon itself.
    return jnp.where(start < away, start, jnp.inf), jnp.minimum(jnp.maximum(end, start), away)
