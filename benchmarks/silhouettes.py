"""How much of an image loss's gradient comes from crests and horizon that move across pixels."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from rich.console import Console
from rich.table import Table

import jaxocean as jo
from jaxocean.render import Camera, Raster

SIZE = (90, 160)
VIEWS = {
    "45 m, steeply down": (45.0, 0.9),
    "20 m, no horizon": (20.0, 0.55),
    "12 m, horizon in view": (12.0, 0.2),
    "6 m, among crests": (6.0, 0.03),
}
"""Height [m] and pitch [rad] of the camera."""

NAMES = ("U10", "direction", "λ", "ε", "sun elevation", "camera height", "camera pitch")
STEPS = (3e-3, 3e-4, 3e-4, 3e-4, 3e-4, 1e-3, 3e-5)
"""For central differences."""

AWAY = (0.5, 0.02, 0.03, 0.02, 0.03, 0.1, 0.002)
"""How far from the target the gradient is taken."""

SPEED = 14.0


def run(*, quick: bool = False) -> None:
    """Print for each view and number the error of the whole derivative and of that without moving silhouettes, each as
    a share of the central difference."""
    size, views = ((18, 32), dict(list(VIEWS.items())[2:3])) if quick else (SIZE, VIEWS)
    cascade = jo.surface.Cascade((120.0, 17.0), 32) if quick else jo.surface.Cascade((250.0, 53.0, 11.0), 128)
    table = Table(
        title=f"L2 loss of tone-mapped pictures, {size[1]}×{size[0]} pixels, U10 = {SPEED:g} m/s: error of derivatives"
    )
    table.add_column("view")
    for name in NAMES:
        table.add_column(name, justify="right")
    with jax.enable_x64(True):
        noise = jo.surface.draw_noise(cascade, key=jax.random.key(3))
        draw = jax.jit(partial(_picture, noise=noise, cascade=cascade, size=size, method=Raster(2.0)))
        programs = [
            jax.jit(partial(_derivatives, noise=noise, cascade=cascade, size=size, method=method))
            for method in (Raster(2.0), Raster(2.0, moving_silhouettes=False))
        ]
        for name, (height, pitch) in views.items():
            truth = jnp.asarray([SPEED, 0.3, 1.0, 0.7, 0.6, height, pitch])
            x = truth + jnp.asarray(AWAY)
            target = draw(truth)
            whole, held = (np.asarray(program(x, target)) for program in programs)
            exact = np.asarray(
                [
                    (_loss(draw(x + step * way), target) - _loss(draw(x - step * way), target)) / (2 * step)
                    for way, step in zip(jnp.eye(x.size), STEPS, strict=True)
                ]
            )
            for words, found in (("all", whole), ("silhouettes held", held)):
                errors = (f"{100 * one:.1f} %" for one in np.abs(found / exact - 1))
                table.add_row(f"{name}: {words}", *errors)
    console = Console(width=140)
    console.print(table)
    console.print(
        "What a second line has beyond the first is the share of the derivative that moving silhouettes make."
    )


def _loss(picture: jax.Array, target: jax.Array) -> jax.Array:
    tone = jo.imagery.Filmic(4.0)
    return jnp.mean(jnp.square(tone(picture) - tone(target)))


def _derivatives(x: jax.Array, target: jax.Array, **scene) -> jax.Array:
    """One number after the other: one program to compile for all."""

    def along(way: jax.Array) -> jax.Array:
        return jax.jvp(lambda x: _loss(_picture(x, **scene), target), (x,), (way,))[1]

    return jax.lax.map(along, jnp.eye(x.size))


def _picture(
    x: jax.Array,
    *,
    noise: jax.Array,
    cascade: jo.surface.Cascade,
    size: tuple[int, int],
    method: Raster,
) -> jax.Array:
    ocean = jo.Ocean(
        jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(x[0], x[1])), cascade, noise=noise),
        choppiness=x[2],
        threshold=x[3],
        sky=jo.optics.sky.HosekWilkie(2.5, sun_elevation=x[4], sun_azimuth=2.0),
    )
    position = jnp.stack([jnp.zeros_like(x[5]), jnp.zeros_like(x[5]), x[5]])
    camera = Camera(position, heading=0.4, pitch=x[6], field_of_view=0.7)
    return jo.render.render(ocean, camera, 0.0, size, method=method)
