"""Images in bands of rows: temporary arrays stay small, and what a band does not need is not computed."""

from jaxtyping import Array, Shaped

MOST = 24
"""Bands of an image, or the largest number below that divides its rows."""

FEWEST_PIXELS = 2**14
"""Pixels of a band below which it is not worth its own turn."""


def band_count(size: tuple[int, int]) -> int:
    """Bands of an image of (rows, columns)."""
    rows, columns = size
    most = min(MOST, max(1, rows * columns // FEWEST_PIXELS))
    return max(part for part in range(1, most + 1) if rows % part == 0)


def cut(values: Shaped[Array, "rows *b"], bands: int) -> Shaped[Array, "band some *b"]:
    """The bands of an image, upper ones first; their number must divide its rows."""
    rows = values.shape[0]
    return values.reshape(bands, rows // bands, *values.shape[1:])


def join(values: Shaped[Array, "band some *b"]) -> Shaped[Array, "rows *b"]:
    """The image of its bands."""
    return values.reshape(values.shape[0] * values.shape[1], *values.shape[2:])
