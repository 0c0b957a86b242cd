"""P(j < x) and E[j; j < x] of a quadratic form in Gaussian variables by conditioning: an oracle without contours."""

import numpy as np
from scipy.special import ndtr

FORM = np.array([[0, 0.5, 0], [0.5, 0, 0], [0, 0, -1.0]])
REACH = 8.5
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def partial_moments(mean, covariance, level) -> tuple[float, float]:
    """j = j₀ + Σ lᵢzᵢ² + 2bᵢzᵢ with independent standard normal zᵢ: the largest exactly, the others by panels that
    shrink towards the places where the integrand is not smooth."""
    j0, squares, slopes = _diagonal(np.asarray(mean), np.asarray(covariance))
    sizes = np.abs(squares) + np.abs(slopes)
    order = [i for i in np.argsort(-sizes) if sizes[i] > 1e-13 * sizes.max()]
    y = level - j0
    (square, slope), others = (squares[order[0]], slopes[order[0]]), order[1:]
    # Beyond these values of the rest the innermost problem changes its kind.
    marks = [y] if square == 0 else [y, y + slope**2 / square]

    def integrate(left, given: float, remaining) -> np.ndarray:
        if not remaining:
            probability, moment = _one(np.asarray(left), square, slope)
            return np.array([probability, moment + (given + j0) * probability])
        i = remaining[-1]
        places = []
        for mark in marks:
            # where this variable alone, or with the next one at its extreme, carries the rest to a mark
            targets = [mark - given]
            if len(remaining) > 1 and squares[remaining[0]] != 0:
                targets.append(mark - given + slopes[remaining[0]] ** 2 / squares[remaining[0]])
            for target in targets:
                places += _roots(squares[i], slopes[i], target)
        z, weight = _panels(places)
        shift = squares[i] * z**2 + 2 * slopes[i] * z
        weight = weight * _density(z)
        if len(remaining) == 1:
            probability, moment = _one(left - shift, square, slope)
            return np.array([weight @ probability, weight @ (moment + (given + shift + j0) * probability)])
        return sum(
            w * integrate(left - g, given + g, remaining[:-1]) for w, g in zip(weight, shift, strict=True)
        )

    probability, moment = integrate(y, 0.0, others)
    return float(probability), float(moment)


def _diagonal(mean, covariance):
    """j₀, lᵢ and bᵢ."""
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0))
    squares, turn = np.linalg.eigh(root.T @ FORM @ root)
    x = np.array([1.0, 1.0, 0.0]) + mean
    return x @ FORM @ x, squares, turn.T @ root.T @ FORM @ x


def _one(y, square, slope):
    """P(lz² + 2bz < y) and E[lz² + 2bz; … < y] for one standard normal z."""
    if abs(square) < 1e-14 * abs(slope):
        z = y / (2 * abs(slope))
        return ndtr(z), -2 * abs(slope) * _density(z)
    inside = slope**2 + square * y
    root = np.sqrt(np.maximum(inside, 0))
    stable = -(slope + np.copysign(root, slope))
    first = stable / square
    second = np.where(stable != 0, -y / np.where(stable != 0, stable, 1.0), 0.0)
    low, high = np.minimum(first, second), np.maximum(first, second)
    between = np.where(low > 0, ndtr(-low) - ndtr(-high), ndtr(high) - ndtr(low))
    moment = square * (between - high * _density(high) + low * _density(low))
    moment -= 2 * slope * (_density(high) - _density(low))
    if square > 0:
        return np.where(inside > 0, between, 0.0), np.where(inside > 0, moment, 0.0)
    return np.where(inside > 0, 1 - between, 1.0), np.where(inside > 0, square - moment, square)


def _density(z):
    return np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi)


def _roots(square, slope, target) -> list[float]:
    """z with lz² + 2bz = target, and the vertex."""
    if abs(square) < 1e-300:
        return [target / (2 * slope)] if slope != 0 else []
    inside = slope**2 + square * target
    if inside < 0:
        return [-slope / square]
    root = np.sqrt(inside)
    return [(-slope + root) / square, (-slope - root) / square, -slope / square]


def _panels(places) -> tuple[np.ndarray, np.ndarray]:
    steps = REACH * 2.0 ** -np.arange(1, 22, 2.5)
    ends = [np.linspace(-REACH, REACH, 15)]
    ends += [np.concatenate([[p], p - steps, p + steps]) for p in places if abs(p) < REACH + 0.5]
    edges = np.unique(np.clip(np.concatenate(ends), -REACH, REACH))
    half = 0.5 * np.diff(edges)[:, None]
    z = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * NODES
    return z.ravel(), (half * WEIGHTS).ravel()
