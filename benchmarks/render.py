"""A picture with new waves in each frame: time from low and high, its gradient, its memory, and how good it is."""

import resource
import time
from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from rich.console import Console
from rich.table import Table

import jaxocean as jo
from experiments import schema
from experiments.harness._loading import load
from experiments.pictures import _scene
from jaxocean import imagery, optics, render

from ._fftw_frames import core_count
from ._mitsuba_frame import frame_times, installed

SIZE = (720, 1280)
GRADIENT_SIZE = (180, 320)
STEP = 1 / 32  # s between frames
FINE = 8  # times as many rows and columns in the reference
ALTITUDES = (2.0, 20.0, 200.0, 5000.0)  # m
SCENES = ("gale_at_noon", "dupuy_scene6")
SPACINGS = (4.0, 2.0, 1.0)  # pixels
RATES = ((1, 1), (1, 2), (2, 2))  # pixels that share a shaded point
TARGET, GRADIENT_TARGET, MEMORY_TARGET = 150.0, 200.0, 2.0  # ms, ms, GiB
QUALITY_TARGET, AGREEMENT_TARGET = 30.0, 35.0  # dB
FLATNESS_TARGET = 0.3


def run(*, quick: bool = False) -> None:
    """Print times and peak memory; if not `quick`, also the gradient's time, quality, and mesh against rays."""
    size, frames = ((90, 160), 3) if quick else (SIZE, 12)
    # Each is a program to compile.
    rates, altitudes = (RATES[::2], ALTITUDES[1:3]) if quick else (RATES, ALTITUDES)
    config = _config(SCENES[0])
    ocean, camera = _scene.ocean(config), _scene.camera(config.camera)
    console = Console(width=110)
    table = _table(
        f"{size[1]}×{size[0]} pixels, 4×256² waves, float32, {core_count()} cores", "median ms", "best ms"
    )
    table.add_column("processor ms", justify="right")
    table.add_column("target", justify="right")

    start = time.perf_counter()
    jax.block_until_ready(render.render(ocean, camera, 0.0, size))
    first = time.perf_counter() - start
    _row(table, "new waves", _times(lambda t: ocean.fields(t).packed, frames))
    for rate in rates:
        name = f"gale at noon, whole frame, {_words(rate)}"
        _row(table, name, _times(_frame(ocean, camera, size, rate), frames), f"≤ {TARGET:g}")
    heights = []
    for altitude in altitudes:
        above = render.Camera((0.0, 0.0, altitude), heading=2.7, pitch=0.4)
        times = _times(_frame(ocean, above, size), frames)
        heights.append(float(np.median(times[0])))
        _row(table, f"the same sea from {altitude:g} m", times)
    _peer(table, size, frames)
    console.print(table)
    middle = 0.5 * (max(heights) + min(heights))
    console.print(
        f"From {altitudes[0]:g} m to {altitudes[-1]:g} m a frame takes {middle:.0f} ms "
        f"±{100 * (max(heights) / middle - 1):.0f} % (target ±{100 * FLATNESS_TARGET:.0f} %)."
    )
    # ru_maxrss is in kB on Linux.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    console.print(f"First call, mostly compilation: {first:.1f} s.")
    console.print(f"Peak memory of this process so far: {peak:.2f} GiB (target {MEMORY_TARGET:g}).")
    if not quick:
        for rate in (RATES[0], RATES[-1]):
            _gradient(ocean, camera, frames, console, rate)
        _quality(console)
        _agreement(console)


def _config(name: str) -> schema.RenderConfig:
    config = load(name).config
    assert isinstance(config, schema.RenderConfig)
    return config


def _words(rate: tuple[int, int]) -> str:
    return f"one shaded point for {rate[0]}×{rate[1]} pixels"


def _frame(
    ocean: jo.Ocean, camera: render.Camera, size: tuple[int, int], rate: tuple[int, int] = (1, 1)
) -> Callable[[float], jax.Array]:
    method = render.Raster(shading_rate=rate)
    return lambda time: render.render(ocean, camera, time, size, method=method)


def _times(work: Callable[[float], object], frames: int) -> tuple[list[float], float]:
    """Milliseconds of each call, and the mean processor time of one, after two calls that are not counted."""
    for number in range(2):
        jax.block_until_ready(work(STEP * number))
    samples, before = [], time.process_time()
    for number in range(frames):
        start = time.perf_counter()
        jax.block_until_ready(work(STEP * (number + 2)))
        samples.append(1e3 * (time.perf_counter() - start))
    return samples, 1e3 * (time.process_time() - before) / frames


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title)
    table.add_column("")
    for column in columns:
        table.add_column(column, justify="right")
    return table


