"""What a picture of the sea says without regard to where each wave is."""

import itertools

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxocean._numerics import check_kind, is_concrete
from jaxocean._types import Scalar
from jaxocean.optics import luminance
from jaxocean.render import Camera

from ._picture_target import Mask

EDGES = np.radians([0.4, 0.8, 1.6, 3.2, 6.4, 11.0, 18.0])
"""Between the bands, how far below the horizon [rad]: for an eye at 4 m from 570 m to 12 m away."""

SKY = np.radians([-4.0, -0.5])
"""The band above the horizon [rad]."""

LIMIT = 2.0
"""Robust standard deviations to which light is limited before texture is measured: foam and glitter are not texture."""

SOFTNESS = 0.15
"""Of the bands' edges, in the logarithm of the angle below the horizon."""

ALONG = 6
"""Squares of 1, 2, 4, 8, 16 and 32 pixels, of which neighbours are compared along the horizon."""

ACROSS = 3
"""Squares of 1, 2 and 4 pixels, of which neighbours are compared across it."""

DARKEST = 0.05
"""Light [means] that is added before logarithms: a black pixel says no more than a dark one."""

BRIGHT = 3.0
"""Robust standard deviations above the middle of its band at which a pixel begins to count as bright."""

FOAMY = float(np.log(2.0))
"""Logarithm of the light over that of its band at which a pixel counts as foam or glitter in any case."""

DARK = 1e-9
"""Mean light below which an image is black."""

FEW = 3e-4
"""Share of pixels that is added before logarithms."""

FEW_COLOURED = 0.01
"""Share of pixels of the band's own colour that is added to the bright ones."""

PATCH = 16.0
"""Pixels that are alike by being neighbours: how many fewer tell a threshold than there are."""

THIRDS = 3
"""Parts of the width whose light is compared."""


