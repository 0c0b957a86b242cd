"""How much a sequence flickers."""

from collections import deque
from collections.abc import Sequence
from pathlib import Path

import imageio.v3 as imageio
import numpy as np


def flicker(pictures: Sequence[Path], reference: Sequence[Path] | None = None) -> np.ndarray:
    """Root-mean-square second difference in time of each row of pixels.

    $$ \\sqrt{\\overline{(p_{t-1} - 2 p_t + p_{t+1})^2}} $$

    Steady motion of smooth things has a small one, what comes and goes from frame to frame a large one.

    **Arguments:** `pictures`: at least three files of one size; `reference`: as many, to be subtracted first: what is
    left is the flicker of the error.

    **Returns:** one number for each row, in steps of the 255 of a code value; three files are held at a time.
    """
    last: deque[np.ndarray] = deque(maxlen=3)
    total, count = 0.0, 0
    for number, file in enumerate(pictures):
        picture = np.asarray(imageio.imread(file), np.float32)
        if reference is not None:
            picture = picture - np.asarray(imageio.imread(reference[number]), np.float32)
        last.append(picture)
        if len(last) == 3:
            before, now, after = last
            total = total + np.mean((before - 2 * now + after) ** 2, axis=(1, 2))
            count += 1
    return np.sqrt(total / count)


def relative_flicker(values: np.ndarray) -> float:
    """Root-mean-square second difference of numbers in time, over their mean; NaN if that is 0."""
    mean = float(np.mean(values))
    second = values[:-2] - 2 * values[1:-1] + values[2:]
    return float(np.sqrt(np.mean(second**2))) / mean if mean > 0 else float("nan")
