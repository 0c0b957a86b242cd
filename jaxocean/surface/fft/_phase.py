"""The phase ωt of every wave, exact to float32 rounding however long the sea has run."""

import math
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ..._constants import GRAVITY
from ..._types import Scalar, ScalarLike
from ...spectra import Dispersion
from ._cascade import Cascade
from ._cells import lattice_indices

TURN = 2.0**32  # one turn in the units of whole-number phases, whose overflow is then free of charge


class Clock(NamedTuple):
    """A time, split into whole beats and the rest.

    In float32 the phase is `ticks · beats` modulo 2³² in whole numbers plus `rate · rest`: neither loses
    digits.
    """

    beats: Int[Array, ""] | np.int32
    rest: Scalar | np.floating
    seconds: Scalar | np.floating


def split_time(time: ScalarLike, repeat_period: float | None, dtype: jnp.dtype) -> Clock:
    """Whole seconds and the rest [s]; with a repeat period, parts of the period in 2³²nds.

    A plain Python number is split in double precision, before it becomes an array.
    """
    if np.ndim(time) != 0:
        raise ValueError(
            f"Argument `time` must be one number, but has shape {np.shape(time)}: batch with `jax.vmap`."
        )
    if isinstance(time, jax.Array):
        return _split_array(time, repeat_period, jnp.dtype(dtype))
    seconds = float(time)
    if not math.isfinite(seconds):
        raise ValueError(f"Argument `time` must be finite, but is {seconds} s.")
    number = np.dtype(dtype).type
    if repeat_period is not None:
        seconds = seconds % repeat_period
        beats = round(seconds / repeat_period * TURN)
        return Clock(_wrap(beats), number(0), number(seconds))
    whole = round(seconds)
    return Clock(_wrap(whole), number(seconds - whole), number(seconds))


@partial(jax.jit, static_argnums=(1, 2))
def _split_array(time: Scalar, repeat_period: float | None, dtype: jnp.dtype) -> Clock:
    seconds = time.astype(dtype)
    if repeat_period is not None:
        seconds = seconds - jax.lax.stop_gradient(jnp.floor(seconds / repeat_period)) * repeat_period
        part = jax.lax.stop_gradient(seconds) / repeat_period
        # Two halves of 16 bits each, since the whole does not fit a signed 32-bit number.
        high = jnp.floor(part * 2.0**16)
        low = jnp.round((part * 2.0**16 - high) * 2.0**16)
        beats = high.astype(jnp.int32) * 2**16 + low.astype(jnp.int32)
        return Clock(beats, seconds - jax.lax.stop_gradient(seconds), seconds)
    whole = jax.lax.stop_gradient(jnp.round(seconds))
    return Clock(whole.astype(jnp.int32), seconds - whole, seconds)


def _wrap(number: int) -> np.int32:
    return np.uint32(number % int(TURN)).astype(np.int32)


def phase(rate: Float[Array, "*s"], ticks: Int[Array, "*s"] | None, clock: Clock) -> Float[Array, "*s"]:
    """ωt in turns, reduced to [−½, ½]."""
    if ticks is None:
        turns = rate * clock.seconds
        return turns - jax.lax.stop_gradient(jnp.round(turns))
    whole = (ticks * clock.beats).astype(rate.dtype) * (1.0 / TURN)
    # The middle term is 0: it carries the derivative that the whole-number product hides.
    hidden = (rate - jax.lax.stop_gradient(rate)) * (clock.seconds - clock.rest)
    turns = whole + hidden + rate * clock.rest
    return turns - jax.lax.stop_gradient(jnp.round(turns))


def wave_rate(
    cascade: Cascade, dispersion: Dispersion, repeat_period: float | None, dtype: jnp.dtype
) -> tuple[Float[Array, "pattern y x"], Int[Array, "pattern y x"] | None]:
    """Frequencies ω/2π [1/s] of all waves and, for float32, the same per beat in 2⁻³² turns.

    With a repeat period T each frequency is the nearest multiple of 1/T, so that the sea is the same after T.
    """
    i = jnp.asarray(lattice_indices(cascade.resolution))
    square = (i[:, None] ** 2 + i**2)[None]
    m = jnp.sqrt(square.astype(dtype))
    width = jnp.asarray(2 * np.pi / np.asarray(cascade.sizes), dtype)[:, None, None]
    k = m * width
    rate = dispersion.frequency(k) * (0.5 / np.pi)
    if repeat_period is not None:
        cycles = jnp.round(rate * repeat_period)
        ticks = cycles.astype(jnp.int32) if dtype == jnp.float32 else None
        return cycles / repeat_period, ticks
    if dtype != jnp.float32:
        return rate, None
    high, low = _accurate_rate(cascade, square, m, jax.lax.stop_gradient(dispersion.stiffening(k)))
    fraction = (high - jnp.round(high)) * TURN
    ticks = fraction.astype(jnp.int32) + jnp.round(low * TURN).astype(jnp.int32)
    return rate, ticks


def _accurate_rate(
    cascade: Cascade,
    square: Int[Array, "1 y x"],
    m: Float[Array, "1 y x"],
    stiffening: Float[Array, "pattern y x"],
) -> tuple[Float[Array, "pattern y x"], Float[Array, "pattern y x"]]:
    """ω/2π = √(g m s / 2πL) as a sum of two float32, good to 2⁻³⁵ of its value where s = 1.

    A frequency rounded to float32 is 0.2 rad off after a day. High parts hold 12 bits, so that products of
    two of them are exact, whether or not the compiler contracts a product and a sum into one operation.
    """
    factor = GRAVITY / (2 * np.pi * np.asarray(cascade.sizes))
    factor_high = (factor.astype(np.float32).view(np.int32) & np.int32(-4096)).view(np.float32)
    factor_low = jnp.asarray(factor - factor_high, jnp.float32)[:, None, None]
    factor_high = jnp.asarray(factor_high)[:, None, None]
    moves = square > 0
    m = jnp.where(moves, m, 1.0)
    square = jnp.where(moves, square, 1).astype(jnp.float32)

    m_high = _head(m)
    m_low = (square - m_high * m_high) / (m_high + m)
    product = factor_high * m_high
    rest = factor_high * m_low + factor_low * m_high + factor_low * m_low
    s_high = _head(stiffening)
    head = _head(product)
    scaled = head * s_high
    rest = head * (stiffening - s_high) + (product - head + rest) * stiffening
    high = _head(jnp.sqrt(scaled + rest))
    low = (scaled - high * high + rest) / (high + jnp.sqrt(scaled + rest))
    return jnp.where(moves, high, 0.0), jnp.where(moves, low, 0.0)


def _head(x: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """The leading 12 bits of a float32."""
    bits = jax.lax.bitcast_convert_type(x, jnp.int32) & jnp.int32(-4096)
    return jax.lax.bitcast_convert_type(bits, jnp.float32)
