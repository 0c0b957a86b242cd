"""The part of the rest plane that one pixel sees, and the isotropic probes that stand for it."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._numerics import safe_angle, safe_norm, safe_sqrt
from .._types import FloatLike

Points = Float[Array, "*b 2"] | Float[np.ndarray, "*b 2"]
Axes = Float[Array, "*c 2 2"] | Float[np.ndarray, "*c 2 2"]

DEFAULT_PROBES = 4
MOST_PROBES = 64


class Footprint(eqx.Module):
    """A parallelogram on the rest plane, all of whose points count alike.

    $$ \\{ p + F u : u \\in [-½, ½]² \\} $$

    Its second moments are K = F Fᵀ/12. For a pixel, F = ∂p/∂(pixel coordinates).

    **Arguments:**

    - `centre`: p (x, y) [m]. A NumPy array in float64 keeps its digits far from the origin.
    - `axes`: F [m]; its columns are the edges, so that `axes[..., :, 0]` is the first edge.
    """

    centre: Points
    axes: Axes

    @classmethod
    def square(cls, centre: Points, side: FloatLike) -> "Footprint":
        """A square along x and y with sides of `side` [m], one for all centres or one each."""
        xp = np if isinstance(centre, np.ndarray) else jnp
        sides = xp.broadcast_to(xp.asarray(side, centre.dtype), centre.shape[:-1])
        return cls(centre, sides[..., None, None] * xp.eye(2, dtype=centre.dtype))

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the batch."""
        return np.broadcast_shapes(self.centre.shape[:-1], self.axes.shape[:-2])


class Probes(eqx.Module):
    """Isotropic probes evenly spaced along the longer axis of a footprint, centred on it."""

    count: int = eqx.field(static=True)
    step: Float[Array, "*b 2"]  # [m] from one probe to the next
    variance: Float[Array, "*b"]  # [m²] of each probe, along any direction

    def offset(self, number: Float[Array, ""]) -> Float[Array, "*b 2"]:
        """Where probe 0, 1, … lies from the centre [m]."""
        return (number - 0.5 * (self.count - 1)) * self.step


def probes_of(axes: Float[Array, "*b 2 2"], count: int) -> Probes:
    """`count` probes with the second moments of a footprint.

    With principal variances V ≥ v and P probes each has the variance max(v, V/P²), and they are spread so that their
    positions make up the rest of V. The longer axis is thus always right; the shorter one is too wide where the
    footprint is more than P times as long as it is wide.

    **Arguments:** `axes`: F [m]; `count`: P.
    """
    second = axes @ jnp.swapaxes(axes, -1, -2) / 12
    xx, yy, xy = second[..., 0, 0], second[..., 1, 1], second[..., 0, 1]
    middle, half = 0.5 * (xx + yy), safe_norm(0.5 * (xx - yy), xy)
    # The smaller eigenvalue as a quotient: the difference of middle and half would cancel.
    longer = middle + half
    determinant = axes[..., 0, 0] * axes[..., 1, 1] - axes[..., 0, 1] * axes[..., 1, 0]
    extended = longer > 0
    shorter = jnp.where(extended, (determinant / 12) ** 2 / jnp.where(extended, longer, 1.0), 0.0)
    if count == 1:
        return Probes(1, jnp.zeros(axes.shape[:-1], axes.dtype), longer)
    variance = jnp.maximum(shorter, longer / count**2)
    spacing = safe_sqrt(12 * (longer - variance) / (count**2 - 1))
    angle = 0.5 * safe_angle(0.5 * (xx - yy), xy)
    direction = jnp.stack([jnp.cos(angle), jnp.sin(angle)], axis=-1)
    return Probes(count, spacing[..., None] * direction, variance)


def check_probes(probes: int) -> None:
    """Raise unless `probes` is a sensible number."""
    if not 1 <= probes <= MOST_PROBES:
        raise ValueError(f"Argument `probes` must be 1 to {MOST_PROBES}, but is {probes}.")
