"""How far two images are apart."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from .._types import Scalar

WINDOW = 11
"""Width [pixels] of the window of `structural_similarity`."""


def mean_square_error(image: Float[Array, "*b"], reference: Float[Array, "*b"]) -> Scalar:
    """Mean of (a − b)² over pixels and channels, in the images' unit squared."""
    difference = image - reference.astype(image.dtype)
    return jnp.mean(difference * difference)


def mean_absolute_error(image: Float[Array, "*b"], reference: Float[Array, "*b"]) -> Scalar:
    """Mean of |a − b| over pixels and channels, in the images' unit."""
    return jnp.mean(jnp.abs(image - reference.astype(image.dtype)))


def psnr(image: Float[Array, "*b"], reference: Float[Array, "*b"], peak: float = 1.0) -> Scalar:
    """Peak signal-to-noise ratio.

    $$ 10 \\log_{10} \\frac{\\mathrm{peak}^2}{\\overline{(a - b)^2}} $$

    **Arguments:** `image`, `reference`: equal shapes, as code values if the figure is to be compared with others';
    `peak`: the value of white.

    **Returns:** decibels; infinite, with derivative 0, for equal images.
    """
    error = mean_square_error(image, reference)
    differs = error > 0.0
    decibels = -10.0 * jnp.log10(jnp.where(differs, error, 1.0)) + 20.0 * math.log10(peak)
    return jnp.where(differs, decibels, jnp.inf)


def largest_error(image: Float[Array, "*b"], reference: Float[Array, "*b"]) -> Scalar:
    """The largest |a − b| over pixels and channels, in the images' unit."""
    return jnp.max(jnp.abs(image - reference.astype(image.dtype)))


def structural_similarity(
    image: Float[Array, "y x c"], reference: Float[Array, "y x c"], peak: float = 1.0
) -> Scalar:
    """Mean structural similarity of two images of code values.

    $$ \\overline{\\frac{(2 \\mu_a \\mu_b + c_1)(2 \\sigma_{ab} + c_2)}
    {(\\mu_a^2 + \\mu_b^2 + c_1)(\\sigma_a^2 + \\sigma_b^2 + c_2)}}, \\quad
    c_1 = (0.01\\, \\mathrm{peak})^2, \\; c_2 = (0.03\\, \\mathrm{peak})^2 $$

    with means, variances and covariance under a Gaussian window of deviation 1.5 pixels, 11 pixels wide, only where
    the window fits.

    **Raises:** `ValueError` if the images are smaller than the window.

    **Source:** Wang et al., IEEE Trans. Image Process. 13(4), 600–612, 2004.
    """
    if min(image.shape[:2]) < WINDOW:
        raise ValueError(
            f"Argument `image` must have at least {WINDOW} pixels in height and width, but has {image.shape[:2]}."
        )
    a, b = image, reference.astype(image.dtype)
    mean_a, mean_b = _window(a), _window(b)
    variance_a = _window(a * a) - mean_a * mean_a
    variance_b = _window(b * b) - mean_b * mean_b
    covariance = _window(a * b) - mean_a * mean_b
    c1, c2 = (0.01 * peak) ** 2, (0.03 * peak) ** 2
    light = (2.0 * mean_a * mean_b + c1) / (mean_a * mean_a + mean_b * mean_b + c1)
    return jnp.mean(light * (2.0 * covariance + c2) / (variance_a + variance_b + c2))


def _window(image: Float[Array, "y x c"]) -> Float[Array, "..."]:
    """Gaussian mean with deviation 1.5 where the window fits."""
    offsets = range(-(WINDOW // 2), WINDOW // 2 + 1)
    kernel = [math.exp(-0.5 * (i / 1.5) ** 2) for i in offsets]
    kernel = [weight / math.fsum(kernel) for weight in kernel]
    rows = image.shape[0] - WINDOW + 1
    columns = image.shape[1] - WINDOW + 1
    down = sum(
        (weight * image[i : i + rows] for i, weight in enumerate(kernel)), jnp.zeros_like(image[:rows])
    )
    start = jnp.zeros_like(down[:, :columns])
    return sum((weight * down[:, i : i + columns] for i, weight in enumerate(kernel)), start)
