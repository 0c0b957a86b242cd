"""Textures with all levels of a periodic field, made to be read by many pixels at once."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

BEFORE, AFTER = 1, 2
"""Texels repeated from the other side before and after each row and column: no look-up has to wrap around."""

BORDER = BEFORE + AFTER

LARGEST = 32767.0
"""Of a signed number of 16 bits."""


def halved(values: Float[Array, "*b y x"], side: int) -> Float[Array, "*b rows columns"]:
    """Means over boxes of side × side."""
    if side == 2:
        pairs = values[..., 0::2, :] + values[..., 1::2, :]
        return 0.25 * (pairs[..., 0::2] + pairs[..., 1::2])
    rows, columns = (count // side for count in values.shape[-2:])
    return jnp.mean(values.reshape(*values.shape[:-2], rows, side, columns, side), axis=(-3, -1))


def bordered(levels: list[Array]) -> Array:
    """All levels below one another, in rows of one length, with texels repeated around each."""
    stride = levels[0].shape[-1] + BORDER
    rows = []
    for values in levels:
        count = values.shape[-1]
        around = np.arange(-BEFORE, count + AFTER) % count
        empty = jnp.zeros((*values.shape[:-2], around.size, stride - around.size), values.dtype)
        rows.append(jnp.concatenate([values[..., around, :][..., around], empty], axis=-1))
    texture = jnp.concatenate(rows, axis=-2)
    return texture.reshape(*texture.shape[:-2], -1)


class Spot(NamedTuple):
    """Between four texels: that to the south-west, how far on the next row is, and the shares of the others.

    **Arguments:** `texel`: its number; `stride`: of rows; `east`, `north`: shares of the neighbours to those sides.
    """

    texel: Int[Array, "*b"]
    stride: int
    east: Float[Array, "*b"]
    north: Float[Array, "*b"]


def read(texels: Float[Array, " texel"], start: int, spot: Spot) -> Float[Array, "*b"]:
    """Bilinear in the texture that begins at `start`."""

    def row(offset: int) -> Float[Array, "*b"]:
        west, east = (
            texels.at[spot.texel + (start + offset + i)].get(mode="promise_in_bounds") for i in (0, 1)
        )
        return west + spot.east * (east - west)

    south = row(0)
    return south + spot.north * (row(spot.stride) - south)


def slopes(
    texels: Float[Array, " texel"], spot: Spot
) -> tuple[Float[Array, "*b"], Float[Array, "*b"], Float[Array, "*b"]]:
    """`read` from one texture, and how fast that changes with the shares `east` and `north`."""

    def texel(offset: int) -> Float[Array, "*b"]:
        return texels.at[spot.texel + offset].get(mode="promise_in_bounds")

    a, b, c, d = (texel(offset) for offset in (0, 1, spot.stride, spot.stride + 1))
    south, north = b - a, d - c
    upwards = (c - a) + spot.east * (north - south)
    return a + spot.east * south + spot.north * upwards, south + spot.north * (north - south), upwards


def corners(spot: Spot) -> list[tuple[Int[Array, "*b"], Float[Array, "*b"]]]:
    """The four texels around a spot, and the weight of each."""
    east, north = spot.east, spot.north
    shares = ((1 - east) * (1 - north), east * (1 - north), (1 - east) * north, east * north)
    return [
        (spot.texel + i, share) for i, share in zip((0, 1, spot.stride, spot.stride + 1), shares, strict=True)
    ]


class Pairs(eqx.Module):
    """Textures of 16 bits, each texel with its neighbour to the east in one number: half as many are read.

    **Arguments:** `textures`: bits of two whole numbers, as floating-point numbers, which XLA reads sixteen at once;
    `steps`: what 1 stands for, of each channel and pattern.
    """

    textures: Float[Array, "channel pattern texel"]
    steps: Float[Array, "channel pattern"]

    @classmethod
    def of_levels(cls, levels: list[Float[Array, "channel pattern _ _"]]) -> "Pairs":
        """Rounded from all levels, finest first; without derivative."""
        levels = [jax.lax.stop_gradient(values) for values in levels]
        largest = jnp.max(jnp.abs(levels[0]), axis=(-2, -1))
        scale = jnp.where(largest > 0, LARGEST / jnp.where(largest > 0, largest, 1.0), 0.0)
        both = []
        for values in levels:
            whole = jnp.round(values * scale[..., None, None]).astype(jnp.int32)
            both.append((whole & 0xFFFF) | (jnp.roll(whole, -1, axis=-1) << 16))
        bits = jax.lax.bitcast_convert_type(bordered(both), jnp.float32)
        return cls(bits, largest / LARGEST)


def read_pairs(texels: Float[Array, " texel"], start: int, spot: Spot) -> Float[Array, "*b"]:
    """`read` from the textures of `Pairs`, in whole numbers."""

    def row(offset: int) -> Float[Array, "*b"]:
        bits = texels.at[spot.texel + (start + offset)].get(mode="promise_in_bounds")
        both = jax.lax.bitcast_convert_type(bits, jnp.int32)
        west, east = ((both << 16) >> 16).astype(spot.east.dtype), (both >> 16).astype(spot.east.dtype)
        return west + spot.east * (east - west)

    south = row(0)
    return south + spot.north * (row(spot.stride) - south)
