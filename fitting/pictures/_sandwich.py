"""How well a picture tells its scene, where neighbouring pixels err together."""

import numpy as np
from jaxtyping import Float, Int

TILES = 8
"""Parts of an image along each side, of which each is taken to err by itself."""


def sandwich(
    rows: Float[np.ndarray, " n"],
    jacobian: Float[np.ndarray, "n p"],
    priors: Float[np.ndarray, "m p"],
    places: Int[np.ndarray, " n"],
) -> Float[np.ndarray, "p p"]:
    """Covariance of fitted numbers from how differently the parts of an image pull at them.

    $$ C = H^{-1} \\Big(\\frac{B}{B - 1} \\sum_b g_b g_b^T + J_p^T J_p\\Big) H^{-1}, \\quad
       g_b = \\sum_{i ∈ b} r_i J_i, \\quad H = J^T J + J_p^T J_p $$

    Unlike σ²H⁻¹ it asks neither for independent pixels nor for a scatter that is the same everywhere.

    **Arguments:** `rows` r and `jacobian` J of the picture; `priors` J_p: Jacobian of the priors' residuals; `places` b
    of the rows.

    **Returns:** C.

    **Source:** Liang & Zeger 1986, for clusters of observations.
    """
    number = int(places.max()) + 1
    pulls = np.stack([np.bincount(places, rows * column, number) for column in jacobian.T], axis=1)
    own = priors.T @ priors
    inverse = np.linalg.pinv(jacobian.T @ jacobian + own, hermitian=True)
    return inverse @ (pulls.T @ pulls * number / max(number - 1, 1) + own) @ inverse