class ImageStatistics(eqx.Module):
    """Numbers of a picture that depend on the sea's state and the light, and on the random waves only by chance.

    In bands between `EDGES` below the horizon, of ℓ = log(Y/mean + 0.05) with the luminance Y and its mean over the
    sea:

    | names | what they are |
    |---|---|
    | `level` | mean ℓ of the band less that of the whole sea |
    | `spread`, `deviation` | ½ log of its variance; log of its robust deviation s |
    | `bright` | log share of pixels above a robust threshold t = m + 3 s |
    | `foam` | log share of pixels twice as bright as the middle of the band |
    | `colour`, `bright colour` | mean log(red/blue) less that of the sea; of bright pixels less that of their band |
    | `along`, `across` | texture: ½ log mean square difference of neighbouring squares of 1, 2, 4 … pixels |
    | `glitter width` | log standard deviation [rad] from side to side of what is brighter than the middle |
    | `left`, `middle` | how light changes from side to side |
    | `relief` | ½ log mean square change from column to column just above the horizon, where crests stand |
    | `sky`, `sky colour` | mean ℓ and log(red/blue) above the horizon less those of the sea |

    Texture, along the horizon and across it, is the spectrum of slopes as the eye sees it; across the farthest band
    there is none. The glitter and the sides are of the farther and of the nearer half.

    Middle m and deviation s are robust (Tukey's biweight), so that whitecaps do not lift the threshold that finds them;
    a pixel counts by a soft step as wide as the threshold itself is uncertain, s √(1/n + 9/2n) with n patches of 4×4
    pixels. All are differentiable, and none knows the exposure. Colours and the sky depend on the white balance and on
    where clouds are, what changes from one pixel to the next on how sharp a camera is, or how finely a picture is
    drawn; `steady` says which numbers do not.

    **Arguments:** `camera`: pitch, roll and field of view say where the bands lie; `size`: rows and columns; `mask`:
    what each pixel counts, 0 to 1.

    **Raises:** `ValueError` for a camera that sees no sea, or a mask of another size.

    **Source:** Mosteller & Tukey 1977 for the biweight; the choice of numbers is our own.
    """

    bands: Float[Array, "band rows columns"]
    above: Float[Array, "rows columns"]
    sideways: Float[Array, "rows columns"]
    size: tuple[int, int] = eqx.field(static=True)

    def __init__(self, camera: Camera, size: tuple[int, int], mask: Mask | None = None) -> None:
        check_kind("camera", camera, Camera, "a `Camera`")
        rays = camera.rays(size).astype(jnp.float32)
        below = jnp.arcsin(jnp.clip(-rays[..., 2], -1.0, 1.0))
        seen = jnp.ones(size, jnp.float32) if mask is None else jnp.asarray(mask, jnp.float32)
        if seen.shape != tuple(size):
            raise ValueError(
                f"Argument `mask` must have the {size[0]}×{size[1]} pixels of the image, but has "
                f"{'×'.join(map(str, seen.shape))}."
            )
        deep = jnp.log(jnp.maximum(below, 1e-4))
        steps = [jax.nn.sigmoid((deep - float(np.log(edge))) / SOFTNESS) for edge in EDGES]
        self.bands = jnp.stack([seen * inner * (1 - outer) for inner, outer in itertools.pairwise(steps)])
        self.above = seen * ((below > float(SKY[0])) & (below < float(SKY[1]))).astype(jnp.float32)
        axes = camera.axes().astype(jnp.float32)
        along, ahead = (jnp.einsum("rci,i->rc", rays, axes[i]) for i in (0, 2))
        self.sideways = jnp.arctan2(along, jnp.maximum(ahead, 1e-6))
        self.size = size
        if is_concrete(self.bands) and float(jnp.sum(self.bands)) < PATCH:
            if mask is not None and np.any(np.asarray(seen) < 1):
                raise ValueError(
                    "Argument `mask` must leave some of the sea below the horizon, but hides it."
                )
            raise ValueError("Argument `camera` must see the sea, but hardly a pixel lies below the horizon.")

    def __call__(self, image: Float[Array, "rows columns 3"]) -> Float[Array, " m"]:
        """The numbers of a picture, in the order of `names`."""
        return jnp.stack(list(self.named(image).values()))

    @property
    def names(self) -> tuple[str, ...]:
        """What each number is, and of which band; band 1 is the farthest."""
        picture = jax.ShapeDtypeStruct((*self.size, 3), jnp.float32)
        return tuple(name.split(" ", 1)[1] for name in jax.eval_shape(self.named, picture))

    @property
    def steady(self) -> tuple[bool, ...]:
        """Whether each number is the same under another white balance, beside other clouds and by another lens."""
        return tuple("colour" not in name and " 1 px " not in name and name != "sky" for name in self.names)

    def named(self, image: Float[Array, "rows columns 3"]) -> dict[str, Scalar]:
        """Each number by its place and its name."""
        dtype = image.dtype
        sea = jnp.sum(self.bands, axis=0).astype(dtype)
        light = luminance(image)
        middle = jnp.maximum(_mean(light, sea), DARK)
        own = jnp.log(jnp.maximum(light, 0.0) / middle + DARKEST)
        hue = jnp.log(
            (jnp.maximum(image[..., 0], 0.0) + DARKEST * middle)
            / (jnp.maximum(image[..., 2], 0.0) + DARKEST * middle)
        )
        whole, tint = _mean(own, sea), _mean(hue, sea)
        found: dict[str, Scalar] = {}

        def add(name: str, value: Scalar) -> None:
            found[f"{len(found):03d} {name}"] = value

        for number, band in enumerate(self.bands.astype(dtype), start=1):
            at = f"in band {number}"
            mean = _mean(own, band)
            variance = _mean((own - mean) ** 2, band)
            centre, deviation = _robust(own, band)
            count = jnp.maximum(jnp.sum(band) / PATCH, 1.0)
            unsure = deviation * jnp.sqrt((1 + 0.5 * BRIGHT**2) / count)
            bright = jax.nn.sigmoid((own - centre - BRIGHT * deviation) / unsure)
            share = _mean(bright, band)
            add(f"level {at}", mean - whole)
            add(f"deviation {at}", jnp.log(deviation))
            add(f"spread {at}", 0.5 * jnp.log(variance + 1e-5))
            add(f"bright {at}", jnp.log(share + FEW))
            add(f"foam {at}", jnp.log(_mean(jax.nn.sigmoid((own - centre - FOAMY) / 0.07), band) + FEW))
            add(f"colour {at}", _mean(hue, band) - tint)
            # Of few bright pixels the colour is chance: it is drawn to that of the band.
            tinted = _mean(bright * (hue - _mean(hue, band)), band) / (share + FEW_COLOURED)
            add(f"bright colour {at}", tinted)
            limited = centre + LIMIT * deviation * jnp.tanh((own - centre) / (LIMIT * deviation))
            # Across the farthest band, which is a pixel or two high, there is nothing to compare.
            for axis, name, octaves in ((1, "along", ALONG), (0, "across", ACROSS if number > 1 else 0)):
                for side in (2**octave for octave in range(octaves)):
                    # A small picture has no room for two of the largest.
                    if 2 * side <= self.size[axis]:
                        add(f"{name} {side} px {at}", _texture(limited, band, side, axis))
        halves = self.bands.shape[0] // 2
        for name, half in (("far", self.bands[:halves]), ("near", self.bands[halves:])):
            band = jnp.sum(half, axis=0).astype(dtype)
            excess = band * jnp.maximum(
                jnp.maximum(light, 0.0) / middle - jnp.exp(_robust(own, band)[0]), 0.0
            )
            aside = self.sideways.astype(dtype)
            turn = _mean(aside, excess + 1e-3 * band)
            add(
                f"glitter width {name}",
                0.5 * jnp.log(_mean((aside - turn) ** 2, excess + 1e-3 * band) + 1e-4),
            )
            columns = jnp.arange(image.shape[1]) * THIRDS // image.shape[1]
            left, centre, right = (
                _mean(own, band * (columns == part).astype(dtype)) for part in range(THIRDS)
            )
            add(f"left {name}", left - right)
            add(f"middle {name}", centre - 0.5 * (left + right))
        sky = self.above.astype(dtype)
        seen = jnp.sum(sky, axis=0)
        columns = jnp.sum(own * sky, axis=0) / jnp.maximum(seen, 1e-3)
        change = (columns[1:] - columns[:-1]) ** 2
        add("relief", 0.5 * jnp.log(_mean(change, seen[1:] * seen[:-1]) + 1e-5))
        add("sky", jnp.where(jnp.sum(sky) > PATCH, _mean(own, sky) - whole, 0.0))
        add("sky colour", jnp.where(jnp.sum(sky) > PATCH, _mean(hue, sky) - tint, 0.0))
        return found


