"""One frame of the default sea: 4 patterns of 256², eight real fields each, and the Jacobian."""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from rich.console import Console
from rich.table import Table

import jaxocean as jo

from ._fftw_frames import (
    HalfPlane,
    best_fftw_frame,
    core_count,
    numpy_frame,
    plain_fftw_frame,
    scipy_frame,
)
from ._timing import COUNTED, WARM, interleave

THREADS = 2
STEP = 1 / 32  # s between frames
OURS, UNPACKED, ONE = "jaxocean", "jaxocean, unpacked", "jaxocean, in one jit"
PLAIN, BEST, BARE = "pyFFTW, plain", "pyFFTW, best", "XLA, bare packed FFTs"
TARGETS = {PLAIN: 0.8, BEST: 1.0, BARE: 3.0}


@jax.jit
def jacobian(fields: jo.surface.Fields) -> jax.Array:
    """j of each pattern; only the strain is unpacked."""
    return jo.whitecaps.jacobian(fields.strain)


@jax.jit
def unpack(fields: jo.surface.Fields) -> tuple[jax.Array, ...]:
    """Every field copied into its own array, vectors along the last axis, and j."""
    strain = fields.strain
    return fields.height, fields.displacement, fields.slope, strain, jo.whitecaps.jacobian(strain)


@eqx.filter_jit
def in_one_program(sea: jo.surface.Sea, time: jax.Array) -> tuple[jo.surface.Fields, jax.Array]:
    """The frame as a part of a user's own compiled function."""
    fields = sea.fields(time)
    return fields, jo.whitecaps.jacobian(fields.strain)


@jax.jit
def bare_transforms(planes: jax.Array) -> jax.Array:
    """The 16 complex transforms that a frame cannot do without."""
    return jnp.fft.ifft2(planes)


def run(*, quick: bool = False) -> None:
    rounds = 3 if quick else 60
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed=np.float32(10.0)))
    cascade = jo.surface.Cascade()
    sea = jo.surface.realise(spectrum, cascade, key=jax.random.key(0))
    half = HalfPlane(sea)
    shape = (cascade.count, 4, cascade.resolution, cascade.resolution)
    planes = jax.random.normal(jax.random.key(1), shape, jnp.complex64)
    times = [jnp.asarray(STEP * (i + 1), jnp.float32) for i in range(rounds * (WARM + COUNTED))]

    frames = {
        "numpy": numpy_frame(half),
        "scipy.fft": scipy_frame(half, THREADS),
        PLAIN: plain_fftw_frame(half, THREADS),
        BEST: best_fftw_frame(half, THREADS, STEP),
    }
    differences = _differences(sea, frames)

    contestants: dict[str, Callable[[int], object]] = {
        name: (lambda i, frame=frame: frame(STEP * (i + 1))) for name, frame in frames.items()
    }
    contestants[BARE] = lambda i: bare_transforms(planes).block_until_ready()

    def ours(i: int) -> object:
        fields = sea.fields(times[i])
        return jax.block_until_ready((fields, jacobian(fields)))

    contestants[OURS] = ours
    contestants[UNPACKED] = lambda i: jax.block_until_ready(unpack(sea.fields(times[i])))
    contestants[ONE] = lambda i: jax.block_until_ready(in_one_program(sea, times[i]))
    for contestant in contestants.values():
        contestant(0)
    timings = interleave(contestants, rounds)

    reference = timings[OURS]
    table = Table(title=f"A frame of 4×256², 8 real fields and j, float32, {core_count()} cores")
    columns = ("", "median ms", "best ms", "quartiles ms", "jaxocean / it", "(best)", "target", "difference")
    for column in columns:
        table.add_column(column, justify="left" if not column else "right")
    for name, timing in timings.items():
        target = f"≤ {TARGETS[name]:g}" if name in TARGETS else ""
        table.add_row(
            name,
            f"{timing.median:.2f}",
            f"{timing.best:.2f}",
            f"{timing.spread:.2f}",
            f"{reference.median / timing.median:.2f}",
            f"{reference.best / timing.best:.2f}",
            target,
            f"{differences[name]:.1e}" if name in differences else "",
        )
    console = Console(width=110)
    console.print(table)
    console.print(
        f"Medians of {rounds} interleaved runs of {COUNTED} frames. "
        "Difference: largest deviation of a first frame from ours, in standard deviations of the field."
    )


def _differences(sea: jo.surface.Sea, frames: dict) -> dict[str, float]:
    """How far each contestant's first frame is from ours: a benchmark of wrong results measures nothing."""
    height, displacement, slope, strain, folding = unpack(sea.fields(STEP))
    ours = jnp.concatenate([height[..., None], strain, displacement, slope], axis=-1)
    expected = np.concatenate(
        [np.moveaxis(np.asarray(ours), -1, 1), np.asarray(folding)[:, None] - 1], axis=1
    )
    scale = expected.std(axis=(-2, -1), keepdims=True)
    differences = {}
    for name, frame in frames.items():
        fields, folding = frame(STEP)
        found = np.concatenate([fields, folding[:, None] - 1], axis=1)
        differences[name] = float(np.max(np.abs(found - expected) / scale))
    return differences
