"""A picture that a scene is held against, pixel by pixel and blurred."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from jaxocean._numerics import as_leaf, check_scalar, is_concrete
from jaxocean._types import FloatLike, Scalar
from jaxocean.optics import luminance

Image = Float[Array, "rows columns 3"] | Float[np.ndarray, "rows columns 3"]
Mask = Float[Array, "rows columns"] | Float[np.ndarray, "rows columns"]


class PictureTarget(eqx.Module):
    """Linear light to be matched, up to its exposure.

    $$ r_l = 2^l \\, \\overline{m\\,(f(L) - f(T))}^{\\,2^l × 2^l} / s, \\quad f(L) = \\log(1 + L/\\tilde T) $$

    with the picture L of a scene, the target T, the mask m and the median luminance T̃ of the target. The logarithm
    counts a wrong share of light alike in bright and dark places, and keeps glitter from deciding. Means over squares
    of 1, 2, 4, … pixels count equally: fine ones say most, coarse ones still know the way when crests lie elsewhere.

    **Arguments:**

    - `image`: T, linear with sRGB primaries, in any unit; see `jaxocean.imagery.decode_srgb` for files.
    - `mask`: what each pixel counts, 0 to 1; all of them 1 by default. Mask what the scene does not hold, and what is
      clipped to white.
    - `scatter`: s [-], which sets what the picture weighs beside priors and other targets; 1 by default. With
      `PictureFit.scatter` of a fit to the picture alone it weighs as much as it tells.
    - `levels`: how many sizes of squares are compared, 5 by default.

    **Raises:** `ValueError` for an image that is not finite or holds no light, a mask of another size or outside 0 to
    1, one that hides everything, or no level.
    """

    image: Float[Array, "rows columns 3"] = eqx.field(converter=as_leaf)
    mask: Float[Array, "rows columns"]
    levels: int = eqx.field(static=True)
    middle: Float[Array, ""]
    weights: Float[Array, " level"]
    scatter: Scalar

    def __init__(
        self, image: Image, mask: Mask | None = None, *, scatter: FloatLike = 1.0, levels: int = 5
    ) -> None:
        image = as_leaf(image)
        check_light(image, mask)
        mask = jnp.ones(image.shape[:2], image.dtype) if mask is None else as_leaf(mask)
        check_scalar("scatter", as_leaf(scatter), "", positive=True)
        if not 1 <= levels <= 12:
            raise ValueError(f"Argument `levels` must be 1 to 12, but is {levels}.")
        bright = luminance(image)
        middle = jnp.nanmedian(jnp.where(mask > 0, bright, jnp.nan))
        self.image, self.mask, self.levels, self.middle = image, mask.astype(image.dtype), levels, middle
        self.weights, self.scatter = jnp.ones(levels, image.dtype), as_leaf(scatter).astype(image.dtype)

    def without(self, finest: int) -> "PictureTarget":
        """The same with the finest levels left out, in an equal program."""
        weights = (jnp.arange(self.levels) >= finest).astype(self.weights.dtype)
        return eqx.tree_at(lambda target: target.weights, self, weights)

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns, _ = self.image.shape
        return rows, columns

    def residuals(self, picture: Float[Array, "rows columns 3"]) -> Float[Array, " n"]:
        """r of all levels, one behind the other: first that of the pixels themselves."""
        own, other = (jnp.log1p(jnp.maximum(each, 0.0) / self.middle) for each in (picture, self.image))
        return self._levels(self.mask[..., None] * (own - other.astype(own.dtype)))

    def of_pixels(self, rows: Float[Array, " n"]) -> Float[Array, " pixel"]:
        """What each number of each pixel adds to a sum over `rows` times residuals: the transpose of the levels."""
        pixels = jax.ShapeDtypeStruct(self.image.shape, rows.dtype)
        return jax.linear_transpose(self._levels, pixels)(rows)[0].ravel()

    def places(self, tiles: int) -> Int[np.ndarray, " pixel"]:
        """For each number of each pixel, in which of tiles × tiles parts of the image it lies."""
        rows, columns = self.size
        tile = (np.arange(rows) * tiles // rows)[:, None] * tiles + np.arange(columns) * tiles // columns
        return np.repeat(tile.ravel(), 3)

    def _levels(self, apart: Float[Array, "rows columns 3"]) -> Float[Array, " n"]:
        rows = []
        for level in range(self.levels):
            rows.append((self.weights[level] * 2.0**level / self.scatter).astype(apart.dtype) * apart.ravel())
            apart = _halved(apart)
        return jnp.concatenate(rows)


def check_light(image: Image, mask: Mask | None) -> None:
    """Refuse an image that is not finite or holds no light, and a mask that does not fit it; what is traced passes.

    **Raises:** `ValueError` with what is wrong.
    """
    if image.ndim != 3 or image.shape[-1] != 3:
        raise ValueError(
            f"Argument `image` must have the shape (rows, columns, 3), but has {tuple(image.shape)}."
        )
    if mask is not None and mask.shape != image.shape[:2]:
        raise ValueError(
            f"Argument `mask` must have the {image.shape[0]}×{image.shape[1]} pixels of the image, but has "
            f"{'×'.join(map(str, mask.shape))}."
        )
    if is_concrete(image) and not np.all(np.isfinite(image)):
        raise ValueError("Argument `image` must be finite, but is not: mask and fill what is unknown.")
    seen = np.ones(image.shape[:2]) if mask is None else mask
    if not is_concrete(seen):
        return
    seen = np.asarray(seen)
    if not np.all((seen >= 0) & (seen <= 1)):
        raise ValueError("Argument `mask` must lie between 0 and 1, but does not.")
    if not np.any(seen > 0):
        raise ValueError("Argument `mask` must leave something to compare, but hides the whole image.")
    if is_concrete(image) and not np.median(np.asarray(luminance(jnp.asarray(image)))[seen > 0]) > 0:
        raise ValueError("Argument `image` must hold light where the mask looks, but is dark there.")


def _halved(values: Float[Array, "rows columns 3"]) -> Float[Array, "down across 3"]:
    """Means over squares of 2 × 2; what is missing at the end counts as 0."""
    rows, columns, _ = values.shape
    even = jnp.pad(values, ((0, rows % 2), (0, columns % 2), (0, 0)))
    return 0.25 * (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2])
