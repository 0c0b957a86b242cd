"""What `footprint_bias` found, in words."""

import numpy as np

from . import _normality
from ._footprint_storage import PAPER, shown
from ._footprint_views import Found, Sea

SEVERAL = 3.0
"""How many times less biased counts as "several times"."""

TRUSTED = 0.25
"""A relative bias up to which a closure is called good enough."""

MEGABYTE = 2**20


def answers(found: Found, claim: dict) -> list[str]:
    """The experiment's answers, one paragraph each."""
    return [
        *_claim_words(found, claim),
        *_gaussian_words(found),
        *_moment_words(found),
        *_storage_words(found),
    ]


def judge(found: Found) -> dict:
    """How many times the paper's program is more biased than the exact closure, from the second size on.

    A bias of the exact closure that its standard error hides is taken as that error.
    """
    cases = []
    for sea in found.seas:
        (exact, error), (program, _) = sea.bias("exact"), sea.bias("program")
        for t in np.flatnonzero(sea.counted):
            for s in range(1, len(found.tile.sides)):
                ratio = abs(program[t, s]) / max(abs(exact[t, s]), error[t, s])
                cases.append((float(ratio), sea.speed, found.thresholds[t], float(found.tile.lengths[s])))
    if not cases:
        return {"cases": 0, "several_times": 0, "least": None, "median": None}
    names = ("ratio", "wind_speed_m_per_s", "threshold", "size_m")
    return {
        "cases": len(cases),
        "several_times": sum(case[0] >= SEVERAL for case in cases),
        "more_biased": sum(case[0] < 1 for case in cases),
        "least": dict(zip(names, min(cases), strict=True)),
        "median": float(np.median([case[0] for case in cases])),
    }


def _claim_words(found: Found, claim: dict) -> list[str]:
    if not claim["cases"]:
        return [
            "Too little breaks on these tiles to compare closures: raise the wind, ε or the number of realisations."
        ]
    least = claim["least"]
    verdict = "confirmed" if claim["several_times"] == claim["cases"] else "not confirmed everywhere"
    words = (
        f'The claim "the exact closure is several times less biased than the paper\'s at every scale" is {verdict}: '
        f"its bias is at least {SEVERAL:g} times smaller than that of the paper's program in {claim['several_times']} "
        f"of {claim['cases']} cases (wind, ε, size above one sample), {claim['median']:.3g} times in the median, "
        f"and {least['ratio']:.3g} times in the worst, at U10 = {least['wind_speed_m_per_s']:g} m/s, "
        f"ε = {least['threshold']:g} and {_length(least['size_m'])}."
    )
    undefined = [1 - sea.defined("printed")[1:] for sea in found.seas]
    printed = (
        f"The formula as printed is undefined (σ² < 0) in at least {100 * np.min(undefined):.4g} % of the footprints "
        "of any size above one sample."
    )
    return [words, printed]


def good_up_to(found: Found, sea: Sea, t: int) -> float:
    """The largest footprint [m] up to which Gaussian j is good enough; 0 where none larger than a sample is."""
    good = np.abs(sea.bias("gaussian")[0][t]) <= TRUSTED * sea.truth[0][t]
    last = len(good) if good.all() else int(np.argmin(good))
    return float(found.tile.lengths[last - 1]) if last > 1 else 0.0


def worst_exact(found: Found, sea: Sea, t: int) -> tuple[float, float]:
    """The largest relative bias of the exact closure above one sample, and the size [m] where it is."""
    relative = sea.bias("exact")[0][t, 1:] / sea.truth[0][t]
    i = int(np.argmax(np.abs(relative)))
    return float(relative[i]), float(found.tile.lengths[1:][i])