def _mean(values: Float[Array, "*s"], weights: Float[Array, "*s"]) -> Scalar:
    """0 where nothing counts."""
    return jnp.sum(values * weights) / jnp.maximum(jnp.sum(weights), 1e-3)


def _robust(values: Float[Array, "y x"], weights: Float[Array, "y x"]) -> tuple[Scalar, Scalar]:
    """Middle and deviation of most of the values, by Tukey's biweight at four deviations."""
    centre = _mean(values, weights)
    deviation = jnp.sqrt(_mean((values - centre) ** 2, weights) + 1e-5)
    for _ in range(6):
        near = jnp.maximum(1 - ((values - centre) / (4 * deviation)) ** 2, 0.0) ** 2 * weights
        centre = _mean(values, near)
        # Of a normal distribution that weight leaves 0.771 of the variance.
        deviation = jnp.sqrt(_mean((values - centre) ** 2, near) / 0.771 + 1e-5)
    return centre, deviation


def _texture(values: Float[Array, "y x"], weights: Float[Array, "y x"], side: int, axis: int) -> Scalar:
    """½ log mean square difference of means over `side` pixels, from one to the next, along an axis."""
    count = values.shape[axis]

    def part(array: Array, start: int, stop: int) -> Array:
        return jax.lax.slice_in_dim(array, start, stop, axis=axis)

    def sums(array: Array) -> Array:
        return sum(
            (part(array, i, count - side + 1 + i) for i in range(1, side)), part(array, 0, count - side + 1)
        )

    counted = sums(weights) / side
    # What is hidden has no part in a mean.
    means = sums(values * weights) / side / jnp.maximum(counted, 1e-6)
    last = means.shape[axis]
    difference = part(means, side, last) - part(means, 0, last - side)
    both = part(counted, side, last) * part(counted, 0, last - side)
    return 0.5 * jnp.log(_mean(difference**2, both) + 1e-6)
