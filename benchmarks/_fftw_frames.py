"""One frame of the sea the classical way: NumPy for the waves, a real inverse FFT for the fields."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pyfftw
import scipy.fft

from jaxocean.surface import Sea

FIELDS = 8  # height, two displacements, two slopes, three strains
Frame = tuple[np.ndarray, np.ndarray]
"""Fields (pattern, field, y, x) and the Jacobian (pattern, y, x)."""


class HalfPlane:
    """The waves with kx ≥ 0 of a sea, and what turns their heights into the spectra of the fields."""

    def __init__(self, sea: Sea) -> None:
        cascade = sea.cascade
        n = cascade.resolution
        half = n // 2 + 1
        index = np.fft.fftfreq(n, 1 / n)
        width = 2 * np.pi / np.asarray(cascade.sizes)[:, None, None]
        kx, ky = np.broadcast_arrays(np.abs(index[:half]) * width, index[:, None] * width)
        k = np.hypot(kx, ky)
        inverse = np.divide(1.0, k, out=np.zeros_like(k), where=k > 0)
        even = [np.ones_like(k), -kx * kx * inverse, -ky * ky * inverse, -kx * ky * inverse]
        odd = [kx * inverse, ky * inverse, kx, ky]
        amplitude = np.asarray(sea.amplitude)
        opposite = np.roll(np.flip(amplitude.conj(), (-2, -1)), 1, (-2, -1))
        self.shape = (cascade.count, FIELDS, n, half)
        self.output = (cascade.count, FIELDS, n, n)
        self.omega = np.asarray(sea.frequency)[..., :half].astype(np.float32)
        self.forth = np.ascontiguousarray(amplitude[..., :half])
        self.back = np.ascontiguousarray(opposite[..., :half])
        self.even = np.stack(even, axis=1).astype(np.float32)
        self.odd = np.stack(odd, axis=1).astype(np.float32)
        self.factors = np.concatenate([self.even, 1j * self.odd], axis=1).astype(np.complex64)


def jacobian(fields: np.ndarray) -> np.ndarray:
    a, b, c = fields[:, 1], fields[:, 2], fields[:, 3]
    return (1 + a) * (1 + b) - c * c


def _waves(half: HalfPlane, time: float) -> np.ndarray:
    turn = np.exp(-1j * (half.omega * np.float32(time)))
    return half.forth * turn + half.back * turn.conj()


def numpy_frame(half: HalfPlane) -> Callable[[float], Frame]:
    """NumPy alone."""

    def frame(time: float) -> Frame:
        spectra = _waves(half, time)[:, None] * half.factors
        fields = np.fft.irfft2(spectra, s=half.output[-2:], norm="forward")
        return fields, jacobian(fields)

    return frame


def scipy_frame(half: HalfPlane, threads: int) -> Callable[[float], Frame]:
    """SciPy's threaded transform."""

    def frame(time: float) -> Frame:
        spectra = _waves(half, time)[:, None] * half.factors
        fields = np.asarray(scipy.fft.irfft2(spectra, s=half.output[-2:], norm="forward", workers=threads))
        return fields, jacobian(fields)

    return frame


def plain_fftw_frame(half: HalfPlane, threads: int) -> Callable[[float], Frame]:
    """pyFFTW as a user would write it: NumPy phases, one batched real inverse transform."""
    spectra = pyfftw.empty_aligned(half.shape, "complex64")
    fields = pyfftw.empty_aligned(half.output, "float32")
    plan = pyfftw.FFTW(
        spectra,
        fields,
        axes=(-2, -1),
        direction="FFTW_BACKWARD",
        flags=("FFTW_MEASURE",),
        threads=threads,
    )

    def frame(time: float) -> Frame:
        np.multiply(_waves(half, time)[:, None], half.factors, out=spectra)
        plan(normalise_idft=False)
        return fields, jacobian(fields)

    return frame


def best_fftw_frame(half: HalfPlane, threads: int, step: float) -> Callable[[float], Frame]:
    """The fastest that we can write with pyFFTW for frames a fixed `step` [s] apart.

    Phases advance by one tabulated rotation instead of sines and cosines; factors are real; every array is
    contiguous and reused; each thread takes whole patterns from the waves to the Jacobian, so that their
    planes stay in its cache.
    """
    count, n = half.output[0], half.output[-1]
    width = half.shape[-1]
    rotation = np.exp(-1j * half.omega.astype(np.float64) * step).astype(np.complex64)
    forth, back = half.forth.copy(), half.back.conj()
    even, odd = (np.repeat(table, 2, axis=-1) for table in (half.even, half.odd))
    spectra = pyfftw.empty_aligned(half.shape, "complex64")
    fields = pyfftw.empty_aligned(half.output, "float32")
    folding = np.empty((count, n, n), np.float32)
    square = np.empty((count, n, n), np.float32)
    height = np.empty((count, n, width), np.complex64)
    turned = np.empty((count, n, width), np.complex64)
    plans = [
        pyfftw.FFTW(
            spectra[i],
            fields[i],
            axes=(-2, -1),
            direction="FFTW_BACKWARD",
            flags=("FFTW_MEASURE",),
            threads=1,
        )
        for i in range(count)
    ]

    def pattern(i: int) -> None:
        # back holds the conjugate of its wave, so that one rotation serves both directions.
        np.multiply(forth[i], rotation[i], out=forth[i])
        np.multiply(back[i], rotation[i], out=back[i])
        np.conjugate(back[i], out=height[i])
        np.add(height[i], forth[i], out=height[i])
        np.negative(height[i].imag, out=turned[i].real)
        turned[i].imag = height[i].real
        planes = spectra[i].view(np.float32)
        np.multiply(height[i].view(np.float32), even[i], out=planes[:4])
        np.multiply(turned[i].view(np.float32), odd[i], out=planes[4:])
        plans[i](normalise_idft=False)
        _, a, b, c = fields[i, :4]
        np.add(a, 1, out=folding[i])
        np.multiply(folding[i], b, out=square[i])
        np.add(folding[i], square[i], out=folding[i])
        np.multiply(c, c, out=square[i])
        np.subtract(folding[i], square[i], out=folding[i])

    pool = ThreadPoolExecutor(threads)

    def frame(time: float) -> Frame:
        list(pool.map(pattern, range(count)))
        return fields, folding

    return frame


def core_count() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