def _gaussian_words(found: Found) -> list[str]:
    """At which scales and seas the Gaussian j can be trusted, and the exact closure."""
    words, largest = [], float(found.tile.lengths[-1])
    for t, threshold in enumerate(found.thresholds):
        seas = [sea for sea in found.seas if sea.counted[t]]
        if not seas:
            continue
        reach = [good_up_to(found, sea, t) for sea in seas]
        parts = []
        for sea, one in zip(seas, reach, strict=True):
            where = (
                "at no size" if one == 0 else ("at all sizes" if one == largest else f"up to {_length(one)}")
            )
            parts.append(f"{where} at {sea.speed:g} m/s")
        words.append(f"At ε = {threshold:g}: {', '.join(parts)}.")
    answer = []
    if words:
        answer.append(
            f"Gaussian j (with its right mean and variance) can be trusted to {100 * TRUSTED:g} % of the mean coverage "
            f"in these footprints. {' '.join(words)}"
        )
    skewness = ", ".join(f"{sea.skewness:+.2f} at {sea.speed:g} m/s" for sea in found.seas)
    trusted = ", ".join(f"ε ≥ {sea.trusted:.2f} at {sea.speed:g} m/s" for sea in found.seas)
    slopes = max(float(np.max(np.abs(sea.shapes[:, :2, 0, -1].mean(axis=0)))) for sea in found.seas)
    answer.append(
        f"In the largest footprints slopes are normal (mean skewness up to {slopes:.2g}) but j is not: its skewness on "
        f"the whole plane is {skewness}. There Gaussian j is within 25 % of the exact coverage only for {trusted}: "
        "where the threshold lies in the body of the distribution, not in its tail."
    )
    cases = [
        (abs(value), value, size, sea.speed, found.thresholds[t])
        for sea in found.seas
        for t in np.flatnonzero(sea.counted)
        for value, size in [worst_exact(found, sea, int(t))]
    ]
    if cases:
        _, value, size, speed, threshold = max(cases)
        kurtosis = np.mean([sea.shapes[:, 2, 1, 0].mean() for sea in found.seas])
        answer.append(
            f"The exact closure errs most by {100 * value:+.2g} % of W, in footprints of {_length(size)} at "
            f"U10 = {speed:g} m/s and ε = {threshold:g}: with few waves in it a footprint's strain is flatter than a "
            f"Gaussian one (excess kurtosis of j {kurtosis:+.2f} in footprints of "
            f"{_length(_normality.LEAST * found.tile.spacing)})."
        )
    return answer


def _moment_words(found: Found) -> list[str]:
    """What independence and the pyramid add to the error of the exact closure."""
    independent, plain, refined = [], [], []
    for sea in found.seas:
        for t in np.flatnonzero(sea.counted):
            exact, truth = sea.bias("exact")[0][t], sea.truth[0][t]
            for into, name in (
                (independent, "exact_independent"),
                (plain, "exact_pyramid"),
                (refined, "exact_refined_pyramid"),
            ):
                into.append((sea.bias(name)[0][t] - exact)[1:] / truth)
    if not independent:
        return []
    size = found.tile.lengths[1:]

    def largest(values: list[np.ndarray]) -> str:
        mean = np.mean(values, axis=0)
        i = int(np.argmax(np.abs(mean)))
        return f"{100 * mean[i]:+.3g} % of W at {_length(size[i])}"

    return [
        "Adding the covariances of the patterns, as if these were independent inside a footprint, changes the exact "
        f"closure's mean by at most {largest(independent)} (mean over winds and ε). Look-ups in the pyramid change "
        f"it by up to {largest(plain)}, in a pyramid of twice the samples by {largest(refined)}: bilinear "
        "interpolation flattens waves of few samples."
    ]


def _storage_words(found: Found) -> list[str]:
    forms = {form.name: form for form in found.storage}
    sides = ", ".join(f"{found.tile.lengths[i]:.3g}" for i in shown(found.tile))
    half, raw = forms["covariances, float16"], forms["products, float16"]
    return [
        f"Slopes and strain of all patterns take {megabytes(raw.bytes)} MB as products in "
        f"float16 and {megabytes(half.bytes)} MB as covariances (the paper's textures of 4 × 256²: "
        f"{PAPER / MEGABYTE:.3g} MB). Rounding changes the mean W of footprints of "
        f"{sides} m by {_percents(raw.change)} % as products, by "
        f"{_percents(half.change)} % as covariances, and W of single footprints by up to "
        f"{raw.worst.max():.2g} and {half.worst.max():.2g}."
    ]


def megabytes(count: int) -> str:
    return f"{count / MEGABYTE:.3g}"


def _percents(changes: np.ndarray) -> str:
    return ", ".join(f"{100 * x:+.2g}" if np.isfinite(x) else "-" for x in changes)


def _length(metres: float) -> str:
    return f"{metres:.3g} m"
