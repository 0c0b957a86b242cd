"""How well the data determine the parameters, in numbers and in words."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

INSEPARABLE = 0.9
"""Correlation from which on two parameters are called inseparable."""

ILL_CONDITIONED = 1e3
"""Condition number from which on some combination of more than two parameters is called undetermined."""

LOOSE = 0.9
"""A fitted error above this fraction of the prior's means that the prior decides."""


class Uncertainty(NamedTuple):
    """Gauss–Newton covariance at a solution, with what it says."""

    covariance: Float[np.ndarray, "p p"]
    correlations: Float[np.ndarray, "p p"]
    condition_number: float
    words: str
    warnings: tuple[str, ...]


def estimate(
    data: Float[np.ndarray, "n p"],
    prior: Float[np.ndarray, "m p"],
    scatter: Float[np.ndarray, " p"],
    labels: list[str],
    groups: list[str],
) -> Uncertainty:
    """Covariance, correlations and identifiability from Jacobians of the residuals in standard deviations.

    $$ C = (J_d^T J_d + J_p^T J_p + F_σ)^{-1} $$

    **Arguments:** `data` J_d and `prior` J_p; `scatter`: Fisher information 2n/σ² of the fitted scatters, 0
    for other parameters; `labels`: a name for each number; `groups`: the parameter that each belongs to.

    **Returns:** `Uncertainty`; the condition number is that of the scaled residuals' Jacobian, which is 1
    where all parameters are independent.
    """
    data = np.where(scatter > 0, 0.0, data)
    own = data.T @ data + np.diag(scatter)
    total = own + prior.T @ prior
    covariance = _inverse(total)
    free = np.diag(own) > 0
    alone = _correlations(_inverse(own))
    helped = np.diag(prior.T @ prior) > 0

    warnings, notes = [], []
    pairs = _worst_pairs(alone, free, groups)
    for (i, j), correlation in pairs:
        one, other = (labels[i], labels[j]) if groups[i] == groups[j] else (groups[i], groups[j])
        sentence = f"{one} and {other} cannot be separated from this data (correlation {correlation:.4g})"
        if helped[i] or helped[j]:
            which = groups[j] if helped[j] else groups[i]
            notes.append(f"{sentence}: the prior of {which} decides.")
        else:
            which = "choppiness" if groups[i] == "choppiness" else groups[j]
            warnings.append(
                f"{sentence}: fix {which}, give it a prior, or add a target that sees one without the other, "
                "such as a slope or image target."
            )
    for i in np.flatnonzero(~free):
        if helped[i]:
            notes.append(f"{labels[i]} is set by its prior alone: the data do not depend on it.")
        else:
            warnings.append(f"{labels[i]} is not determined: the data do not depend on it. Fix it.")
    condition = _condition(total)
    if condition > ILL_CONDITIONED and not warnings:
        weakest = _weakest(total, labels)
        warnings.append(
            f"Some combination of {weakest} is hardly determined by this data (condition number "
            f"{condition:.2g}): "
            "fix one of them, give it a prior, or add a target."
        )
    deviation = np.sqrt(np.diag(covariance))
    for i in np.flatnonzero(helped & free):
        width = 1 / np.sqrt(np.diag(prior.T @ prior)[i])
        if deviation[i] > LOOSE * width and not any(groups[i] in note for note in notes):
            notes.append(f"{labels[i]} is set by its prior more than by the data (± {deviation[i]:.2g}).")
    words = " ".join([*warnings, *notes])
    if not words:
        words = f"Every parameter is determined by the data (condition number {condition:.3g})."
    return Uncertainty(covariance, _correlations(covariance), condition, words, tuple(warnings))


def _scaled(
    information: Float[np.ndarray, "p p"],
) -> tuple[Float[np.ndarray, "p p"], Float[np.ndarray, " p"]]:
    """Information in units in which each parameter alone has error 1."""
    scale = np.sqrt(np.diag(information))
    scale = np.where(scale > 0, scale, 1.0)
    return information / np.outer(scale, scale), scale


def _inverse(information: Float[np.ndarray, "p p"]) -> Float[np.ndarray, "p p"]:
    """Inverse of an information matrix; a direction without information gets an enormous variance."""
    scaled, scale = _scaled(information)
    values, vectors = np.linalg.eigh(scaled)
    floor = np.finfo(float).eps * max(len(values), 1)
    inverse = (vectors / np.maximum(values, floor)) @ vectors.T
    return inverse / np.outer(scale, scale)


def _correlations(covariance: Float[np.ndarray, "p p"]) -> Float[np.ndarray, "p p"]:
    deviation = np.sqrt(np.diag(covariance))
    matrix = covariance / np.outer(deviation, deviation)
    np.fill_diagonal(matrix, 1.0)
    return np.clip(matrix, -1.0, 1.0)


def _condition(information: Float[np.ndarray, "p p"]) -> float:
    values = np.linalg.eigvalsh(_scaled(information)[0])
    smallest = max(float(values[0]), np.finfo(float).eps)
    return float(np.sqrt(values[-1] / smallest))


def _weakest(information: Float[np.ndarray, "p p"], labels: list[str]) -> str:
    """Names of the parameters in the least determined direction."""
    _, vectors = np.linalg.eigh(_scaled(information)[0])
    share = np.abs(vectors[:, 0])
    return ", ".join(labels[i] for i in np.argsort(-share) if share[i] > 0.3)


def _worst_pairs(correlations, free, groups) -> list[tuple[tuple[int, int], float]]:
    """The most correlated numbers of any two parameters (or inside one), where it is too high."""
    worst: dict[tuple[str, str], tuple[tuple[int, int], float]] = {}
    for i in range(len(groups)):
        for j in range(i + 1, len(groups)):
            if not (free[i] and free[j]):
                continue
            key, value = (groups[i], groups[j]), float(correlations[i, j])
            if abs(value) >= INSEPARABLE and (key not in worst or abs(value) > abs(worst[key][1])):
                worst[key] = ((i, j), value)
    return list(worst.values())
