"""How well a picture tells its scene, where neighbouring pixels err together."""

import numpy as np
from jaxtyping import Float, Int

TILES = 8
"""Parts of an image along each side, of which each is taken to err by itself."""


def sandwich(
    pulls: Float[np.ndarray, "n p"],
    places: Int[np.ndarray, " n"],
    hessian: Float[np.ndarray, "p p"],
    priors: Float[np.ndarray, "p p"],
) -> Float[np.ndarray, "p p"]:
    """Covariance of fitted numbers from how differently the parts of an image pull at them.

    $$ C = H^{-1} \\Big(\\frac{B}{B - 1} \\sum_b g_b g_b^T + H_p\\Big) H^{-1}, \\quad
       g_b = \\sum_{i ∈ b} g_i, \\quad H = J^T J + H_p $$

    Unlike σ²H⁻¹ it asks neither for independent pixels nor for a scatter that is the same everywhere.

    **Arguments:** `pulls` g_i: what each datum adds to the gradient Jᵀr of the cost; `places` b of the data; `hessian`
    JᵀJ and `priors` H_p: information of data and priors.

    **Returns:** C.

    **Source:** Liang & Zeger 1986, for clusters of observations.
    """
    number = int(places.max()) + 1
    sums = np.stack([np.bincount(places, column, number) for column in pulls.T], axis=1)
    inverse = np.linalg.pinv(hessian + priors, hermitian=True)
    return inverse @ (sums.T @ sums * number / max(number - 1, 1) + priors) @ inverse
