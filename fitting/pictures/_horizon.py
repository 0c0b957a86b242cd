"""Where the horizon runs in a photograph, and so how the camera was held."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean.optics import luminance

from .._errors import FitError

COLUMNS = 240
"""Columns [pixels] of the image in which the horizon is sought first: waves and noise are averaged away."""

STEEPEST = 0.5
"""Tangent of the steepest horizon that is looked for."""

STRIP = 0.06
"""Height of the strips above and below it that are compared, as a share of the image's height."""

BLOCKS = 24
"""Parts of the width that are taken to differ by chance."""

SMOOTH = 1e-2
"""Change of light from pixel to pixel below which everything is smooth: noise of cameras, and slow gradients."""

ALIKE = 0.02, 0.01, 0.01, 0.05
"""What chance is at least, of light, two colours and roughness: a sky without noise changes little, but everywhere
alike."""

LEAST = 15.0
"""How many times larger than by chance the step across it must be to count as a horizon."""


@dataclass(frozen=True)
class Horizon:
    """A straight horizon.

    - `row`: where it crosses the middle column, in pixels from the upper edge; negative or beyond the last row if it
      leaves the image there.
    - `slope`: rows down for each column to the right.
    - `step`: how large the change across it is, in standard errors.
    - `size`: rows and columns of the image.
    """

    row: float
    slope: float
    step: float
    size: tuple[int, int]

    def angles(self, field_of_view: float) -> tuple[float, float]:
        """Pitch and roll [rad], as `jaxocean.render.Camera` has them, if that is the vertical field of view [rad].

        $$ \\tan p = d/f, \\quad \\tan r = \\mathrm{d}y/\\mathrm{d}x $$

        with the distance d of the line from the middle of the image, above it positive, and the focal length f.
        The horizon is taken to be level: from 10 m above the water it lies 2 mrad below.
        """
        focal = 0.5 * self.size[0] / np.tan(0.5 * field_of_view)
        above = 0.5 * (self.size[0] - 1) - self.row
        distance = above / np.hypot(1.0, self.slope)
        return float(np.arctan2(distance, focal)), float(np.arctan(self.slope))


def find_horizon(
    image: Float[Array, "rows columns 3"] | Float[np.ndarray, "rows columns 3"],
    mask: Float[Array, "y x"] | Float[np.ndarray, "y x"] | None = None,
) -> Horizon:
    """The line across which sky turns into sea.

    Of all lines that cross the image the one with the largest Hotelling T² of what changes from the strip above to the
    strip below: the logarithm of light, two ratios of colours, and how much light varies from pixel to pixel. What
    changes alike along the whole width is a horizon; crests and clouds are not. Within a few strips of the line found,
    it then lies where the step is largest in the direction that tells sky from sea best. A sky that darkens towards the
    horizon moves it by about a pixel, and an image that ends just below the horizon can be taken to show one.

    **Arguments:** `image`: linear light in any unit; `mask`: 0 where the image shows something else, such as a mast.

    **Returns:** `Horizon`.

    **Raises:** `ValueError` for an image of fewer than 16 pixels a side or a mask of another size; `FitError` if there
    is no line along which the image changes much more than by chance.

    **Source:** Hotelling 1931 for T²; the rest is our own.
    """
    image = np.asarray(image, float)
    rows, columns, _ = image.shape
    if min(rows, columns) < 16:
        raise ValueError(f"Argument `image` must have at least 16 pixels a side, but has {rows}×{columns}.")
    seen = np.ones((rows, columns)) if mask is None else np.asarray(mask, float)
    if seen.shape != (rows, columns):
        raise ValueError(
            f"Argument `mask` must have the {rows}×{columns} pixels of the image, but has "
            f"{'×'.join(map(str, seen.shape))}."
        )
    reduced = max(columns / COLUMNS, 1.0)
    features = _features(image, reduced)
    weight = _reduced(seen, reduced)
    best, line = -1.0, (0.0, 0.0)
    height, width = weight.shape
    strip = max(STRIP * height, 2.0)
    reach = np.arange(strip, height - strip, 1.0)
    sums = _sums(features, weight)
    for middle in reach[:: max(1, int(height / 60))]:
        for tilt in np.linspace(-STEEPEST, STEEPEST, 41):
            score = _step(sums, middle, tilt, strip)
            if score > best:
                best, line = score, (middle, tilt)
    if best < LEAST:
        raise FitError(
            "The image shows no horizon",
            "a view from above, a coast, or haze that hides it",
            "give the camera's pitch and roll",
        )
    row, slope = _refined(features[:-1], weight, *line, strip)
    # Rows are counted from the middles of pixels; the reduced image's are wider.
    return Horizon(
        float((row + 0.5) * rows / height - 0.5),
        float(slope * rows / height * width / columns),
        best,
        (rows, columns),
    )