def _row(table: Table, name: str, times: tuple[list[float], float], target: str = "") -> None:
    samples, processor = times
    table.add_row(name, f"{np.median(samples):.0f}", f"{min(samples):.0f}", f"{processor:.0f}", target)


def _peer(table: Table, size: tuple[int, int], frames: int) -> None:
    name = f"Mitsuba {installed()}, new heights and 1 noisy sample"
    if installed() is None:
        table.add_row("Mitsuba", "not installed", "", "", "")
        return
    found = frame_times(size, frames)
    if found is None:
        table.add_row(name, "does not run", "", "", "")
        return
    variant, samples = found
    table.add_row(f"{name} ({variant})", f"{np.median(samples):.0f}", f"{min(samples):.0f}", "", "")


def _gradient(
    ocean: jo.Ocean, camera: render.Camera, frames: int, console: Console, rate: tuple[int, int]
) -> None:
    """Time of the gradient of an L2 loss for ten parameters of the scene, in the mode that is chosen."""
    cascade, noise = ocean.sea.cascade, jo.surface.draw_noise(ocean.sea.cascade, key=jax.random.key(0))
    position, method = camera.position.astype(jnp.float32), render.Raster(shading_rate=rate)

    def picture(p: jax.Array) -> jax.Array:
        sea = jo.surface.realise(
            jo.spectra.Elfouhaily(jo.Wind(speed=p[0], direction=p[1])), cascade, noise=noise
        )
        scene = jo.Ocean(
            sea,
            choppiness=p[2],
            threshold=p[3],
            sky=optics.sky.HosekWilkie(p[4], 0.1, p[5], p[6]),
            foam=optics.Foam(p[7]),
        )
        view = render.Camera(
            position.at[2].set(p[8]), heading=camera.heading, pitch=p[9], field_of_view=camera.field_of_view
        )
        return render.render(scene, view, 0.0, GRADIENT_SIZE, method=method)

    start = jnp.asarray([20.0, 0.0, 1.0, 0.72, 4.0, 1.0, 0.8, 0.22, 9.0, 0.12], jnp.float32)
    target = jax.block_until_ready(eqx.filter_jit(picture)(1.02 * start))

    gradient = render.value_and_gradient(lambda p: jnp.mean(jnp.square(picture(p) - target)))
    before = time.perf_counter()
    value = jax.block_until_ready(gradient(start)[1])
    first = time.perf_counter() - before
    assert bool(jnp.all(jnp.isfinite(value)))
    samples, processor = _times(lambda t: gradient(start * (1 + 1e-3 * t))[1], frames)
    console.print(
        f"Gradient of an L2 loss of {GRADIENT_SIZE[1]}×{GRADIENT_SIZE[0]} pixels for {start.size} parameters, "
        f"{_words(rate)}: "
        f"{np.median(samples):.0f} ms, best {min(samples):.0f}, processor {processor:.0f} "
        f"(target {GRADIENT_TARGET:g}); first call {first:.0f} s."
    )


def _quality(console: Console) -> None:
    """How far pictures are from the mean of those with 64 times as many pixels."""
    for name in SCENES:
        config = _config(name)
        ocean, camera = _scene.ocean(config), _scene.camera(config.camera)
        fine = np.asarray(render.render(ocean, camera, config.time, (FINE * SIZE[0], FINE * SIZE[1])))
        reference = fine.reshape(SIZE[0], FINE, SIZE[1], FINE, 3).mean(axis=(1, 3))
        tone = imagery.Exposure(_scene.exposure(config, reference))
        for rate in RATES:
            picture = _frame(ocean, camera, SIZE, rate)(config.time)
            value = float(imagery.psnr(tone(picture), tone(jnp.asarray(reference))))
            console.print(
                f"{name}, {_words(rate)}: PSNR {value:.1f} dB against {FINE**2} times as many pixels "
                f"(target {QUALITY_TARGET:g})."
            )


def _agreement(console: Console) -> None:
    """How far the mesh's pictures are from those of rays, by the distance of its vertices."""
    config = _config("render")
    ocean, camera = _scene.ocean(config), _scene.camera(config.camera)
    rays = np.asarray(render.render(ocean, camera, config.time, SIZE, method=render.Rays()))
    exposure = _scene.exposure(config, rays)
    expected = jnp.asarray(_scene.code(config, exposure, rays))
    for spacing in SPACINGS:
        mesh = render.render(ocean, camera, config.time, SIZE, method=render.Raster(spacing))
        value = float(imagery.psnr(jnp.asarray(_scene.code(config, exposure, np.asarray(mesh))), expected))
        console.print(
            f"render, a vertex every {spacing:g} pixels: PSNR {value:.1f} dB against rays "
            f"(target {AGREEMENT_TARGET:g})."
        )
