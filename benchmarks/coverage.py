"""Whitecaps that a camera sees against a hard indicator at many points of every pixel, near and far."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from rich.console import Console
from rich.table import Table

import jaxocean as jo
from jaxocean.render import Camera, Visible, map_visible, seen_coverage
from jaxocean.surface import Cascade, Fields
from jaxocean.whitecaps import FastClosure, realised_coverage

from ._hard_indicator import counted_foam, look_closely

SPEEDS = (10.0, 16.0)  # m/s
HEIGHTS = (20.0, 100.0, 500.0, 4600.0)  # m
SIZE, ACROSS = (90, 160), 16
VIEWS = 8
THRESHOLD = 0.6
SHIFTS = 64  # arrangements of the patterns on which the whole tile is counted
TARGET = 0.1


def run(*, quick: bool = False) -> None:
    """Print the share of images that is foam, in the picture and counted, for each wind speed and height: the means
    over several views, their ratio, and the least and the most that it is in a single one."""
    size, across, heights, views = ((18, 32), 8, HEIGHTS[1:3], 2) if quick else (SIZE, ACROSS, HEIGHTS, VIEWS)
    cascade = Cascade((120.0,), 64) if quick else Cascade()
    draw = eqx.filter_jit(lambda fields, camera: _mean_coverage(fields, cascade, camera, size))
    look = eqx.filter_jit(lambda fields, camera: look_closely(fields, cascade, camera, size, across))
    pixels = f"{size[1]}×{size[0]} pixels, {across}×{across} points in each"
    table = Table(title=f"Foam in {pixels}, ε = {THRESHOLD:g}, {views} views")
    for column in ("U10 (m/s)", "height (m)", "picture", "counted", "ratio", "single views"):
        table.add_column(column, justify="right")
    furthest = 0.0
    for speed in SPEEDS:
        fields = _fields(speed, cascade)
        for height in heights:
            found = []
            for camera in _cameras(height, views):
                counted, _ = counted_foam(look(fields, camera), fields, cascade, camera, THRESHOLD)
                found.append((float(draw(fields, camera)), counted))
            picture, reference = np.mean(found, axis=0)
            each = [drawn / counted if counted > 0 else np.inf for drawn, counted in found]
            furthest = max(furthest, abs(picture / reference - 1))
            shares = f"{picture:.5f}", f"{reference:.5f}", f"{picture / reference:.2f}"
            table.add_row(f"{speed:g}", f"{height:g}", *shares, f"{min(each):.2f} to {max(each):.2f}")
        tile = float(realised_coverage(fields.strain, THRESHOLD, shifts=1 if quick else SHIFTS))
        table.add_row(f"{speed:g}", "whole tile", "", f"{tile:.5f}", "", "")
    console = Console(width=110)
    console.print(table)
    console.print(f"Means are off by {furthest:.0%} at most (target {TARGET:.0%}).")


def _cameras(height: float, count: int) -> list[Camera]:
    random = np.random.default_rng(0)
    return [
        Camera((x, y, height), heading=heading, pitch=1.0, field_of_view=0.7)
        for x, y, heading in random.uniform((-500.0, -500.0, -np.pi), (500.0, 500.0, np.pi), (count, 3))
    ]


def _fields(speed: float, cascade: Cascade) -> Fields:
    sea = jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(speed)), cascade, key=jax.random.key(0))
    return jo.Ocean(sea).fields(0.0)


def _mean_coverage(fields: Fields, cascade: Cascade, camera: Camera, size: tuple[int, int]) -> jax.Array:
    """Of a picture, over the pixels that see water."""

    def shade(v: Visible) -> tuple[jax.Array, jax.Array]:
        return v.hit, seen_coverage(v.strain, THRESHOLD, FastClosure(), v.area)

    hit, coverage = map_visible(shade, fields, cascade, camera, size)[0]
    return jnp.sum(jnp.where(hit, coverage, 0.0)) / jnp.sum(hit)