def _refined(
    features: np.ndarray, weight: np.ndarray, middle: float, tilt: float, strip: float
) -> tuple[float, float]:
    """Where the step is largest from one side to the other of what tells sky from sea best."""
    changes = _changes(_sums(features, weight), middle, tilt, strip)
    mean, spread = changes.mean(axis=0), _spread(changes)
    sums = _sums(np.tensordot(np.linalg.solve(spread, mean), features, 1)[None], weight)
    for finer in (1.0, 0.5, 0.25):
        thin = max(finer * strip, 1.5)
        lines = [
            (middle + down, tilt + turn)
            for down in finer * np.linspace(-4.0, 4.0, 17)
            for turn in finer * np.linspace(-0.025, 0.025, 11)
        ]
        sizes = [np.sum(_changes(sums, *line, thin)) for line in lines]
        middle, tilt = lines[int(np.argmax(sizes))]
    return middle, tilt


def _features(image: np.ndarray, reduced: float) -> np.ndarray:
    """Light, two colours and roughness of the reduced image [feature, row, column]."""
    light = np.asarray(luminance(jnp.asarray(image)), float)
    least = 1e-3 * max(float(np.median(light)), 1e-12)
    logarithm = np.log(np.maximum(image, least))
    own = np.log(np.maximum(light, least))
    # Only now: it takes long to import.
    from scipy import ndimage

    rough = np.abs(np.diff(own, axis=1, append=own[:, -1:])) + np.abs(np.diff(own, axis=0, append=own[-1:]))
    rough = ndimage.uniform_filter(rough, 3)
    planes = own, logarithm[..., 0] - logarithm[..., 1], logarithm[..., 2] - logarithm[..., 1], rough
    *others, rough = (_reduced(plane, reduced) for plane in planes)
    return np.stack([*others, np.log(rough + SMOOTH)])


def _reduced(plane: np.ndarray, factor: float) -> np.ndarray:
    from scipy import ndimage

    return np.asarray(ndimage.zoom(plane, 1 / factor, order=1, grid_mode=True, mode="nearest"), float)


def _sums(features: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Of weighted features, and of weights, from the upper edge to each row [feature, row, column]."""
    weighted = np.concatenate([features * weight, weight[None]])
    return np.concatenate([np.zeros_like(weighted[:, :1]), np.cumsum(weighted, axis=1)], axis=1)


def _step(sums: np.ndarray, middle: float, tilt: float, strip: float) -> float:
    """T, the root of T², of the change across a line."""
    changes = _changes(sums, middle, tilt, strip)
    if len(changes) < BLOCKS // 2:
        return 0.0
    mean = changes.mean(axis=0)
    return float(np.sqrt(len(changes) * mean @ np.linalg.solve(_spread(changes), mean)))


def _spread(changes: np.ndarray) -> np.ndarray:
    return np.atleast_2d(np.cov(changes.T)) + np.diag(np.square(ALIKE[: changes.shape[1]]))


def _changes(sums: np.ndarray, middle: float, tilt: float, strip: float) -> np.ndarray:
    """From the strip above a line to that below, in each part of the width that is seen [part, feature]."""
    _, height, width = sums.shape
    columns = np.arange(width)
    # Row i of the sums is the upper edge of row i of the image.
    line = middle + 0.5 + tilt * (columns - 0.5 * (width - 1))
    inside = (line - strip >= 0) & (line + strip <= height - 1)
    nothing = np.empty((0, len(sums) - 1))
    if np.count_nonzero(inside) < 0.7 * width:
        return nothing
    on, over, under = (_at(sums, edge) for edge in (line, line - strip, line + strip))
    above, below = on - over, under - on
    seen = np.flatnonzero(inside)
    parts = np.linspace(0, seen.size, min(BLOCKS, seen.size) + 1).astype(int)
    upper, lower = (np.add.reduceat(side[:, seen], parts[:-1], axis=1) for side in (above, below))
    whole = np.add.reduceat(np.minimum(above[-1], below[-1])[seen], parts[:-1])
    enough = whole >= 0.25 * strip * np.diff(parts)
    upper, lower = upper[:, enough], lower[:, enough]
    return (lower[:-1] / lower[-1] - upper[:-1] / upper[-1]).T


def _at(sums: np.ndarray, row: np.ndarray) -> np.ndarray:
    """Between rows linear [feature, column]."""
    row = np.clip(row, 0, sums.shape[1] - 1.001)
    whole = np.floor(row).astype(int)
    share = row - whole
    columns = np.arange(sums.shape[2])
    return (1 - share) * sums[:, whole, columns] + share * sums[:, whole + 1, columns]
