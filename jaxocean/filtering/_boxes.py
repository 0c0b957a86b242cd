"""Means over boxes of samples, and all levels of a pyramid of them in one flat texture."""

from functools import cached_property

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float


def box_means(values: Float[Array, "*b y x c"], side: int) -> Float[Array, "*b rows columns c"]:
    """Exact means over boxes of side × side samples that tile the field.

    **Arguments:** `values`: samples with their channels last; `side`: a divisor of both numbers of samples.

    **Returns:** one mean per box and channel.

    **Raises:** `ValueError` if the boxes do not tile the field.
    """
    *batch, rows, columns, channels = values.shape
    if side < 1 or rows % side or columns % side:
        raise ValueError(f"Argument `side` must divide {rows} and {columns} samples, but is {side}.")
    boxes = values.reshape(*batch, rows // side, side, columns // side, side, channels)
    return jnp.mean(boxes, axis=(-4, -2))


class Levels:
    """The levels of a pyramid over N × N samples: N, N/2, N/4, … samples a side, and at last one.

    Where N = 2^k m with an odd m > 1, the level of m × m is followed by the single mean at once. All levels of one
    pattern lie one behind the other in a flat texture.

    **Arguments:** `resolution`: N.
    """

    def __init__(self, resolution: int) -> None:
        counts = [resolution]
        while counts[-1] % 2 == 0:
            counts.append(counts[-1] // 2)
        if counts[-1] > 1:
            counts.append(1)
        self.counts = np.asarray(counts)

    @property
    def spans(self) -> np.ndarray:
        """Samples a side under one texel of each level."""
        return self.counts[0] // self.counts

    @cached_property
    def offsets(self) -> np.ndarray:
        """Where each level begins, and at last the number of texels of all levels."""
        return np.concatenate([[0], np.cumsum(self.counts**2)])

    def build(self, values: Float[Array, "n y x c"]) -> Float[Array, "n texel c"]:
        """All levels of the fields, each the exact mean over its texels' samples."""
        flat = []
        for count in self.counts:
            values = box_means(values, values.shape[-2] // int(count))
            flat.append(values.reshape(values.shape[0], -1, values.shape[-1]))
        return jnp.concatenate(flat, axis=1)
