"""Images in bands of rows: temporary arrays stay small, and what a band does not need is not computed."""

from jaxtyping import Array, Shaped

MOST = 24
"""Bands of an image, or the largest number below that divides its rows."""


def cut(values: Shaped[Array, "rows *b"]) -> Shaped[Array, "band some *b"]:
    """The bands of an image, upper ones first."""
    rows = values.shape[0]
    bands = max(part for part in range(1, MOST + 1) if rows % part == 0)
    return values.reshape(bands, rows // bands, *values.shape[1:])


def join(values: Shaped[Array, "band some *b"]) -> Shaped[Array, "rows *b"]:
    """The image of its bands."""
    return values.reshape(values.shape[0] * values.shape[1], *values.shape[2:])
